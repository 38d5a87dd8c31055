"""Discrete elements."""
