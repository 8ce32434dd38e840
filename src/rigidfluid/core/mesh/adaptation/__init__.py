"""The mesh over time: moved, re-meshed, and what it is then made from."""
