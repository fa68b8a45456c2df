"""Write pages for a browser: the report as one HTML file, with figures, formulas and the robot to drive."""
