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
        for name, data in self.arrays.items():
            array = np.asarray(data)
            sort = {"f": "d" if name in self.exact else "f", "b": "b", "u": "b" if array.itemsize == 1 else "i"}.get(
                array.dtype.kind, "i"
            )
            with np.errstate(over="ignore"):  # what single precision cannot hold is infinite, and not drawn
                raw = np.ascontiguousarray(array, dtype=TYPES[sort]).tobytes()
            places[name] = [sort, list(array.shape), offset]
            room = -len(raw) % 8
            parts.append(raw + bytes(room))
            offset += len(raw) + room
        head = json.dumps(plain({**self.words, "arrays": places}), ensure_ascii=False, allow_nan=False).encode()
        head += b" " * (-(len(head) + 4) % 8)
        return struct.pack("<I", len(head)) + head + b"".join(parts)
