"""The server of the page: files of the page itself, a socket per page, films.

Every socket has a session of its own, whose work is done by one thread; the loop that serves never computes. What a
page asks for while its session still works waits in an inbox where newer movements of a hand replace older ones.
"""

import asyncio
import contextlib
import contextvars
import json
import logging
import os
import secrets
import socket
import time
from collections.abc import Generator, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from extrados import interrupts
from extrados.explore.classroom import THREADS, Classroom, Teacher
from extrados.explore.film import BadFilm, film
from extrados.explore.frames import Reply
from extrados.explore.guard import BURST, BURST_BYTES, LARGEST_BODY, LARGEST_MESSAGE, MOST_PAGES, RATE, RATE_BYTES, Bucket, Door, Guard
from extrados.explore.session import Session
from extrados.schema.files import confine

if TYPE_CHECKING:
    import uvicorn

log = logging.getLogger(__name__)
STATIC = Path(__file__).parent / "static"
TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".svg": "image/svg+xml", ".json": "application/json"}
#: Messages that wait; a page that sends more without waiting for answers is cut off
MOST_WAITING = 200
#: Seconds for which a page may leave unread what it is sent
UNREAD = 30.0
#: Seconds within which a request is there as a whole; connections without a whole request, of 64 that are served at once
WHOLE_REQUEST, MOST_IDLE = 30.0, 32


class Inbox:
    """Requests of a page that its session has not begun; `lane` of a message: which waiting message it replaces."""

    def __init__(self) -> None:
        self.waiting: list[dict[str, Any]] = []
        self.there = asyncio.Event()

    def put(self, message: dict[str, Any]) -> None:
        """Add a message; in the place of the last one where both move the same thing."""
        lane = message.get("lane")
        if lane and self.waiting and self.waiting[-1].get("lane") == lane:
            self.waiting[-1] = message
        else:
            self.waiting.append(message)
        self.there.set()

    async def take(self) -> dict[str, Any]:
        """The oldest message, waited for."""
        while not self.waiting:
            self.there.clear()
            await self.there.wait()
        return self.waiting.pop(0)


def _words(raw: str) -> dict[str, Any] | None:
    """A message of a page; None if it is not valid."""
    try:
        message = json.loads(raw)
    except (ValueError, RecursionError):
        return None
    return message if isinstance(message, dict) and isinstance(message.get("do"), str) else None


def _next(work: Iterator[Reply]) -> bytes | None:
    """The next reply, as it is sent; None where there are no more."""
    reply = next(work, None)
    return None if reply is None else reply.pack()


def _end(works: list[Generator[Reply, None, None]], session: Session) -> None:
    """Close what a page has asked for, and its session also where that fails."""
    with contextlib.ExitStack() as stack:
        for close in (session.close, *(work.close for work in works)):  # the session last
            stack.callback(close)


def _log_failure(ended: Future[None]) -> None:
    """Tell on the log what went wrong at the end of a page, which nobody waits for."""
    if (error := ended.exception()) is not None:
        log.error("a page could not be closed", exc_info=error)


async def _serve(page: WebSocket, session: Session, inbox: Inbox, shared: ThreadPoolExecutor | None) -> None:
    """Answer the messages of a page, oldest first; long work goes on, step by step, while nothing waits. shared: the threads
    that a class computes on; a page of its own has one."""
    context = contextvars.copy_context()
    context.run(confine, session.shipped_alone)
    going: dict[str, Generator[Reply, None, None]] = {}
    thread = shared or ThreadPoolExecutor(1, "session")

    def timed(work: Iterator[Reply]) -> tuple[bytes | None, float]:
        begin = time.perf_counter()
        return _next(work), time.perf_counter() - begin

    running: list[Future[Any]] = []  # the last step, which goes on where its page goes meanwhile

    async def step(work: Iterator[Reply]) -> bool:
        running[:] = [thread.submit(context.run, timed, work)]
        frame, seconds = await asyncio.wrap_future(running[0])
        if (wait := session.spend(seconds)) > 0.0:
            await asyncio.sleep(wait)
        if frame is not None:
            await page.send_bytes(frame)
        return frame is not None

    def end(_: Future[Any] | None = None) -> None:
        thread.submit(context.run, _end, list(going.values()), session).add_done_callback(_log_failure)
        if shared is None:
            thread.shutdown(wait=False)

    try:
        while True:
            if going and not inbox.waiting:
                lane, work = next(iter(going.items()))
                if not await step(work):
                    del going[lane]
                await asyncio.sleep(0)  # what has come meanwhile is read
                continue
            message = await inbox.take()
            lane, work = str(message.get("lane") or message["do"]), session.answer(message)
            if await step(work):
                going.pop(lane, None)
                going[lane] = work
    finally:  # by a thread, once the last step has ended: other pages do not wait for that
        if running:
            running[0].add_done_callback(end)
        else:
            end()


