"""Solutions of that system: factors, projection and iterations."""
