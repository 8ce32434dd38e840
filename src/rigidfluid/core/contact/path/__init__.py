"""Bodies' path through contacts, in substeps or implicit steps."""
