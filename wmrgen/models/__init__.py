"""Models of a robot as control systems: posture, configuration, trailers, canonical forms."""
