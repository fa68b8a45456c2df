"""Backends: each turns an `ir.Module` into files and can evaluate its functions. None sees another."""
