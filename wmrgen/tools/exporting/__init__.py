"""Write robot files as descriptions for other tools: URDF, SDFormat, ros2_control, WPILib; the reverse of `importing`.

An export prints geometry alone and needs no derivation. It is no back end: `derive` does not write it, and most robots
do not have every one. ``bodies`` has the links of a robot, ``drives`` its kind of drive; one module writes each form.
"""
