"""Strengthening: the least intervention that meets a target."""
