"""Records that flow between the rooms, the checks of them, the interfaces, the system and its state."""
