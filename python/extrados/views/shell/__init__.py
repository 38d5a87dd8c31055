"""Flat shells in space: vaults, walls on a plan, mesh files."""
