"""Polygons, blocks and joints, contacts, rigid bodies."""
