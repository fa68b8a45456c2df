"""Tools on top of a derived robot: import, export, compare, lint and calibrate.

In come robot files, other programs' descriptions and logs; out go robot files, findings and estimates. Only the
command line imports this room.
"""
