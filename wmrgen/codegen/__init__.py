"""Code generation: text in C, Rust, JavaScript and Python, CasADi functions, and packages around them.

In come lowered functions (`ir.Module`) and the names of the robot; out go files as bytes, and values for `wmrgen eval`.
A back end must not see a formula, nor another back end; C and Rust share `unit`.
"""
