"""Films of pictures that the page has drawn: GIF, and MP4 where ffmpeg is at hand."""

import io
import struct
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

from extrados.schema.programs import ffmpeg, film_command

MOST_PICTURES, LARGEST_SIDE = 1200, 2560
TYPES = {"gif": "image/gif", "mp4": "video/mp4"}
JPEG = b"\xff\xd8\xff"


class BadFilm(ValueError):
    """The received data are not a film, or the film cannot be made; the text gives the reason."""


@dataclass(frozen=True)
class Film:
    """A film and its media type."""

    content: bytes
    type: str


def film(body: bytes) -> Film:
    """The film of a body: kind (3 bytes, gif or mp4), pictures a second (1 byte), then length (4 bytes, big endian) and
    JPEG of each picture."""
    if len(body) < 4 or (kind := body[:3].decode("latin-1")) not in TYPES or not 1 <= body[3] <= 60:
        raise BadFilm("a film must be gif or mp4 and have 1 to 60 pictures per second")
    pictures, at = [], 4
    while at < len(body):
        (length,) = struct.unpack_from(">I", body, at) if at + 4 <= len(body) else (0,)
        picture = body[at + 4 : at + 4 + length]
        if not length or len(picture) < length or not picture.startswith(JPEG):
            raise BadFilm("a picture of the film is incomplete or is not a JPEG")
        pictures.append(picture)
        at += 4 + length
    if not 1 <= len(pictures) <= MOST_PICTURES:
        raise BadFilm(f"the film has {len(pictures)} pictures; allowed are 1 to {MOST_PICTURES}")
    return Film(_gif(pictures, body[3]) if kind == "gif" else _mp4(pictures, body[3]), TYPES[kind])


def _size(picture: bytes) -> tuple[int, int]:
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(io.BytesIO(picture), formats=["JPEG"]) as image:
            width, height = image.size
    except (UnidentifiedImageError, OSError, ValueError):
        raise BadFilm("a picture of the film cannot be read") from None
    if max(width, height) > LARGEST_SIDE:
        raise BadFilm(f"pictures of {width} x {height} are too large: a side may have at most {LARGEST_SIDE} pixels")
    return width, height


def _gif(pictures: list[bytes], rate: int) -> bytes:
    from PIL import Image

    from extrados.show.film import gif  # and with it what draws figures, which pages do not need

    first, *_ = {_size(p) for p in pictures}

    def drawn(picture: bytes) -> Image.Image:
        try:
            with Image.open(io.BytesIO(picture), formats=["JPEG"]) as image:
                return image.convert("RGB").resize(first)
        except OSError:
            raise BadFilm("a picture of the film cannot be read") from None

    return gif([drawn(picture) for picture in pictures], rate)


def _mp4(pictures: list[bytes], rate: int) -> bytes:
    program = ffmpeg()
    if program is None:
        raise BadFilm("mp4 requires the program ffmpeg, which was not found: pip install imageio-ffmpeg, or choose gif")
    for size in {_size(p) for p in pictures}:
        if min(size) < 2:
            raise BadFilm("the pictures of the film are too small")
    with tempfile.TemporaryDirectory(prefix="extrados-") as folder:
        target = Path(folder) / "film.mp4"
        done = subprocess.run(
            film_command(program, ["-f", "image2pipe", "-c:v", "mjpeg"], rate, target, ["-vf", "crop=trunc(iw/2)*2:trunc(ih/2)*2"]),
            input=b"".join(pictures),
            capture_output=True,
            timeout=300,
            check=False,
        )
        if done.returncode or not target.exists():
            raise BadFilm(f"ffmpeg could not make the film: {done.stderr.decode(errors='replace')[-300:]}")
        return target.read_bytes()
