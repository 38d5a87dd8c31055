"""Decks that are wrong in all the ways decks are: bytes, words, values, keys and tables are changed at random."""

import random
import re

#: Values that stand where another was
HOSTILE = (
    "nan",
    "inf",
    "-inf",
    "0",
    "-1",
    "1e308",
    "-1e308",
    "5e-324",
    "1e-300",
    "9" * 400,
    "2147483648",
    "-2147483649",
    "true",
    "[]",
    "[1]",
    "[[]]",
    "{}",
    "{ a = 1 }",
    '""',
    '"\\u0000"',
    '"\\u001b[31m"',
    '"../../etc/passwd"',
    '"/dev/zero"',
    '"1,5 m"',
    '"9**9**9 m"',
    '"1e400 m"',
    '"1 kg"',
    '"nan m"',
    "1979-05-27",
    "07:32:00",
    "'''\n\n'''",
    "0x7fffffff",
    "0b1",
    "1_0",
    '"' + "a" * 5000 + '"',
    "[" * 50 + "]" * 50,
    "[1.0, 2.0, 3.0]",
    '["a", 1]',
    "1.5",
    "1",
    '"1.0 g"',
    '"arch"',
    '"0.3 m"',
    "-0.0",
)
_VALUE = re.compile(r"=\s*(.+)$", re.M)
_NUMBER = re.compile(r"(?<![\w.\"])-?\d+(?:\.\d+)?(?:e-?\d+)?(?![\w.])")
_KEY = re.compile(r"^(\w[\w.-]*)\s*=", re.M)


def hostile(deck: str, rng: random.Random, tries: int | None = None) -> bytes:
    """A deck with one to four faults of any kind."""
    for _ in range(tries or rng.randint(1, 4)):
        deck = rng.choice((_value, _value, _bytes, _line, _key, _scaled, _table))(deck, rng)
    raw = deck.encode("utf-8", errors="surrogateescape")
    if raw and rng.random() < 0.05:
        raw = bytearray(raw)
        for _ in range(rng.randint(1, 5)):
            raw[rng.randrange(len(raw))] = rng.randrange(256)
        raw = bytes(raw)
    return raw


def plausible(deck: str, rng: random.Random) -> str:
    """A deck whose numbers are others: most are still valid, some are absurd."""
    for _ in range(rng.randint(1, 3)):
        deck = rng.choice((_scaled, _scaled, _scaled, _scaled, _extreme, _value))(deck, rng)
    return deck


def _span(pattern: re.Pattern, deck: str, rng: random.Random, group: int) -> tuple[int, int] | None:
    found = [m.span(group) for m in pattern.finditer(deck)]
    return rng.choice(found) if found else None


def _put(deck: str, span: tuple[int, int] | None, text: str) -> str:
    return deck if span is None else deck[: span[0]] + text + deck[span[1] :]


def _value(deck: str, rng: random.Random) -> str:
    return _put(deck, _span(_VALUE, deck, rng, 1), rng.choice(HOSTILE))


def _extreme(deck: str, rng: random.Random) -> str:
    return _put(deck, _span(_NUMBER, deck, rng, 0), rng.choice(("1e308", "5e-324", "1e-9", "1e9", "0", "-1", "1e-100", "1e100")))


def _scaled(deck: str, rng: random.Random) -> str:
    span = _span(_NUMBER, deck, rng, 0)
    if span is None:
        return deck
    number = deck[slice(*span)]
    if re.fullmatch(r"-?\d+", number) and len(number) < 10:
        return _put(deck, span, str(max(0, int(number) + rng.randint(-2, 3))))
    return _put(deck, span, f"{float(number) * 10.0 ** rng.uniform(-1.0, 1.0):.4g}")


def _bytes(deck: str, rng: random.Random) -> str:
    k = rng.randrange(len(deck) + 1)
    return rng.choice(
        (
            deck[:k] + chr(rng.choice((0, 7, 9, 10, 13, 27, 34, 61, 91, 93, 127, 160, 0x202E, 0x1F600))) + deck[k:],
            deck[:k],
            deck[:k] + deck[k + rng.randint(1, 8) :],
            deck[:k] + deck[max(0, k - 10) :],
        )
    )


def _line(deck: str, rng: random.Random) -> str:
    lines = deck.split("\n")
    k, m = rng.randrange(len(lines)), rng.randrange(len(lines))
    match rng.randrange(3):
        case 0:
            lines.insert(m, lines[k])
        case 1:
            del lines[k]
        case _:
            lines[k], lines[m] = lines[m], lines[k]
    return "\n".join(lines)


def _key(deck: str, rng: random.Random) -> str:
    new = rng.choice(("kind", "file", "joints", "mesh", "colour", "radius ", '"a b"', "a.b.c", "structure", "threads"))
    return _put(deck, _span(_KEY, deck, rng, 1), new)


def _table(deck: str, rng: random.Random) -> str:
    new = rng.choice(
        ("[structure]", "[[analysis]]", "[motion]", "[material]", "[joints]", "[[structure]]", "[analysis.mesh]", "[materials.x]")
    )
    lines = deck.split("\n")
    lines.insert(rng.randrange(len(lines) + 1), new)
    return "\n".join(lines)
