"""Checks of codes."""
