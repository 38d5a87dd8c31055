"""Blocks in space of a building, and what they stand on."""
