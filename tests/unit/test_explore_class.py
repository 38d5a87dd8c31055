"""A class: who is let in by which door, what a pupil may ask for, and what the teacher does with all; nothing is left."""

import contextlib
import itertools
import json
import os
import socket
import statistics
import tempfile
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
import test_explore_server as single
import uvicorn
from test_explore_server import HOSTILE_MESSAGES, HOSTILE_REQUESTS, HOSTILE_SOCKETS, SECRET, TOKEN, status, unpack
from websockets.exceptions import WebSocketException
from websockets.sync.client import connect

from extrados.explore import server
from extrados.explore.desk import NEW_DECK
from extrados.explore.supervisor import BadAddress, ClassOptions

PUPIL = "a-token-of-the-class"
#: An address of this machine that is not the teacher's: all of 127.0.0.0/8 is its own network on Linux
ADDRESS = "127.0.0.2"


class ClassPage(single.Page):
    """A teacher's page on loopback and a class on another address, in one server."""

    def __init__(self, folder: Path, most: int = 30, address: str = ADDRESS):
        self.teacher, self.socket = server.listen(), server.listen(address=address)
        self.address, self.port = address, self.socket.getsockname()[1]
        pupils = server.Class(self.socket, PUPIL, most)
        self.server = uvicorn.Server(server.configured(self.teacher, TOKEN, folder, None, pupils))
        self.thread = threading.Thread(target=self.server.run, kwargs={"sockets": [self.teacher, self.socket]}, daemon=True)
        self.thread.start()
        while not self.server.started:
            assert self.thread.is_alive(), "the server did not start"
            time.sleep(0.01)

    def close(self) -> None:
        super().close()
        self.teacher.close()

    def raw(self, request: bytes, wait: float = 5.0, to: tuple[str, int] | None = None) -> bytes:
        with socket.create_connection(to or (self.address, self.port), timeout=wait) as link:
            with contextlib.suppress(OSError):
                link.sendall(request)
            found = b""
            with contextlib.suppress(OSError):
                while part := link.recv(65536):
                    found += part
                    if b"101 Switching" in found[:40]:
                        break
            return found

    def asked(self, heads: dict[str, str | None], path: str = f"/{PUPIL}/live", method: str = "GET", body: bytes = b"") -> bytes:
        return super().asked({"Host": f"{self.address}:{self.port}", **heads}, path, method, body)

    def request(self, path: str = f"/{PUPIL}/", method: str = "GET", body: bytes = b"", **heads: str | None) -> bytes:
        return self.raw(self.asked(heads, path, method, body))

    def upgrade(self, path: str = f"/{PUPIL}/live", **heads: str | None) -> bytes:
        return self.request(path, **{**self.upgrading(), "Origin": f"http://{self.address}:{self.port}", **heads})

    def join(self) -> Any:
        at = f"{self.address}:{self.port}"
        return connect(f"ws://{at}/{PUPIL}/live", origin=f"http://{at}", max_size=None, close_timeout=2)

    def teach(self) -> Any:
        at = f"127.0.0.1:{self.teacher.getsockname()[1]}"
        return connect(f"ws://{at}/{TOKEN}/live", origin=f"http://{at}", max_size=None, close_timeout=2)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    above = tmp_path_factory.mktemp("class")
    (above / "secret.toml").write_text(f'title = "{SECRET}"\n')
    inside = above / "work"
    inside.mkdir()
    (inside / "deck.toml").write_text(NEW_DECK)
    (inside / "record.csv").write_text(f"{SECRET}\n")
    return inside


@pytest.fixture(scope="module")
def room(folder: Path) -> Iterator[ClassPage]:
    found = ClassPage(folder)
    yield found
    found.close()


NUMBERS = itertools.count(900)


def ask(link: Any, **message: Any) -> dict[str, Any]:
    """The words of the first reply to a message; what comes of others meanwhile is passed over."""
    of = next(NUMBERS)
    link.send(json.dumps({"of": of, **message}))
    while True:
        words, _ = unpack(link.recv(60))
        if words.get("of") == of:
            return words


