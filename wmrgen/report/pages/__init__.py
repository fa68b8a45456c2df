"""Pages of a robot for a browser: its report as one HTML file, with figures, formulas and the robot itself to drive."""
