"""What can be wrong with a building."""


class BadGeometry(ValueError):
    """The building cannot be made as described; the text names the part, what is wrong and the bound."""


class NoView(BadGeometry):
    """A strategy cannot look at this building; the text says why and what would help."""
