"""Constants of nature that decks, analyses and figures share; the core has the same (a test compares them)."""

#: Standard gravity [m/s^2]
GRAVITY = 9.80665
