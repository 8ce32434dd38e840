"""Distances to surfaces, marched over the simplices of a mesh, and the nearest points of two surfaces."""
