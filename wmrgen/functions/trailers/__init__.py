"""Trailers behind a robot, and the chained, Brockett and flat forms of the train that they make."""
