"""Files that describe a building."""

from pathlib import Path

from extrados.building.errors import BadGeometry
from extrados.schema import files
from extrados.schema.files import File


def read(file: str | Path, largest: int, folder: Path | None = None) -> File:
    """The file that a deck in `folder` names, or the one at a path; BadGeometry where it cannot be read."""
    try:
        return files.read(file, largest, folder)
    except files.BadFile as error:
        raise BadGeometry(str(error)) from None
