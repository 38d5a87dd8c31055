"""Finite-element meshes of walls and of stones."""
