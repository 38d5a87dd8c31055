"""Requests of a page to its session, by purpose: each function takes the desk and a message, and yields replies."""
