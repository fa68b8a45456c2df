"""The functions of a robot beyond its kinematics: models, trailers, motion, control and space."""
