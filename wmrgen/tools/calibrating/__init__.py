"""Lengths of a robot from its drives: logs of joint readings, and of where the robot was, to the tunable parameters of
its robot file, with what the drives cannot tell."""
