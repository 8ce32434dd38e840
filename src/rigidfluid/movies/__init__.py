"""A run as a movie."""

from rigidfluid.movies.movie import Look, movie

__all__ = ["Look", "movie"]
