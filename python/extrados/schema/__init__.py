"""The words of decks and results: tables, keys, quantities with units."""
