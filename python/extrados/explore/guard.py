"""Access control of the server: only the program's own pages, by their token, with bounded size and rate of requests.

A page of any other site in the same browser can send requests to 127.0.0.1, and a host name that points to 127.0.0.1 makes
these requests look like those of the same site. Three checks are therefore required: the name in Host, the site in Origin,
and a token that only the printed address contains.
"""

import hmac
import ipaddress
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

#: Bytes of an address, of the heads of a request, of a message of a page, and of what may be sent to be filmed
LONGEST_PATH, LARGEST_HEADS, LARGEST_MESSAGE, LARGEST_BODY = 1024, 16_384, 16_000_000, 64_000_000
#: Digits of the length of a body: more than one that is taken needs, and far fewer than int() raises on (4300)
MOST_DIGITS = 12
#: Pages at a time
MOST_PAGES = 12
#: Messages a page may send in a burst, and in a second from then on: a hand moves 120 times a second at most
BURST, RATE = 600, 300.0
#: Bytes likewise
BURST_BYTES, RATE_BYTES = 64_000_000, 8_000_000.0
#: Requests of all pages in a burst and a second
BURST_REQUESTS, RATE_REQUESTS = 400, 100.0

HEADERS = [
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cache-control", b"no-store"),
    (
        b"content-security-policy",
        b"default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; "
        b"base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
]


@dataclass
class Bucket:
    """Lets `most` pass at once and `rate` a second from then on."""

    most: float
    rate: float
    left: float = field(init=False)
    last: float = field(default_factory=time.monotonic)

    def __post_init__(self) -> None:
        self.left = self.most

    def take(self, amount: float = 1.0) -> bool:
        """Whether `amount` may pass now."""
        now = time.monotonic()
        self.left = min(self.most, self.left + (now - self.last) * self.rate)
        self.last = now
        if self.left < amount:
            return False
        self.left -= amount
        return True


@dataclass(frozen=True)
class Door:
    """A way in: its token, and what Host may read, such as 127.0.0.1:8737. role: "page", or "pupil" in a class; near:
    only this machine may come in by it."""

    token: str
    hosts: list[str]
    role: str = "page"
    near: bool = True


class Guard:
    """ASGI: passes on to `app` what comes from a page by one of the doors, with the path behind the token and the role of the
    door; answers the rest. share: of the requests that are let in, one where a single person uses the pages."""

    def __init__(self, app: Callable[..., Any], doors: list[Door], share: float = 1.0):
        self.app, self.doors = app, doors
        self.hosts = {host.lower().encode() for door in doors for host in door.hosts}
        self.requests = Bucket(share * BURST_REQUESTS, share * RATE_REQUESTS)

    async def __call__(self, scope: dict[str, Any], receive: Callable[..., Any], send: Callable[..., Any]) -> None:
        if scope["type"] == "lifespan":
            await self.app(scope, receive, send)
            return
        reason = self.objection(scope)
        if reason:
            await _refuse(scope, receive, send, *reason)
            return
        path = "/" + scope["path"].split("/", 2)[2]
        role = next(door.role for door in self.doors if _opens(door, scope))
        scope = {**scope, "path": path, "raw_path": path.encode(), "root_path": "", "role": role}
        await self.app(scope, receive, _with_headers(send))

    def objection(self, scope: dict[str, Any]) -> tuple[int, str] | None:
        """Status and reason of a refusal, None if the request is passed on."""
        socket = scope["type"] == "websocket"
        heads: dict[bytes, list[bytes]] = {}
        for name, value in scope["headers"]:
            heads.setdefault(name.lower(), []).append(value.strip().lower())
        if not self.requests.take():
            return 429, "too many requests"
        if len(heads.get(b"host", [])) != 1 or heads[b"host"][0] not in self.hosts:
            return 421, "this server accepts requests to its own address only"
        origin = heads.get(b"origin", [])
        if len(origin) > 1 or (origin and origin[0] != b"http://" + heads[b"host"][0]):
            return 403, "requests from other sites are refused"
        if not origin and (socket or scope["method"] not in ("GET", "HEAD")):
            return 403, "a request without an origin is refused"
        # A tab that goes to the page from the file of `supervisor` is no danger: it needs the token, and reads nothing
        leads = scope.get("method") == "GET" and heads.get(b"sec-fetch-dest") == [b"document"]
        if heads.get(b"sec-fetch-site", [b"none"])[0] not in (b"none", b"same-origin") and (socket or not leads):
            return 403, "requests from other sites are refused"
        if not socket and scope["method"] not in ("GET", "HEAD", "POST"):
            return 405, "only GET and POST requests are accepted"
        if len(scope.get("raw_path") or b"") + len(scope.get("query_string") or b"") > LONGEST_PATH:
            return 414, "the address is too long"
        if sum(len(name) + len(value) for name, value in scope["headers"]) > LARGEST_HEADS:
            return 431, "the headers of the request are too long"
        lengths = heads.get(b"content-length", [b"0"])
        if len(lengths) != 1 or not lengths[0].isdigit() or len(lengths[0]) > MOST_DIGITS or int(lengths[0]) > LARGEST_BODY:
            return 413, "the request is too large"
        door = next((door for door in self.doors if _opens(door, scope)), None)
        if door is None:
            return 403, "the address lacks its token: open the whole address that `extrados explore` printed"
        if heads[b"host"][0].decode("latin-1") not in [host.lower() for host in door.hosts]:
            return 421, "this server accepts requests to its own address only"
        if door.near and not _is_near(scope):
            return 403, "this address can be opened only on the machine of the server"
        return None


def _opens(door: Door, scope: dict[str, Any]) -> bool:
    """Whether the path of a request begins with the token of a door."""
    parts = scope["path"].split("/", 2)
    return len(parts) == 3 and hmac.compare_digest(parts[1].encode("utf-8", "replace"), door.token.encode())


def _is_near(scope: dict[str, Any]) -> bool:
    """Whether a request comes from this machine over loopback."""
    client = scope.get("client")
    try:
        return client is None or ipaddress.ip_address(client[0]).is_loopback
    except ValueError:
        return False


async def _refuse(scope: dict[str, Any], receive: Callable[..., Any], send: Callable[..., Any], status: int, why: str) -> None:
    if scope["type"] == "websocket":
        await receive()
        await send({"type": "websocket.close", "code": 1008, "reason": why[:120]})
        return
    body = why.encode() + b"\n"
    heads = [(b"content-type", b"text/plain; charset=utf-8"), (b"content-length", str(len(body)).encode()), *HEADERS]
    await send({"type": "http.response.start", "status": status, "headers": [*heads, (b"connection", b"close")]})
    await send({"type": "http.response.body", "body": b"" if scope["method"] == "HEAD" else body})


def _with_headers(send: Callable[..., Any]) -> Callable[..., Any]:
    async def sends(message: dict[str, Any]) -> None:
        if message["type"] == "http.response.start":
            message = {**message, "headers": [*message.get("headers", []), *HEADERS]}
        await send(message)

    return sends
