"""Robot descriptions of others to robot files: URDF, SDF, and xacro by the package of that name.

``source`` opens the file, and ``xacro_process`` resolves xacro in a process with limits; ``read`` takes untrusted XML to elements and
numbers, ``urdf`` and ``sdf`` take these to records, with ``poses`` and ``gazebo``; ``frames`` composes joints,
``view`` sees all from the base. ``candidates``, ``passed``, ``rollers`` and ``wheels`` tell by geometry which are
wheels, which are none and of what kind they are, ``controllers`` and ``instructions`` what drives them;
``questions``, ``robot_questions``, ``kinds`` and ``couplings`` ask what the file does not say, ``robot_file`` writes it all down.
"""
