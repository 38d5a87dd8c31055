"""Figures of limit analysis, a module for each."""
