"""Equilibrium and collapse mechanisms of block assemblies by linear programming (thesis chapter 3)."""
