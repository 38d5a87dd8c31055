"""Decks: TOML text made into checked models. One definition gives parser, JSON Schema, `explain` and manual."""
