"""Figures and report, from stored results only."""
