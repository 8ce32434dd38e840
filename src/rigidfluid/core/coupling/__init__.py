"""Bodies, contacts and fluid in one step: schemes with and without a fluid, and its reduced model."""
