"""What the constraints of a robot allow: Lie brackets and growth, integrability, and the integrals."""
