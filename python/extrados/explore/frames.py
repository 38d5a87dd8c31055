"""Messages between session and page: JSON words, and arrays as they lie in memory."""

import json
import struct
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from extrados.results.fields import plain

#: What arrays are sent as: numbers of the picture need no more than single precision, those that are read do
TYPES = {"f": "<f4", "d": "<f8", "i": "<i4", "b": "|u1"}


@dataclass
class Reply:
    """What the page is told: words, and arrays by name. Floats of 64 bits are sent as 32 unless `exact` names them."""

    words: dict[str, Any]
    arrays: dict[str, np.ndarray] = field(default_factory=dict)
    exact: frozenset[str] = frozenset()

    def pack(self) -> bytes:
        """Length of the head (4 bytes, little endian), the head as JSON, and the arrays, each from a multiple of 8 on."""
        parts, places, offset = [], {}, 0
        with np.errstate(over="ignore"):  # what single precision cannot hold is infinite, and not drawn
            for name, data in self.arrays.items():
                array = np.asarray(data)
                sort = _sort(array, name in self.exact)
                raw = array.astype(TYPES[sort], order="C", copy=False).tobytes()
                places[name] = [sort, array.shape, offset]
                room = -len(raw) % 8
                parts += [raw, bytes(room)]
                offset += len(raw) + room
        words = {**self.words, "arrays": places}
        try:
            told = _JSON.encode(words)
        except (TypeError, ValueError):  # not a number, infinite, or a key that is no text
            told = _JSON.encode(plain(words))
        head = told.encode(errors="backslashreplace")  # halves of surrogate pairs that a page sent: JSON for the same
        head += b" " * (-(len(head) + 4) % 8)
        return b"".join([struct.pack("<I", len(head)), head, *parts])


_JSON = json.JSONEncoder(ensure_ascii=False, allow_nan=False, separators=(",", ":"), default=plain)


def _sort(array: np.ndarray, exact: bool) -> str:
    """What an array is sent as."""
    kind = array.dtype.kind
    if kind == "f":
        return "d" if exact else "f"
    return "b" if kind == "b" or (kind == "u" and array.itemsize == 1) else "i"
