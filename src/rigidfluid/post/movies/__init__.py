"""A run as a movie."""

from rigidfluid.post.movies.make_movie import Look, movie

__all__ = ["Look", "movie"]
