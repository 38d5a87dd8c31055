"""The views of a building: blocks, solids, rigid bodies, rocking mechanisms, finite elements, shells."""
