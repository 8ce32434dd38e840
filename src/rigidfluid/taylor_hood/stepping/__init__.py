"""Steps in time, initial flow, responses to impulses, and transfer between meshes."""
