"""Three dimensions, accelerations and forces."""
