"""Files that describe a building."""

from pathlib import Path

from extrados.model.errors import BadGeometry, Key
from extrados.schema import files
from extrados.schema.files import File

LARGEST_FILE = 20_000_000  # bytes of a drawing or a JSON file


def read(file: str | Path, largest: int, folder: Path | None = None, at: Key = ("structure", "file")) -> File:
    """The file that a deck in `folder` names at a key, or the one at a path; BadGeometry where it cannot be read."""
    try:
        return files.read(file, largest, folder)
    except files.BadFile as error:
        raise BadGeometry(str(error), at) from None
