"""`extrados explore`: keeps the serving process alive at one address, so that pages find their way back.

The socket and the token belong to this process, which computes nothing and hence does not die of it.
"""

import atexit
import contextlib
import io
import ipaddress
import json
import signal
import subprocess
import tempfile
import time
import webbrowser
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from extrados.explore import server
from extrados.explore.classroom import PUPILS
from extrados.schema.isolated import environment, python_command

#: Where pages are served unless that is taken
PORT = 8737
#: Deaths within so many seconds that are too many to begin anew
MOST_DEATHS, WITHIN = 5, 60.0


class BadAddress(ValueError):
    """An address cannot be used for a class; the text gives the reason."""


@dataclass(frozen=True)
class ClassOptions:
    """Address of this machine on the local network, and greatest number of pupils of a class."""

    address: str = "127.0.0.1"
    pupils: int = PUPILS

    def __post_init__(self) -> None:
        try:
            found = ipaddress.IPv4Address(self.address)
        except ValueError:
            raise BadAddress(f"{self.address}: expected an IPv4 address of this machine, such as 192.168.1.5") from None
        if found.is_unspecified or not (found.is_private or found.is_link_local):
            raise BadAddress(
                f"{self.address}: a class needs one address of a private network; an address of the internet, or 0.0.0.0, is refused"
            )


def explore(
    folder: Path, deck: str | None, port: int | None, browser: bool, say: Callable[[str], None], pupils: ClassOptions | None = None
) -> int:
    """Serve pages on a working folder, and a class if wanted, until Ctrl-C; the exit code."""
    token = server.new_token()
    with contextlib.ExitStack() as stack:
        try:
            sock = stack.enter_context(server.listen(PORT if port is None else port, strict=port is not None))
        except OSError as error:
            say(f"port {port} cannot be used: {error.strerror or error}")
            return 3
        address = f"http://127.0.0.1:{sock.getsockname()[1]}/{token}/"
        sockets, second = [sock], None
        if pupils is not None:
            try:
                sockets.append(stack.enter_context(server.listen(PORT + 1, address=pupils.address)))
            except OSError as error:
                say(f"{pupils.address} cannot be used for a class on this machine: {error.strerror or error}")
                return 3
            second = (sockets[1].fileno(), server.new_token(), pupils.pupils)
            _say_class(f"http://{pupils.address}:{sockets[1].getsockname()[1]}/{second[1]}/", pupils, say)
        say(f"{'Teacher' if pupils else 'Page'}:    {address}")
        say(f"Folder:  {folder}")
        say("Ctrl-C stops the server.")
        given = {"socket": sock.fileno(), "token": token, "folder": str(folder), "deck": deck, "class": second}
        deaths: list[float] = []
        pointer = write_pointer(address) if browser else None
        while True:
            child = subprocess.Popen(
                python_command("extrados.explore.server"),
                pass_fds=[one.fileno() for one in sockets],
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
                say(
                    f"the server stopped {len(deaths)} times within a minute, the last time with exit code {code}; extrados does not start it again"
                )
                return 3
            say(f"the server stopped (exit code {code}) and is started again; open pages keep their state")
            time.sleep(0.2 * len(deaths))


def _say_class(link: str, pupils: ClassOptions, say: Callable[[str], None]) -> None:
    """Print the link of a class, and its QR code if the package for it is there."""
    say(f"Class:   {link}   (up to {pupils.pupils} pupils)")
    if ipaddress.IPv4Address(pupils.address).is_loopback:
        say("         Only this machine can open the page of the class: give --address with an address of the local network.")
    try:
        import segno
    except ImportError:
        say('         A QR code requires the package segno: pip install "extrados[class]".')
        return
    drawn = io.StringIO()
    segno.make(link, error="m").terminal(drawn, compact=True)
    say(drawn.getvalue())


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
