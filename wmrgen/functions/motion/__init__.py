"""Motion under constant commands, odometry with its covariance, centres of rotation, velocities of contacts.

A robot comes in; formulas from twists, joint rates or encoder counts to poses, centres and velocities go out. Wheel
types are not distinguished by name: everything follows from the rows of the constraints.
"""
