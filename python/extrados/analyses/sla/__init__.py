"""Sequentially linear analysis."""
