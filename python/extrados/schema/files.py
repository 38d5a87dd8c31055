"""Where the files of a deck lie."""

from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1]
#: Files that come with the program, by the name that follows `extrados:` in a deck; places below the package
SHIPPED = {
    "el-centro-1940": "motions/library/el-centro-1940.csv",
    "example-sections": "building/examples/sections.csv",
    "example-wall": "building/examples/wall.inp",
}


class BadPlace(ValueError):
    """The file that a deck names cannot be meant; the text says why."""


def locate(file: str, folder: Path) -> Path:
    """The file a deck means: shipped, absolute as the user wrote it, or inside the deck's folder."""
    if file.startswith("extrados:"):
        name = file.removeprefix("extrados:")
        if name not in SHIPPED:
            raise BadPlace(f"{file}: no such file is shipped; known are {', '.join(sorted(SHIPPED))}")
        return PACKAGE / SHIPPED[name]
    if "\0" in file:
        raise BadPlace(f"{file!r}: a file name cannot hold a zero byte")
    path = Path(file)
    if path.is_absolute():
        return path
    inside = (folder / path).resolve()
    if not inside.is_relative_to(folder.resolve()):
        raise BadPlace(f"{file}: leads out of the deck's folder; give an absolute path if you mean it")
    return inside
