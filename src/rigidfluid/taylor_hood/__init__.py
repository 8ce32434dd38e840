"""What backends of Taylor–Hood elements P2–P1 share: numbering, constraint, solver, step and transfer."""
