"""Programs of others that are used where they are there."""

import importlib.util
import shutil


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
