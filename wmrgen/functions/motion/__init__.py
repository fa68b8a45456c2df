"""Motion under constant commands, instantaneous centres, consistency of steering angles."""
