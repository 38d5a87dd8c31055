"""Exports: blocks, meshes and frames of a deck in the formats of other programs, and a deck from a plan."""
