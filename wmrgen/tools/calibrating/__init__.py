"""Lengths of a robot from its drives: logs of joint readings, and of where the robot was, to the tunable parameters of
its robot file, with what the drives cannot tell."""

from importlib.util import find_spec

from wmrgen.errors import EnvironmentFailure

if find_spec("scipy") is None:
    raise EnvironmentFailure("calibrate needs scipy: pip install 'wmrgen[calibrate]'")
