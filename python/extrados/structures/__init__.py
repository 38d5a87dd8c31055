"""A deck's structure made into blocks and joints, or into a mesh."""
