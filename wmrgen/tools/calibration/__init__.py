"""Calibration: from logs of joint readings and reference poses to the parameters of a robot file.

In: a derived robot with tunable parameters, and logs. Out: parameters with deviations, what the logs do not determine,
noise levels, and a verdict on drives that were left out of the fit. This room never guesses what a log means: a log
that no parameters explain is refused, with figures, and with the one mistake, if any, that would explain it.
"""

from importlib.util import find_spec

from wmrgen.errors import EnvironmentFailure

if find_spec("scipy") is None:
    raise EnvironmentFailure("calibrate needs scipy: pip install 'wmrgen[calibrate]'")
