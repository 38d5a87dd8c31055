"""Bridges out: the stones, meshes and blocks of a deck in the formats of other programs."""
