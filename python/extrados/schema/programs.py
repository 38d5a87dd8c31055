"""Programs of others that are used where they are there."""

import importlib.util
import shutil
from pathlib import Path


def ffmpeg() -> str | None:
    """The program ffmpeg, which makes mp4: the system's, else that of the package imageio-ffmpeg; None without both."""
    found = shutil.which("ffmpeg")
    if found is None and importlib.util.find_spec("imageio_ffmpeg") is not None:
        import imageio_ffmpeg

        try:
            found = imageio_ffmpeg.get_ffmpeg_exe()
        except RuntimeError:
            return None
    return found


def film_command(program: str, source: list[str], rate: int, target: Path, cut: list[str] | None = None) -> list[str]:
    """The command by which ffmpeg makes an mp4 of pictures on its standard input.

    source: options that say how the pictures come; rate: pictures a second; cut: options that change them.
    """
    coded = ["-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "20", "-movflags", "+faststart"]
    return [program, "-y", "-loglevel", "error", *source, "-framerate", str(rate), "-i", "-", *(cut or []), *coded, str(target)]
