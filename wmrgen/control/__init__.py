"""Control laws of the texts, from the pose error to wheel commands."""
