"""The linear system of fluid and bodies: discretised terms, constraint and links."""
