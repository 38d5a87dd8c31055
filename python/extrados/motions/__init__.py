"""Ground motions: pulses, records, generated earthquakes, suites; what is done to them."""
