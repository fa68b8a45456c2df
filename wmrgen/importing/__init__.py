"""Robot descriptions of others to robot files: URDF, and xacro by the package of that name.

``read`` takes untrusted XML to records, ``frames`` composes its joints, ``wheels`` tells by geometry which joints are
wheels, ``robot_file`` writes them down with their open questions.
"""
