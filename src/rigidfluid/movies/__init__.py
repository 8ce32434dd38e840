"""A run as a movie."""

from rigidfluid.movies.make_movie import Look, movie

__all__ = ["Look", "movie"]
