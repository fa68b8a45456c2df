"""The command line: one module for each verb, with its options and its work.

In come the words of a command and the files that they name. Out go results on stdout, messages on stderr, files through
`wmrgen.derivation.artifacts`, and an exit code. This room must not compute: it calls the other rooms, and only
`console` prints.
"""
