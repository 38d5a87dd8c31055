"""Rocking dynamics and failure domains."""
