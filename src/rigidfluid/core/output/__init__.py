"""The disk and the memory of a run."""
