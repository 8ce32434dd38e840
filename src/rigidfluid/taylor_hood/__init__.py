"""Parts shared by backends of Taylor–Hood elements P2–P1: numbering, constraint, solver, step and transfer."""
