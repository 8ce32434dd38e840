"""Seeding: places of bodies that are drawn at random, thin or dense, and do not touch."""
