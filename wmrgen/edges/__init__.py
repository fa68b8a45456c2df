"""What stands between kinematics and motors: speed limits kept without leaving the path, modules that flip as one."""
