"""Limit analysis."""
