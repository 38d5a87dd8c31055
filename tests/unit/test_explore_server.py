"""The page's server without a browser: who is let in, what may be asked, and what nobody can hold up."""

import base64
import contextlib
import json
import os
import socket
import struct
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import uvicorn
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

from extrados.explore import server
from extrados.explore.desk import NEW_DECK
from extrados.explore.frames import Reply
from extrados.explore.guard import Bucket
from extrados.explore.session import ANSWERS, Session
from extrados.schema.files import locate

TOKEN = "a-token-that-nobody-guesses"
SECRET = "nobody may read this"


class Page:
    """A server in a thread, and what an honest page sends it."""

    def __init__(self, folder: Path):
        self.socket = server.listen()
        self.port = self.socket.getsockname()[1]
        self.server = uvicorn.Server(server.configured(self.socket, TOKEN, folder))
        self.thread = threading.Thread(target=self.server.run, kwargs={"sockets": [self.socket]}, daemon=True)
        self.thread.start()
        while not self.server.started:
            assert self.thread.is_alive(), "the server did not start"
            time.sleep(0.01)

    def close(self) -> None:
        self.server.should_exit = True
        self.thread.join(10)
        self.socket.close()

    def raw(self, request: bytes, wait: float = 5.0) -> bytes:
        """What comes back for some bytes, until the server closes or says no more."""
        with socket.create_connection(("127.0.0.1", self.port), timeout=wait) as link:
            with contextlib.suppress(OSError):
                link.sendall(request)
            found = b""
            with contextlib.suppress(OSError):
                while part := link.recv(65536):
                    found += part
                    if b"\r\n\r\n" in found and b"101 Switching" in found[:40]:
                        break
            return found

    def unread(self) -> int:
        """How many sockets leave unread what they are sent."""
        return sum(getattr(link, "unread", None) is not None for link in list(self.server.server_state.connections))

    def request(self, path: str = f"/{TOKEN}/", method: str = "GET", body: bytes = b"", **heads: str | None) -> bytes:
        """What comes back for a request with the heads of an honest page, but for those given; None leaves one out."""
        return self.raw(self.asked(heads, path, method, body))

    def asked(self, heads: dict[str, str | None], path: str = f"/{TOKEN}/live", method: str = "GET", body: bytes = b"") -> bytes:
        given = {"Host": f"127.0.0.1:{self.port}", "Connection": "close"}
        given |= {k.replace("_", "-"): v for k, v in heads.items()}
        if body or method == "POST":
            given.setdefault("Content-Length", str(len(body)))
        lines = [f"{method} {path} HTTP/1.1", *(f"{k}: {v}" for k, v in given.items() if v is not None)]
        return "\r\n".join(lines).encode("latin-1", "replace") + b"\r\n\r\n" + body

    def upgrade(self, path: str = f"/{TOKEN}/live", **heads: str | None) -> bytes:
        """What comes back for a request for a socket."""
        return self.request(path, **{**self.upgrading(), **heads})

    def upgrading(self) -> dict[str, str | None]:
        """Heads that ask for a socket."""
        return {
            "Connection": "Upgrade",
            "Upgrade": "websocket",
            "Sec-WebSocket-Version": "13",
            "Sec-WebSocket-Key": base64.b64encode(os.urandom(16)).decode(),
            "Origin": f"http://127.0.0.1:{self.port}",
        }

    def open(self) -> Any:
        return connect(f"ws://127.0.0.1:{self.port}/{TOKEN}/live", origin=f"http://127.0.0.1:{self.port}", max_size=None, close_timeout=2)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    above = tmp_path_factory.mktemp("above")
    (above / "secret.toml").write_text(f'title = "{SECRET}"\n')
    (above / "secret.csv").write_text(f"{SECRET}\n")
    inside = above / "work"
    inside.mkdir()
    (inside / "deck.toml").write_text(NEW_DECK)
    (inside / "out.toml").symlink_to(above / "secret.toml")
    (inside / "way-out").symlink_to(above)
    return inside


