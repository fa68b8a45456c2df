"""Motion in three dimensions: accelerations, contacts of a moving body, and tipping over.

A robot with its centre of gravity comes in; formulas from specific forces and accelerations to margins and motions go
out. No function here knows masses or torques.
"""
