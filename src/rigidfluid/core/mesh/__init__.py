"""The fluid's mesh from birth to re-birth."""
