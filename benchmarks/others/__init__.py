"""C of the same functions from other generators, in single precision, as their users get it."""
