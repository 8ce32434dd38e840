"""From pairs to impulses."""
