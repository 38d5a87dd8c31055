"""Frames of macro-elements: modes, pushover, time history."""
