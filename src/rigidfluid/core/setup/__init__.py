"""A scene becomes a system, once."""
