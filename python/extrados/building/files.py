"""Files that describe a building."""

from pathlib import Path

from extrados.building.errors import BadGeometry
from extrados.schema import files


def locate(file: str, folder: Path) -> Path:
    """The file a deck means; BadGeometry where it cannot be."""
    try:
        return files.locate(file, folder)
    except files.BadPlace as error:
        raise BadGeometry(str(error)) from None
