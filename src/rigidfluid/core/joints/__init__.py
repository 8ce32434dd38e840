"""What joins motions: rows of joints, poses at which they fit, and how they move between contacts."""
