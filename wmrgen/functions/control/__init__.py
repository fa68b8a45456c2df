"""Control laws of the texts, and limits between a wanted twist and the motors.

A robot with its limits and gains comes in; formulas that return a twist or joint commands go out. Inputs outside the
limits give the nearest command inside them. No function here has a memory: the last command is an input.
"""
