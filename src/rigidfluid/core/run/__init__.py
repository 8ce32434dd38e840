"""Run loop: states, steps, and a run's files and figures."""
