"""Robot files to descriptions for other tools: URDF, SDFormat, ros2_control, WPILib. The other way than `importing`.

A room beside the backends, and none of them: a backend prints operations of every robot's functions, which `derive`
writes and `check` keeps fresh; an export prints geometry alone, needs no derivation, is written where the user says,
and most robots have not every one. ``bodies`` is a robot as links, ``drives`` tells which drive it is to others,
and a module for each kind writes.
"""
