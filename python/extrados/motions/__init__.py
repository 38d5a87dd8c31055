"""Ground motions: pulses and records, ready for the core."""
