"""The intermediate representation: functions as flat lists of scalar operations.

Formulas in symbols come in (`lower`); functions, optimised, verified, with bounds and test vectors, go out to the back
ends. This package must not know a language, and after `lower` and `verify` no sympy.
"""
