"""One building, one hazard, every strategy: verdicts beside each other, and why they differ."""
