"""Float kernels: sines, cosines, arctangents and rounding as float operations, which generated C uses in place of libm.

Optimised functions and a `choice.Choice` come in; functions in the operations of one processor go out. This package
must not change a result beyond the rounding of its kernels, and no pass except `schedule` may follow it.
"""

from wmrgen.ir.kernels.expand import expand, rounds, with_kernels

__all__ = ["expand", "rounds", "with_kernels"]
