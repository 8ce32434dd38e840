"""The contract of fluid backends in parts: one file for what is held to one idea, and what those share."""
