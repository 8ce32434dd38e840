"""Force laws on contacts: their sum, dampers of restitution, films, strength and stiffness."""
