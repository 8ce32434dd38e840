"""A preconditioner by blocks for the coupled matrix: its cost and memory grow with the unknowns alone, also in 3D."""
