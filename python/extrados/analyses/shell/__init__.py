"""Buildings of flat shells by sequentially linear analysis."""
