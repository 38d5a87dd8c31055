"""Benchmarks: ratios against a peer in the same run, the error beside each rate. Nothing here passes or fails."""
