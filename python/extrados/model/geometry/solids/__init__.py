"""Stones as solids: convex polyhedra and unions of them, their mass properties, their contacts, and files that hold them."""
