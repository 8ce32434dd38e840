"""Rigid bodies, without knowing why they move."""