def greet(link: Any) -> dict[str, Any]:
    """What a page is told first; the first drawing follows."""
    words = ask(link, do="hello")
    while "scene" not in unpack(link.recv(60))[0]:
        pass
    return words


def _filled(room: ClassPage, given: dict[str, Any]) -> dict[str, Any]:
    """A hostile request for the pupils' door."""
    change = (("{port}", str(room.port)), ("127.0.0.1", room.address), (TOKEN, PUPIL), (TOKEN.upper(), PUPIL.upper()))

    def put(value: Any) -> Any:
        if isinstance(value, str):
            for old, new in change:
                value = value.replace(old, new)
        return value

    return {k: put(v) for k, v in given.items()}


@pytest.mark.parametrize(("name", "given"), HOSTILE_REQUESTS, ids=[name for name, _ in HOSTILE_REQUESTS])
def test_hostile_requests_are_refused(room: ClassPage, name: str, given: dict[str, Any]) -> None:
    answer = room.request(**_filled(room, given))
    assert not 200 <= status(answer) < 300, answer[:300]
    assert SECRET.encode() not in answer and b"root:" not in answer and b"Traceback" not in answer
    assert status(room.request()) == 200, "it goes on"


@pytest.mark.parametrize(("name", "given"), HOSTILE_SOCKETS, ids=[name for name, _ in HOSTILE_SOCKETS])
def test_hostile_sockets_are_refused(room: ClassPage, name: str, given: dict[str, Any]) -> None:
    assert b"101 Switching" not in room.upgrade(**_filled(room, given))
    assert room.upgrade().startswith(b"HTTP/1.1 101"), "an honest one is let in"


#: What a page of one's own may ask for and a pupil may not
BEYOND_A_CLASS = [
    ("a deck of the folder", {"do": "open", "path": "deck.toml"}),
    ("a list of the folder", {"do": "list"}),
    ("saving", {"do": "save", "path": "mine.toml"}),
    ("running", {"do": "compute", "path": "mine.toml"}),
    ("a stored run", {"do": "run", "path": "results/x"}),
    ("a dropped file", {"do": "drop", "name": "x.csv", "data": "AAAA"}),
    ("dropped files of a page that comes back", {"do": "open", "here": "dropped", "text": NEW_DECK}),
    (
        "a record in the folder",
        {
            "do": "open",
            "text": NEW_DECK + '[motion]\nkind = "record"\nfile = "record.csv"\ntime_step = 0.01\nunit = "g"\n',
            "then": "rocking",
        },
    ),
    ("a drawing", {"do": "open", "text": '[structure]\nkind = "blocks"\nfile = "x.dxf"\n[[analysis]]\nkind = "tilt"\n'}),
    ("too many blocks", {"do": "set", "changes": {"structure.voussoirs": 301}}),
    ("a long deck", {"do": "open", "text": NEW_DECK + "#" * 70_000}),
    ("a long response", {"do": "open", "text": NEW_DECK + '[motion]\nkind = "step-pulse"\namplitude = "0.5 g"\nduration = 500.0\n'}),
    ("the class", {"do": "class"}),
    ("sending to all", {"do": "send"}),
    ("pausing all", {"do": "pause", "frozen": True}),
    ("looking at another", {"do": "peek", "number": 1}),
    ("the teacher's word", {"do": "pause", "frozen": True, "teacher": True}),
]
MESSAGES = [*((name, json.loads(text)) for name, text in HOSTILE_MESSAGES if text.startswith("{")), *BEYOND_A_CLASS]


@pytest.mark.parametrize(("name", "message"), MESSAGES, ids=[name for name, _ in MESSAGES])
def test_hostile_messages_of_pupils_are_refused(room: ClassPage, folder: Path, name: str, message: dict[str, Any]) -> None:
    before = sorted(p.name for p in [*folder.iterdir(), *folder.parent.iterdir()])
    with room.join() as link:
        greet(link)
        with contextlib.suppress(WebSocketException):
            if not message.get("do"):
                link.send(json.dumps(message))
                link.recv(10)
                return
            words = ask(link, **{k: v for k, v in message.items() if k not in ("of", "then")})
            if "record" in name and "complaints" not in words:
                words = ask(link, do="rocking")
            told = json.dumps(words)
            assert words.get("bad") or words.get("complaints") or words.get("rocking", {}).get("refused"), told[:300]
            assert SECRET not in told and "root:" not in told
    assert sorted(p.name for p in [*folder.iterdir(), *folder.parent.iterdir()]) == before
    assert room.server.config.loaded_app.app.state.room.frozen is False


