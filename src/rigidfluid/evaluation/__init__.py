"""Running scenes and setting them side by side: studies, backends, LAMMPS, the paper's tables."""
