"""Piers, spandrels and rigid nodes of walls on a plan."""


from extrados.views.frame.rules import Side

WINDOW, DOOR, FREE = Side(0.9, 2.3), Side(0.0, 2.2), Side()
