"""Studies of ground motions."""
