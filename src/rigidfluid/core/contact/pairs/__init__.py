"""Pairs of surfaces near each other: broad phase, gaps, curvatures, tracked and extrapolated contacts."""
