"""The commands' names, arguments, options and help: a module for each group that the help shows."""