@pytest.fixture(scope="module")
def page(folder: Path) -> Iterator[Page]:
    found = Page(folder)
    yield found
    found.close()


def until(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + 120.0
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


def status(answer: bytes) -> int:
    return int(answer.split(b" ", 2)[1]) if answer.startswith(b"HTTP/1.1 ") else 0


def unpack(frame: bytes) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    (length,) = struct.unpack_from("<I", frame)
    words = json.loads(frame[4 : 4 + length])
    sorts = {"f": "<f4", "d": "<f8", "i": "<i4", "b": "|u1"}
    arrays = {
        name: np.frombuffer(frame, sorts[sort], int(np.prod(shape)), 4 + length + offset).reshape(shape)
        for name, (sort, shape, offset) in words["arrays"].items()
    }
    return words, arrays


def test_an_honest_page_is_served(page: Page) -> None:
    answer = page.request()
    assert status(answer) == 200
    head, _, body = answer.partition(b"\r\n\r\n")
    assert b'<script type="module"' in body
    assert b"content-security-policy: default-src 'none'" in head
    assert b"no-referrer" in head
    assert status(page.request(f"/{TOKEN}/app.js")) == 200
    assert page.upgrade().startswith(b"HTTP/1.1 101")


#: What other sites, guessers and broken programs may send: name, request, and what of the answer shows it was refused
HOSTILE_REQUESTS: list[tuple[str, dict[str, Any]]] = [
    ("the name of another site", {"Host": "evil.example"}),
    ("a name that leads here", {"Host": "127.0.0.1.evil.example:{port}"}),
    ("another port", {"Host": "127.0.0.1:1"}),
    ("no port", {"Host": "127.0.0.1"}),
    ("no name", {"Host": None}),
    ("an empty name", {"Host": ""}),
    ("a user within the name", {"Host": "127.0.0.1:{port}@evil.example"}),
    ("the address of all", {"Host": "0.0.0.0:{port}"}),
    ("another site's page", {"Origin": "https://evil.example"}),
    ("a page without a site", {"Origin": "null"}),
    ("this machine over https", {"Origin": "https://127.0.0.1:{port}"}),
    ("another server of this machine", {"Origin": "http://127.0.0.1:8000"}),
    ("a site that begins alike", {"Origin": "http://127.0.0.1:{port}.evil.example"}),
    ("a file", {"Origin": "file://"}),
    ("cross-site by its fetch", {"Sec_Fetch_Site": "cross-site"}),
    ("same-site by its fetch", {"Sec_Fetch_Site": "same-site"}),
    ("no token", {"path": "/"}),
    ("no token before a file", {"path": "/app.js"}),
    ("another token", {"path": "/another-token/"}),
    ("half the token", {"path": f"/{TOKEN[:-1]}/"}),
    ("more than the token", {"path": f"/{TOKEN}x/"}),
    ("the token in capitals", {"path": f"/{TOKEN.upper()}/"}),
    ("the token as a query", {"path": f"/?token={TOKEN}"}),
    ("the token in letters of another alphabet", {"path": "/%D0%B0-token/"}),
    ("a way out", {"path": f"/{TOKEN}/../../../../etc/passwd"}),
    ("a way out, masked", {"path": f"/{TOKEN}/..%2f..%2f..%2fetc%2fpasswd"}),
    ("a way out, masked twice", {"path": f"/{TOKEN}/%252e%252e/%252e%252e/etc/passwd"}),
    ("a way out by backslashes", {"path": f"/{TOKEN}/..\\..\\secret.toml"}),
    ("an absolute path", {"path": f"/{TOKEN}//etc/passwd"}),
    ("a zero byte", {"path": f"/{TOKEN}/app.js%00.html"}),
    ("sources of the server", {"path": f"/{TOKEN}/../server.py"}),
    ("a deck of the folder as a file", {"path": f"/{TOKEN}/deck.toml"}),
    ("a very long path", {"path": f"/{TOKEN}/" + "a" * 3000}),
    ("a very long query", {"path": f"/{TOKEN}/?" + "a" * 3000}),
    ("a head without end", {"Cookie": "a" * 70_000}),
    ("DELETE", {"method": "DELETE"}),
    ("PUT", {"method": "PUT", "body": b"x"}),
    ("OPTIONS, to ask whether it may", {"method": "OPTIONS", "Origin": "https://evil.example"}),
    ("CONNECT", {"method": "CONNECT", "path": "evil.example:443"}),
    ("TRACE", {"method": "TRACE"}),
    ("a form that does not say its origin", {"method": "POST", "path": f"/{TOKEN}/film", "body": b"gif\x0f"}),
    ("a form of another site", {"method": "POST", "path": f"/{TOKEN}/film", "body": b"gif\x0f", "Origin": "https://evil.example"}),
    (
        "more than is taken",
        {"method": "POST", "path": f"/{TOKEN}/film", "Origin": "http://127.0.0.1:{port}", "Content_Length": "99999999999"},
    ),
    ("less than nothing", {"method": "POST", "path": f"/{TOKEN}/film", "Origin": "http://127.0.0.1:{port}", "Content_Length": "-5"}),
    (
        "a film that is none",
        {"method": "POST", "path": f"/{TOKEN}/film", "Origin": "http://127.0.0.1:{port}", "body": b"exe\x0f" + b"x" * 50},
    ),
    (
        "a film of one broken picture",
        {
            "method": "POST",
            "path": f"/{TOKEN}/film",
            "Origin": "http://127.0.0.1:{port}",
            "body": b"gif\x0f\x00\x00\x00\x08\xff\xd8\xffabcde",
        },
    ),
    ("a POST to a page", {"method": "POST", "Origin": "http://127.0.0.1:{port}", "body": b"x"}),
]
HOSTILE_SOCKETS: list[tuple[str, dict[str, Any]]] = [
    ("a socket of another site", {"Origin": "https://evil.example"}),
    ("a socket without an origin", {"Origin": None}),
    ("a socket without a site", {"Origin": "null"}),
    ("a socket under another name", {"Host": "evil.example"}),
    ("a socket without the token", {"path": "/live"}),
    ("a socket with another token", {"path": "/another-token/live"}),
    ("a socket elsewhere", {"path": f"/{TOKEN}/other"}),
    ("a socket from a cross-site fetch", {"Sec_Fetch_Site": "cross-site"}),
]
#: Messages that no page of ours sends, over an honest socket
HOSTILE_MESSAGES: list[tuple[str, str]] = [
    ("no JSON", "rm -rf /"),
    ("no object", "[1, 2, 3]"),
    ("nothing to do", '{"of": 1}'),
    ("a method of the class", '{"do": "__class__"}'),
    ("deep nesting", "[" * 100_000),
    ("a deck outside", '{"do": "open", "path": "../secret.toml"}'),
    ("a deck outside, absolutely", '{"do": "open", "path": "/etc/passwd"}'),
    ("a deck by a link that leads out", '{"do": "open", "path": "out.toml"}'),
    ("a deck in a folder that leads out", '{"do": "open", "path": "way-out/secret.toml"}'),
    ("a case that leads out", '{"do": "open", "preset": "../../../etc/passwd"}'),
    (
        "a record by an absolute path",
        json.dumps({"do": "open", "text": NEW_DECK + '[motion]\nkind = "record"\nfile = "/etc/passwd"\ntime_step = 0.01\nunit = "g"\n'}),
    ),
    ("a run outside", '{"do": "run", "path": "../../etc"}'),
    ("saving outside", '{"do": "save", "path": "../stolen.toml", "replace": true}'),
    ("saving by a link", '{"do": "save", "path": "way-out/stolen.toml", "replace": true}'),
    ("saving a hidden file", '{"do": "save", "path": ".bashrc", "replace": true}'),
    ("running outside", '{"do": "compute", "path": "../stolen.toml", "replace": true}'),
    ("dropping with a way out", '{"do": "drop", "name": "../../x.csv", "data": "AAAA"}'),
    ("dropping a program", '{"do": "drop", "name": "x.py", "data": "AAAA"}'),
    ("dropping no base64", '{"do": "drop", "name": "x.csv", "data": "!!!"}'),
    ("no such handle", '{"do": "drag", "handle": "__init__", "to": [0, 0]}'),
    ("a place that is none", '{"do": "drag", "handle": "thickness", "to": [null, "x"]}'),
    ("a place beyond reason", '{"do": "drag", "handle": "thickness", "to": [1e308, 1e308]}'),
    ("numbers that are none", '{"do": "show", "gamma": "NaN"}'),
    ("a thrust that is none", '{"do": "show", "thrust": [1, 2]}'),
    ("a thrust in words", '{"do": "show", "thrust": "open(/etc/passwd)"}'),
    ("a push of what is no solid", '{"do": "push", "direction": "../../x"}'),
    ("a joint that is none", '{"do": "show", "through": {"joint": 99999, "share": 0.5}}'),
    ("keys that are none", '{"do": "set", "changes": {"__proto__.x": 1}}'),
    ("a key with a way out", '{"do": "set", "changes": {"../x": 1}}'),
    ("too many changes", json.dumps({"do": "set", "changes": {f"structure.k{i}": 1 for i in range(1000)}})),
    ("stones without number", '{"do": "set", "changes": {"structure.voussoirs": 100000000}}'),
    ("a sheet of no blocks", '{"do": "draw", "blocks": {"a": 1}, "ground": []}'),
    (
        "a sheet with a name in two lines",
        '{"do": "draw", "blocks": [{"name": "a\\n[motion]", "points": [[0, 0], [1, 0], [1, 1]]}], "ground": []}',
    ),
    (
        "a sheet with words for places",
        '{"do": "draw", "blocks": [{"name": "a", "points": [["open(/etc/passwd)", 0], [1, 0], [1, 1]]}], "ground": []}',
    ),
    ("a sheet of too many blocks", json.dumps({"do": "draw", "blocks": [{"name": "a", "points": []}] * 1001, "ground": []})),
    ("a sheet of too many vertices", json.dumps({"do": "draw", "blocks": [{"name": "a", "points": [[0, 0]] * 8001}], "ground": []})),
    ("a number of a thousand digits", '{"do": "set", "changes": {"structure.radius": 1' + "0" * 1000 + "}}"),
]


def _filled(page: Page, given: dict[str, Any]) -> dict[str, Any]:
    return {k: v.replace("{port}", str(page.port)) if isinstance(v, str) else v for k, v in given.items()}


@pytest.mark.parametrize(("name", "given"), HOSTILE_REQUESTS, ids=[name for name, _ in HOSTILE_REQUESTS])
def test_hostile_requests_are_refused(page: Page, name: str, given: dict[str, Any]) -> None:
    answer = page.request(**_filled(page, given))
    assert not 200 <= status(answer) < 300, answer[:300]
    assert SECRET.encode() not in answer
    assert b"root:" not in answer
    assert b"Traceback" not in answer
    assert status(page.request()) == 200, "it goes on"


@pytest.mark.parametrize(("name", "given"), HOSTILE_SOCKETS, ids=[name for name, _ in HOSTILE_SOCKETS])
def test_hostile_sockets_are_refused(page: Page, name: str, given: dict[str, Any]) -> None:
    assert b"101 Switching" not in page.upgrade(**_filled(page, given))
    assert page.upgrade().startswith(b"HTTP/1.1 101"), "an honest one is let in"


@pytest.mark.parametrize(("name", "message"), HOSTILE_MESSAGES, ids=[name for name, _ in HOSTILE_MESSAGES])
def test_hostile_messages_are_refused(page: Page, folder: Path, name: str, message: str) -> None:
    before = sorted(p.name for p in [*folder.iterdir(), *folder.parent.iterdir()])
    with page.open() as link:
        link.send('{"do": "hello", "of": 0}')
        while "scene" not in unpack(link.recv(30))[0]:
            pass
        told = ""
        with contextlib.suppress(WebSocketException):
            link.send(message)
            link.send('{"do": "rocking"}' if name.startswith("a record") else '{"do": "list", "of": 7}')
        with contextlib.suppress(WebSocketException, TimeoutError):
            for _ in range(2):
                words, _ = unpack(link.recv(30))
                told += json.dumps(words)
                if not (words.get("bad") or words.get("complaints") or words["to"] in ("list", "open")):
                    pytest.fail(f"answered: {words}")
        assert SECRET not in told
        assert "root:" not in told
        if name.startswith("a record"):
            assert "absolute path" in told
        elif told and '"bad"' not in told and '"complaints"' not in told:
            pytest.fail(f"not refused: {told[:300]}")
    assert sorted(p.name for p in [*folder.iterdir(), *folder.parent.iterdir()]) == before
    assert status(page.request()) == 200, "it goes on"


@pytest.mark.parametrize(
    "message",
    [
        {"do": "\ud800"},
        {"do": "open", "starter": "\ud800"},
        {"do": "hello", "kept": {"text": "", "drops": 1}},
        {"do": "hello", "kept": {"text": "", "drops": "arch"}},
        {"do": "hello", "kept": {"text": "", "drops": [None]}},
        {"do": "save", "path": "taken.toml", "replace": True},
    ],
)
def test_what_a_page_never_sends_is_no_fault_of_the_program(folder: Path, tmp_path: Path, message: dict[str, Any]) -> None:
    (tmp_path / "taken.toml").mkdir()
    session = Session(tmp_path)
    assert [reply for reply in session.answer({"do": "hello"}) if "scene" in reply.words]
    *_, reply = session.answer(message)
    words, _ = unpack(reply.pack())
    told = words.get("bad") or " ".join(words["complaints"])
    assert told and "fault of extrados" not in told


def test_there_are_sixty_hostile_requests_and_more() -> None:
    assert len(HOSTILE_REQUESTS) + len(HOSTILE_SOCKETS) + len(HOSTILE_MESSAGES) >= 60


@pytest.mark.parametrize("pause", [0.0, 1.0], ids=["at once", "after answers that nobody reads"])
def test_too_many_messages_end_a_page_and_not_the_others(page: Page, pause: float) -> None:
    with page.open() as other, page.open() as link:
        with pytest.raises(WebSocketException):
            for _ in range(40):
                link.send('{"do": "list"}')
            time.sleep(pause)
            for _ in range(20_000):
                link.send('{"do": "list"}')
            for _ in range(20_000):
                link.recv(10)
        other.send('{"do": "list", "of": 1}')
        assert unpack(other.recv(30))[0]["to"] == "list"


def test_no_more_pages_than_are_allowed(page: Page) -> None:
    with contextlib.ExitStack() as stack:
        links = [stack.enter_context(page.open()) for _ in range(server.MOST_PAGES)]
        links[-1].send('{"do": "list"}')
        links[-1].recv(30)
        with pytest.raises(WebSocketException), page.open() as more:
            more.recv(10)


def test_pages_that_read_nothing_hold_up_nobody_and_lose_their_places(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server, "UNREAD", 2.0)
    message = b'{"do": "hello"}'
    # masked with zeros, which leaves the bytes as they are; browsers mask at random
    frame = bytes([0x81, 0x80 | len(message), 0, 0, 0, 0]) + message
    page = Page(folder)
    page.socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 8192)  # the system keeps no megabytes for them
    try:
        with contextlib.ExitStack() as stack:
            other = stack.enter_context(page.open())
            for _ in range(server.MOST_PAGES - 1):
                link = stack.enter_context(socket.socket())
                link.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
                link.connect(("127.0.0.1", page.port))
                link.sendall(page.asked(page.upgrading()))
                assert link.recv(12) == b"HTTP/1.1 101"
                link.sendall(20 * frame)
            until(lambda: page.unread() > 0)
            other.send('{"do": "list", "of": 1}')
            assert unpack(other.recv(30))[0]["to"] == "list"
            until(lambda: page.server.config.loaded_app.app.state.pages == 1)
            for _ in range(server.MOST_PAGES - 1):
                link = stack.enter_context(page.open())
            link.send('{"do": "list", "of": 2}')
            assert unpack(link.recv(30))[0]["of"] == 2
    finally:
        page.close()


