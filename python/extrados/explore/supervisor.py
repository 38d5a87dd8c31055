"""`extrados explore`: keeps the serving process alive at one address, so that pages find their way back.

The socket and the token belong to this process, which computes nothing and hence does not die of it.
"""

import atexit
import json
import signal
import subprocess
import tempfile
import time
import webbrowser
from collections.abc import Callable
from pathlib import Path

from extrados.explore import server
from extrados.schema.isolated import environment, python_command

#: Where pages are served unless that is taken
PORT = 8737
#: Deaths within so many seconds that are too many to begin anew
MOST_DEATHS, WITHIN = 5, 60.0


def explore(
    folder: Path, deck: str | None, port: int | None, browser: bool, say: Callable[[str], None]
) -> int:  # fmt: skip
    """Serve pages on a working folder until Ctrl-C; the exit code."""
    token = server.new_token()
    try:
        opened = server.listen(PORT if port is None else port, strict=port is not None)
    except OSError as error:
        say(f"port {port} cannot be taken: {error.strerror or error}")
        return 3
    with opened as sock:
        address = f"http://127.0.0.1:{sock.getsockname()[1]}/{token}/"
        say(f"Page:    {address}")
        say(f"Folder:  {folder}")
        say("Ctrl-C ends it.")
        given = {"socket": sock.fileno(), "token": token, "folder": str(folder), "deck": deck}
        deaths: list[float] = []
        pointer = write_pointer(address) if browser else None
        while True:
            child = subprocess.Popen(
                python_command("extrados.explore.server"),
                pass_fds=[sock.fileno()],
                env=environment(EXTRADOS_EXPLORE=json.dumps(given)),
            )
            if pointer and not deaths:
                webbrowser.open(pointer.as_uri())
            try:
                code = child.wait()
            except KeyboardInterrupt:
                _end(child)
                return 0
            if code in (0, -signal.SIGINT):
                return 0
            now = time.monotonic()
            deaths = [t for t in deaths if now - t < WITHIN] + [now]
            if len(deaths) >= MOST_DEATHS:
                say(f"the server died {len(deaths)} times within a minute, last with code {code}: given up")
                return 3
            say(f"the server died (code {code}): it is begun anew, and open pages come back with their state")
            time.sleep(0.2 * len(deaths))


def write_pointer(address: str) -> Path:
    """A file that only this user can read and that leads to the page: what stands on a browser's command line, everybody on the
    machine can read. It is removed at the end of this process."""
    handle, name = tempfile.mkstemp(prefix="extrados-", suffix=".html")
    atexit.register(lambda: Path(name).unlink(missing_ok=True))
    with open(handle, "w", encoding="ascii") as file:
        file.write(f'<meta http-equiv="refresh" content="0; url={address}"><a href="{address}">extrados</a>\n')
    return Path(name)


def _end(child: subprocess.Popen) -> None:
    """End the serving process, politely first."""
    child.send_signal(signal.SIGINT)
    try:
        child.wait(5.0)
    except subprocess.TimeoutExpired:
        child.kill()
        child.wait()