def test_the_teachers_token_opens_nothing_at_the_pupils_door(room: ClassPage) -> None:
    port = room.teacher.getsockname()[1]
    assert status(room.request(f"/{TOKEN}/")) in (403, 421)
    assert b"101" not in room.upgrade(f"/{TOKEN}/live")[:20]
    assert status(room.request(f"/{TOKEN}/", Host=f"127.0.0.1:{port}")) in (200, 403)
    assert status(room.raw(room.asked({"Host": f"127.0.0.1:{port}"}, f"/{PUPIL}/"), to=("127.0.0.1", port))) == 421


def test_from_another_address_the_teachers_door_is_shut() -> None:
    from extrados.explore.guard import Door, Guard

    guard = Guard(None, [Door("t", ["127.0.0.1:1"]), Door("p", ["192.168.1.5:2"], "pupil", near=False)])

    def objection(token: str, host: bytes, client: str) -> int:
        scope = {"type": "http", "method": "GET", "path": f"/{token}/", "headers": [(b"host", host)], "client": (client, 1)}
        found = guard.objection(scope)
        return 200 if found is None else found[0]

    assert objection("t", b"127.0.0.1:1", "127.0.0.1") == 200
    assert objection("t", b"127.0.0.1:1", "192.168.1.77") == 403, "whatever it says in Host"
    assert objection("t", b"192.168.1.5:2", "192.168.1.77") == 421
    assert objection("p", b"192.168.1.5:2", "192.168.1.77") == 200
    assert objection("p", b"127.0.0.1:1", "192.168.1.77") == 421
    assert objection("x", b"192.168.1.5:2", "192.168.1.77") == 403


def test_on_an_address_of_the_network_pupils_come_in_and_the_teachers_token_does_not(folder: Path) -> None:
    address = "127.0.0.1"
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe, contextlib.suppress(OSError):
        probe.connect(("192.0.2.1", 9))  # sends nothing: the system chooses the address it would send from
        address = probe.getsockname()[0]
    if address.startswith("127."):
        pytest.skip("this machine has no address but loopback")
    room = ClassPage(folder, address=address)
    try:
        assert status(room.request()) == 200
        with room.join() as link:
            assert greet(link)["pupil"] == 1
        port = room.teacher.getsockname()[1]
        assert status(room.request(f"/{TOKEN}/", Host=f"127.0.0.1:{port}")) == 403
        assert b"101" not in room.upgrade(f"/{TOKEN}/live", Host=f"127.0.0.1:{port}", Origin=f"http://127.0.0.1:{port}")[:20]
        with pytest.raises(OSError):
            socket.create_connection((address, port), timeout=2)
    finally:
        room.close()


def test_pupils_have_sessions_of_their_own_and_the_teacher_sees_and_leads_them(room: ClassPage) -> None:
    with room.teach() as teacher, room.join() as one, room.join() as two:
        assert greet(teacher)["class"] == {"most": 30}
        told = [greet(link) for link in (one, two)]
        assert {words["pupil"] for words in told} == {1, 2}
        assert all(words["decks"] == [] and words["runs"] == [] and words["folder"] == "" for words in told)
        assert "scene" in ask(one, do="set", changes={"structure.thickness": 0.3})
        seen = ask(teacher, do="class", since=-1)["class"]
        rows = {row["number"]: row for row in seen["pupils"]}
        assert rows[1]["falls"] == "weight" and not rows[2]["falls"]
        assert rows[1]["path"].count("M") == 36
        assert "path" not in ask(teacher, do="class", since=seen["change"])["class"]["pupils"][0], "nothing changed"
        ask(one, do="rest")
        assert "thickness = 0.3" in ask(teacher, do="peek", number=1)["peeked"]
        ask(teacher, do="set", changes={"structure.radius": 7.0})
        assert ask(teacher, do="send")["sent"] == 2
        for link in (one, two):
            while "radius = 7.0" not in unpack(link.recv(60))[0].get("text", ""):
                pass
        assert ask(teacher, do="pause", frozen=True)["frozen"] is True
        assert "paused" in ask(two, do="set", changes={"structure.radius": 8.0})["bad"]
        assert ask(teacher, do="pause", frozen=False)["frozen"] is False
        assert "scene" in ask(two, do="set", changes={"structure.radius": 8.0})
    time.sleep(0.3)
    assert room.server.config.loaded_app.app.state.room.pupils == {}


