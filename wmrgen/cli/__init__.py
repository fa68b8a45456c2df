"""The command line: a thin layer over `wmrgen.load` and `wmrgen.derive`."""
