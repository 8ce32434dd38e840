"""The first mesh of a scene, written for other programs, and how well the bodies came into it."""

from rigidfluid.post.insertion.insert import insert

__all__ = ["insert"]
