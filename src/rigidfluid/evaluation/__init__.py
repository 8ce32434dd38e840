"""Running scenes and setting them side by side: studies, backends, meshes alone."""
