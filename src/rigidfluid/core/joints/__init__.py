"""Joints between motions: their rows, poses at which they fit, and motion between contacts."""
