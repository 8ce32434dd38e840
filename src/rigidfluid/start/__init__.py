"""Scenes to start from: those that come with the package, and a new one of the user's own."""