def test_a_full_class_takes_nobody_more_and_the_teacher_still_comes_in(folder: Path) -> None:
    room = ClassPage(folder, most=3)
    try:
        with contextlib.ExitStack() as stack:
            for _ in range(3):
                greet(stack.enter_context(room.join()))
            with pytest.raises(WebSocketException), room.join() as more:
                more.recv(10)
            greet(stack.enter_context(room.teach()))
    finally:
        room.close()


def test_a_class_is_held_on_one_address_of_a_private_network() -> None:
    for address in ("0.0.0.0", "8.8.8.8", "::1", "example.org", ""):
        with pytest.raises(BadAddress):
            ClassOptions(address)
    assert ClassOptions("192.168.1.5").pupils == 30
    assert ClassOptions().address == "127.0.0.1"


def drag_as_a_class(room: ClassPage, pupils: int, seconds: float) -> list[float]:
    """Latencies [s] of pupils who drag for a third of the time, one movement after the other, and look for the rest."""
    found: list[float] = []
    begin = time.monotonic()

    def pupil(k: int) -> None:
        with room.join() as link:
            greet(link)
            time.sleep(0.1 * k % 1.0)
            while time.monotonic() - begin < seconds:
                stop = time.monotonic() + 1.0
                n = 0
                while time.monotonic() < stop:
                    n += 1
                    at = time.perf_counter()
                    words = ask(link, do="drag", handle="thickness", to=[0.0, 5.3 + 0.01 * (n % 20)], lane="drag")
                    found.append(time.perf_counter() - at)
                    assert "scene" in words
                    time.sleep(1.0 / 60.0)
                ask(link, do="rest")
                time.sleep(2.0)

    with ThreadPoolExecutor(pupils) as threads:
        for done in [threads.submit(pupil, k) for k in range(pupils)]:
            done.result(180)
    return found


def test_what_fails_in_thirty_sessions_on_two_threads(folder: Path, caplog: pytest.LogCaptureFixture) -> None:
    """Sessions share threads, and end while a step of theirs still runs."""
    room = ClassPage(folder)
    try:
        drag_as_a_class(room, 30, 0.5)
        for _ in range(2):
            with contextlib.ExitStack() as stack:
                for link in [stack.enter_context(room.join()) for _ in range(20)]:
                    link.send('{"do": "hello"}')
                    link.send('{"do": "domain"}')
    finally:
        room.close()
    assert [record.getMessage() for record in caplog.records] == []


def test_a_class_leaves_nothing_behind(folder: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    room = ClassPage(folder)
    before = sorted(folder.rglob("*"))
    try:
        assert len(drag_as_a_class(room, 4, 1.0)) > 10
    finally:
        room.close()
    assert sorted(folder.rglob("*")) == before
    assert os.listdir(tmp_path) == []


if __name__ == "__main__":  # latencies of thirty pupils
    import resource
    import sys

    with tempfile.TemporaryDirectory() as place:
        classroom = ClassPage(Path(place))
        first = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        took = drag_as_a_class(classroom, 30, float(sys.argv[1]) if len(sys.argv) > 1 else 10.0)
        last = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        print(f"{len(took)} drags, median {1e3 * statistics.median(took):.1f} ms, 95 % {1e3 * statistics.quantiles(took, n=20)[-1]:.1f} ms")
        print(f"memory {first / 1e3:.0f} MB before, {last / 1e3:.0f} MB at most; load {os.getloadavg()[0]:.1f}")
        classroom.close()
