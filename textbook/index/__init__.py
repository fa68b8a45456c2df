"""The table that leads from a place in one of the five texts to a robot file, a command and the numbers to expect."""