def test_a_page_that_goes_amid_long_work_holds_up_nobody(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begun, ends, closed = threading.Event(), threading.Event(), threading.Event()

    def work(_: Any, __: Any) -> Iterator[Reply]:
        begun.set()
        ends.wait(60)
        yield Reply({})

    monkeypatch.setitem(ANSWERS, "push", work)
    monkeypatch.setattr(Session, "close", lambda _: closed.set())
    page = Page(folder)
    try:
        with page.open() as other:
            with page.open() as link:
                link.send('{"do": "push"}')
                assert begun.wait(30)
            other.send('{"do": "list", "of": 1}')
            assert unpack(other.recv(30))[0]["of"] == 1
            until(lambda: page.server.config.loaded_app.app.state.pages == 1)
            assert not closed.is_set(), "what it works at still stands"
            ends.set()
            assert closed.wait(30)
    finally:
        ends.set()
        page.close()


def test_what_fails_at_the_end_of_a_page_is_reported_on_the_log(
    folder: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """And a session is closed under the same rules for files as all that its page asked for."""

    def close(_: Session) -> None:
        locate("/etc/passwd", folder)

    monkeypatch.setattr(Session, "close", close)
    page = Page(folder)
    try:
        with page.open() as link:
            link.send('{"do": "list", "of": 1}')
            assert unpack(link.recv(30))[0]["of"] == 1
        until(lambda: bool(caplog.records))
    finally:
        page.close()
    (record,) = caplog.records
    assert record.getMessage() == "a page could not be closed"
    assert record.exc_info is not None
    assert "Only files in the folder of the deck can be read here" in str(record.exc_info[1])


def test_the_work_of_a_page_is_closed_before_its_session_and_whatever_fails() -> None:
    told: list[str] = []

    def work(name: str) -> Iterator[Reply]:
        try:
            yield Reply({})
        finally:
            told.append(name)
            raise RuntimeError(name)

    class Closed:
        def close(self) -> None:
            told.append("session")

    works = [work("one"), work("two")]
    for begun in works:
        next(begun)
    with pytest.raises(RuntimeError):
        server._end(works, Closed())  # type: ignore[arg-type]
    assert sorted(told[:2]) == ["one", "two"] and told[2:] == ["session"]


def test_a_bucket_lets_its_rate_pass() -> None:
    bucket = Bucket(3.0, 1.0)
    assert [bucket.take() for _ in range(4)] == [True, True, True, False]
    bucket.last -= 2.0
    assert [bucket.take() for _ in range(3)] == [True, True, False]


def test_newer_movements_replace_older_ones_that_wait() -> None:
    inbox = server.Inbox()
    for message in ({"do": "a", "lane": "x", "k": 1}, {"do": "a", "lane": "x", "k": 2}, {"do": "b"}, {"do": "a", "lane": "x", "k": 3}):
        inbox.put(message)
    assert [m.get("k") for m in inbox.waiting] == [2, None, 3]


def test_a_frame_is_read_as_it_was_sent() -> None:
    arrays = {"a": np.arange(5.0), "b": np.array([[1, 2], [3, 4]]), "c": np.array([1, 255], dtype=np.uint8), "d": np.array([1e-20, np.nan])}
    words, found = unpack(Reply({"x": np.float64(2.0), "y": np.inf}, arrays, frozenset("d")).pack())
    assert words["x"] == 2.0
    assert words["y"] is None
    for name, array in arrays.items():
        np.testing.assert_array_equal(found[name], array)
    assert found["d"].dtype == np.float64


def test_idle_connections_shut_no_page_out(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server, "WHOLE_REQUEST", 1.0)
    page = Page(folder)
    try:
        with contextlib.ExitStack() as stack:
            links = []
            for k in range(200):
                link = stack.enter_context(socket.create_connection(("127.0.0.1", page.port), timeout=30))
                link.sendall(b"" if k % 2 else f"POST /{TOKEN}/film HTTP/1.1\r\nHost: a".encode())
                links.append(link)
            assert status(page.request()) == 200
            assert page.upgrade().startswith(b"HTTP/1.1 101")
            for link in links:  # all of them are ended by the server
                with contextlib.suppress(ConnectionError):
                    while link.recv(4096):
                        pass
        until(lambda: not page.server.server_state.connections)
    finally:
        page.close()


def test_an_open_page_is_no_idle_connection(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A socket outlasts the time within which a request has to be whole, and is not among those that give way to others."""
    monkeypatch.setattr(server, "WHOLE_REQUEST", 0.5)
    page = Page(folder)
    try:
        with page.open() as link, contextlib.ExitStack() as stack:
            for _ in range(2 * server.MOST_IDLE):
                stack.enter_context(socket.create_connection(("127.0.0.1", page.port), timeout=30))
            time.sleep(1.5)
            link.send('{"do": "list", "of": 7}')
            words, _ = unpack(link.recv(30))
            assert words["of"] == 7
    finally:
        page.close()


def test_a_request_that_comes_in_pieces_is_answered(page: Page) -> None:
    with socket.create_connection(("127.0.0.1", page.port), timeout=30) as link:
        for _ in range(2):  # the second one on the connection that was kept alive
            for part in page.asked({"Connection": "keep-alive"}, f"/{TOKEN}/style.css").split(b"Host"):
                link.sendall(part if part.startswith(b"GET") else b"Host" + part)
                time.sleep(0.05)
            found = b""
            while b"\r\n\r\n" not in found:
                found += link.recv(65536)
            head, _, body = found.partition(b"\r\n\r\n")
            assert status(head) == 200
            length = int(head.lower().split(b"content-length: ")[1].split(b"\r\n")[0])
            while len(body) < length:
                body += link.recv(65536)


def test_a_tab_may_be_led_to_the_page_and_nothing_else_may(page: Page) -> None:
    """What a browser sends where it follows the file that `extrados explore` wrote for it."""
    led = {"Sec_Fetch_Site": "cross-site", "Sec_Fetch_Mode": "navigate", "Sec_Fetch_Dest": "document"}
    assert status(page.request(**led)) == 200
    assert status(page.request(**{**led, "Sec_Fetch_Dest": "iframe"})) == 403
    assert status(page.request("/", **led)) == 403
    assert status(page.request(f"/{TOKEN}/film", "POST", b"x", **led)) == 403
    assert b"101" not in page.upgrade(**led)[:20]


def test_the_token_stands_in_a_file_of_its_user_alone() -> None:
    from extrados.explore.supervisor import write_pointer

    pointer = write_pointer("http://127.0.0.1:1/secret/")
    assert pointer.stat().st_mode & 0o777 == 0o600
    assert 'url=http://127.0.0.1:1/secret/"' in pointer.read_text()
    pointer.unlink()


def test_two_pages_that_save_one_deck_leave_one_of_the_two(tmp_path: Path) -> None:
    from extrados.explore.folder import Folder

    texts = [f"# {k}\n" * 20_000 for k in range(4)]

    def save(text: str) -> None:
        for _ in range(20):
            Folder(tmp_path).save("deck.toml", text, {}, replace=True)

    threads = [threading.Thread(target=save, args=(text,)) for text in texts]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(120)
    assert (tmp_path / "deck.toml").read_text() in texts
    assert [path.name for path in tmp_path.iterdir()] == ["deck.toml"]
