"""Verbs whose options are declared apart from their work."""
