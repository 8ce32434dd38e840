"""The fluid's equations: its material, its conditions on the boundary."""