async def _read(page: WebSocket, inbox: Inbox) -> None:
    """Put the messages of a page into the inbox until it closes, or is closed for sending nonsense or too much."""
    messages, volume = Bucket(BURST, RATE), Bucket(BURST_BYTES, RATE_BYTES)
    while (message := await page.receive())["type"] != "websocket.disconnect":
        text = message.get("text")
        words = None if text is None else _words(text)
        if words is None:
            await page.close(1003, "expected a JSON object with the key 'do'")
            return
        if not (messages.take() and volume.take(len(text or ""))) or len(inbox.waiting) > MOST_WAITING:
            await page.close(1008, "too many messages")
            return
        inbox.put(words)


async def _page(page: WebSocket) -> None:
    state, room = page.app.state, page.app.state.room
    pupil = page.scope["role"] == "pupil"
    if not pupil and state.pages >= MOST_PAGES:
        await page.close(1013, "too many pages are open")
        return
    inbox = Inbox()
    session = room.join(inbox.put) if pupil else state.new_session()
    if session is None:
        await page.close(1013, "the class is full")
        return
    state.pages += not pupil
    tasks: list[asyncio.Task[None]] = []
    try:
        await page.accept()
        tasks = [
            asyncio.create_task(_read(page, inbox)),
            asyncio.create_task(_serve(page, session, inbox, state.threads if pupil else None)),
        ]
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        with contextlib.suppress(WebSocketDisconnect):
            for task in done:
                task.result()
    finally:
        if pupil:
            room.leave(session)
        state.pages -= not pupil
        for task in tasks:
            task.cancel()
            with contextlib.suppress(asyncio.CancelledError, Exception):
                await task


async def _file(request: Request) -> Response:
    name = request.path_params.get("name") or "index.html"
    found = request.app.state.files.get(name)
    if found is None:
        return PlainTextResponse("this file does not exist\n", 404)
    return Response(found[0], media_type=found[1])


async def _film(request: Request) -> Response:
    """A film of a sequence of pictures."""
    state = request.app.state
    if request.scope["role"] == "pupil":
        return PlainTextResponse("pupils of a class cannot make films\n", 403)
    if state.filming:
        return PlainTextResponse("another film is being made: try again when it is finished\n", 429)
    state.filming = True
    try:
        body = bytearray()
        async for part in request.stream():
            body += part
            if len(body) > LARGEST_BODY:
                return PlainTextResponse("the request is too large\n", 413)
        made = await asyncio.get_running_loop().run_in_executor(None, film, bytes(body))
    except BadFilm as error:
        return PlainTextResponse(f"{error}\n", 422)
    finally:
        state.filming = False
    return Response(made.content, media_type=made.type)


def application(doors: list[Door], folder: Path, deck: str | None = None, room: Classroom | None = None) -> Guard:
    """The ASGI application for a working folder; `deck`: the path, within the folder, of what pages open first; room: the
    class whose pupils come in by the second door."""
    files = {
        path.relative_to(STATIC).as_posix(): (path.read_bytes(), TYPES[path.suffix]) for path in STATIC.rglob("*") if path.suffix in TYPES
    }

    routes = [Route("/film", _film, methods=["POST"]), WebSocketRoute("/live", _page), Route("/", _file), Route("/{name:path}", _file)]
    app = Starlette(routes=routes)
    app.state.files, app.state.pages, app.state.filming = files, 0, False
    app.state.room, app.state.threads = room, None if room is None else ThreadPoolExecutor(THREADS, "class")
    app.state.new_session = lambda: Session(folder, deck) if room is None else Teacher(folder, deck, room)
    return Guard(app, doors, 1.0 if room is None else float(room.most))


def hosts_of(sock: socket.socket) -> list[str]:
    """What Host may read on a listening socket: its address, and the names of 127.0.0.1."""
    address, port = sock.getsockname()[:2]
    names = (address, "localhost", "[::1]") if address == "127.0.0.1" else (address,)
    return [f"{name}:{port}" for name in names]


def listen(port: int = 0, strict: bool = False, address: str = "127.0.0.1") -> socket.socket:
    """A socket that listens on an address of this machine, loopback unless another is given; at any free port where that one is
    taken, unless `strict`: OSError then."""
    for wanted in dict.fromkeys((port, port if strict else 0)):
        found = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        found.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            found.bind((address, wanted))
        except OSError:
            found.close()
            if wanted == 0 or strict:
                raise
            continue
        found.listen(64)
        return found
    raise OSError("no port is free")


def new_token() -> str:
    """A word that nobody guesses."""
    return secrets.token_urlsafe(24)


