"""Who may talk to the server of the page."""

from extrados.explore.guard import LARGEST_BODY, Door, Guard


def objection(length: bytes) -> tuple[int, str] | None:
    heads = [(b"host", b"127.0.0.1:8737"), (b"origin", b"http://127.0.0.1:8737"), (b"content-length", length)]
    scope = {"type": "http", "method": "POST", "path": "/token/film", "raw_path": b"/token/film", "headers": heads}
    return Guard(None, [Door("token", ["127.0.0.1:8737"])]).objection(scope)


def test_a_length_that_is_none_or_beyond_all_bounds_is_answered() -> None:
    assert objection(b"12") is None
    for length in (str(LARGEST_BODY + 1).encode(), b"9" * 5000, b"-1", b"\xb2", b""):
        assert objection(length) == (413, "the request is too large")
