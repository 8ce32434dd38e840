"""Tables within the tables of parts: bodies in their place, rows over time, strokes."""
