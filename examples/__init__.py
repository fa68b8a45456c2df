"""What solvers make of a robot's model. Each module is a program: ``python -m examples.car --solver sqpmethod``."""
