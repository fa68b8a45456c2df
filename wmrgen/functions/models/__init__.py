"""Models of a robot as control systems: posture, configuration, zeta form, slip, virtual wheels."""
