"""Meshes from surfaces and a size: fill, refinement and coarsening of surfaces, curved cells."""
