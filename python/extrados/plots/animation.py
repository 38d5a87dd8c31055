"""What animations need: the program that makes mp4, found where it may be."""

import importlib.util
import shutil


def ffmpeg() -> str | None:
    """The program ffmpeg: the system's, else that of the package imageio-ffmpeg; None where there is none."""
    found = shutil.which("ffmpeg")
    if found is None and importlib.util.find_spec("imageio_ffmpeg") is not None:
        import imageio_ffmpeg

        try:
            found = imageio_ffmpeg.get_ffmpeg_exe()
        except RuntimeError:
            return None
    return found
