"""Robot descriptions of others to robot files: URDF, SDF, and xacro by the package of that name.

``source`` opens the file, ``xacro_process`` resolves xacro in a process with limits. ``read`` takes untrusted XML to
elements and numbers; ``urdf`` and ``sdf`` take these to records, with ``poses`` and ``gazebo``. ``frames`` composes
joints, ``view`` sees all from the base. ``candidates``, ``passed``, ``rollers`` and ``wheels`` determine by geometry
which joints are wheels and of what type; ``controllers`` and ``instructions`` read what drives them. ``questions``,
``robot_questions``, ``kinds`` and ``couplings`` ask for what the file does not say, ``answers`` reads the answers, and
``robot_file`` writes the robot file.
"""
