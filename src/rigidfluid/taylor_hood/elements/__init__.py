"""Shape functions, numbering and facets of P2–P1 elements, and values at points."""
