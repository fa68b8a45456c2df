"""A robot as a control system: coordinates and inputs, posture to zeta form, Lie brackets, integrability."""