def _socket_protocol() -> type[asyncio.Protocol]:
    """uvicorn's WebSocket protocol, which also drops a connection whose page has not read what it was sent for UNREAD
    seconds: uvicorn itself would wait for ever, and the page would keep its place among those that may be open."""
    from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

    class Protocol(WebSocketsSansIOProtocol):
        unread: asyncio.TimerHandle | None = None

        def connection_made(self, transport: Any) -> None:
            super().connection_made(transport)
            self.transport.set_write_buffer_limits(0)  # told as soon as anything is left unsent

        def pause_writing(self) -> None:
            super().pause_writing()
            self.unread = asyncio.get_running_loop().call_later(UNREAD, self.transport.abort)

        def resume_writing(self) -> None:
            super().resume_writing()
            self._taken()

        def connection_lost(self, exc: Exception | None) -> None:
            super().connection_lost(exc)
            self._taken()

        def _taken(self) -> None:
            if self.unread is not None:
                self.unread.cancel()
                self.unread = None

    return Protocol


def _http_protocol(most_idle: int) -> type[asyncio.Protocol]:
    """uvicorn's HTTP protocol with a limit for connections whose request is not whole yet.

    Such a connection ends WHOLE_REQUEST seconds after it was made, or after the first part of a later request; of more than
    `most_idle` at once the oldest ends. uvicorn itself would wait without limit, and idle connections would shut pages out.
    """
    import h11
    from uvicorn.protocols.http.h11_impl import H11Protocol

    idle: dict[Any, asyncio.TimerHandle] = {}  # the oldest first

    class Protocol(H11Protocol):
        def connection_made(self, transport: Any) -> None:
            super().connection_made(transport)
            self._note_idle()

        def data_received(self, data: bytes) -> None:
            super().data_received(data)
            # an upgraded connection has another protocol by now, and h11 never sees the end of its request
            if self.transport.get_protocol() is self and self.conn.their_state in (h11.IDLE, h11.SEND_BODY):
                self._note_idle()
            else:
                self._note_whole()

        def connection_lost(self, exc: Exception | None) -> None:
            super().connection_lost(exc)
            self._note_whole()

        def _note_idle(self) -> None:
            if self in idle:
                return
            if len(idle) >= most_idle:
                next(iter(idle))._drop()
            idle[self] = asyncio.get_running_loop().call_later(WHOLE_REQUEST, self._drop)

        def _drop(self) -> None:
            self.connections.discard(self)  # those that are served are counted before the loop has closed this one
            self._note_whole()
            self.transport.abort()

        def _note_whole(self) -> None:
            if (timer := idle.pop(self, None)) is not None:
                timer.cancel()

    return Protocol


@dataclass(frozen=True)
class Class:
    """A class at a second door: the socket it listens on, its token, and the most pupils."""

    socket: socket.socket
    token: str
    most: int


def configured(sock: socket.socket, token: str, folder: Path, deck: str | None = None, pupils: Class | None = None) -> "uvicorn.Config":
    """How uvicorn serves pages on a listening socket, and a class on another: bounded in all that a stranger could send."""
    import uvicorn

    doors, room = [Door(token, hosts_of(sock))], None
    if pupils is not None:
        doors.append(Door(pupils.token, hosts_of(pupils.socket), "pupil", near=False))
        room = Classroom(pupils.most)
    browsers = 1 if room is None else 2 + room.most // 4  # each opens up to six connections at once
    return uvicorn.Config(
        application(doors, folder, deck, room),
        log_level="warning",
        access_log=False,
        server_header=False,
        ws=_socket_protocol(),
        ws_max_size=LARGEST_MESSAGE,
        ws_per_message_deflate=False,
        ws_ping_interval=20.0,
        ws_ping_timeout=60.0,
        limit_concurrency=64 * browsers,
        timeout_keep_alive=10,
        timeout_graceful_shutdown=1,
        h11_max_incomplete_event_size=16_384,
        lifespan="off",
        proxy_headers=False,
        http=_http_protocol(MOST_IDLE * browsers),
        loop="asyncio",
    )


def serve(sock: socket.socket, token: str, folder: Path, deck: str | None = None, pupils: Class | None = None) -> None:
    """Serve pages on a listening socket, and a class on another, until a signal ends it."""
    import uvicorn

    with contextlib.suppress(KeyboardInterrupt):
        sockets = [sock] if pupils is None else [sock, pupils.socket]
        uvicorn.Server(configured(sock, token, folder, deck, pupils)).run(sockets=sockets)


def main() -> None:
    """The process that serves, started by `supervisor` with the sockets and what else it needs in its environment."""
    given = json.loads(os.environ.pop("EXTRADOS_EXPLORE"))
    interrupts.end_with(os.getppid())
    with contextlib.ExitStack() as stack:
        sock = stack.enter_context(socket.socket(fileno=given["socket"]))
        pupils = None
        if given["class"]:
            number, token, most = given["class"]
            pupils = Class(stack.enter_context(socket.socket(fileno=number)), token, most)
        serve(sock, given["token"], Path(given["folder"]), given["deck"], pupils)


if __name__ == "__main__":
    main()
