"""Parts of tables, and tables within those of parts: bodies in their place, rows over time, strokes."""
