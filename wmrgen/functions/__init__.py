"""The functions of a robot beyond its kinematics: models, trailers, structure, motion, control and space."""
