"""Edge lengths wanted over the domain."""
