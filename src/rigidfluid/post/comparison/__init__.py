"""The same scene with several fluid backends, and how far the results are apart."""

from rigidfluid.post.comparison.compare import compare

__all__ = ["compare"]
