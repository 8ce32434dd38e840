"""What flows between the rooms, and what must be true of it: records, interfaces, the system and its state."""
