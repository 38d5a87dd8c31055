"""The interactive page: a server on loopback, sessions that keep a live deck, and the page itself in static/."""
