"""Compare designs of robots: layouts side by side, and sweeps over their parameters."""
