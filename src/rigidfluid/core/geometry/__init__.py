"""Shapes, and the surfaces that they have: arrays, no bodies of a run."""
