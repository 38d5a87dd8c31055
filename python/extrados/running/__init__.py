"""Runs of a deck: in memory, into a folder, and kept alive while values change."""
