"""The interactive page: a server on the loopback address, sessions with a live deck, and the page itself in static/."""
