"""Buildings on a plan as frames of macro-elements: piers, spandrels and rigid nodes."""
