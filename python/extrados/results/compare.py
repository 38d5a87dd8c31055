"""What changed between two runs: the deck, the program, verdicts, numbers, warnings."""

import math
from dataclasses import dataclass, field
from typing import Any

from extrados.results.store import Stored

#: Keys of results that tell how long something took, not what it found
CLOCK = ("seconds", "seconds_per_event", "sections_per_second")
#: Keys of an assessment that follow from its verdicts
FOLLOWS = ("agreement", "explains")
#: By which of their keys the elements of a list are known
NAMES = ("strategy", "rule", "wall", "name")
#: Texts longer than this are told by the verdicts, not again
LONG = 60
#: Relative differences of numbers up to this are rounding
ROUNDING = 1e-9


@dataclass(frozen=True)
class Change:
    """A key that has another value; ratio: new over old, None where these are no numbers or the old one is zero."""

    key: str
    old: Any
    new: Any
    ratio: float | None = None

    @property
    def size(self) -> float:
        """How large it is, by which changes are ordered."""
        if self.ratio is None or self.ratio <= 0.0:
            return math.inf
        return abs(math.log(self.ratio))


@dataclass(frozen=True)
class Comparison:
    """program and deck: keys with other values; verdicts: of analyses of both runs, that are other; numbers: of each
    analysis of both, the greatest change first; only_old, only_new: analyses of one alone; warnings_gone, warnings_new."""

    program: list[Change]
    deck: list[Change]
    verdicts: list[Change]
    numbers: dict[str, list[Change]]
    only_old: list[str] = field(default_factory=list)
    only_new: list[str] = field(default_factory=list)
    warnings_gone: list[str] = field(default_factory=list)
    warnings_new: list[str] = field(default_factory=list)

    @property
    def same(self) -> bool:
        """Whether nothing but the clock differs."""
        lists = (self.deck, self.verdicts, self.only_old, self.only_new, self.warnings_gone, self.warnings_new)
        return not any(lists) and not any(self.numbers.values())


def compare(old: Stored, new: Stored, tolerance: float = ROUNDING) -> Comparison:
    """Two runs, analysis by analysis of the same name; numbers that differ by no more than `tolerance` count as the same."""
    a, b = ({row["name"]: row for row in run.analyses} for run in (old, new))
    both = [name for name in a if name in b]
    decks = [flat({k: v for k, v in run.summary["deck"]["resolved"].items()}) for run in (old, new)]
    warnings = [[f"{name}: {w}" for name, row in rows.items() for w in row["warnings"]] for rows in (a, b)]
    numbers = {name: changes(flat(a[name]["results"]), flat(b[name]["results"]), tolerance) for name in both}
    verdicts = []
    for name in both:
        one, two = (_outcome(rows[name]) for rows in (a, b))
        ratios = [row["verdict"]["ratio"] if row["verdict"] else None for row in (a[name], b[name])]
        ratio = ratios[1] / ratios[0] if None not in ratios and ratios[0] else None
        if one != two or (ratio is not None and abs(ratio - 1.0) > tolerance):
            verdicts.append(Change(name, _told(one, ratios[0]), _told(two, ratios[1]), ratio))
    return Comparison(
        changes(old.summary["extrados"], new.summary["extrados"], 0.0),
        changes(decks[0], decks[1], 0.0),
        verdicts,
        {name: found for name, found in numbers.items() if found},
        [n for n in a if n not in b],
        [n for n in b if n not in a],
        [w for w in warnings[0] if w not in warnings[1]],
        [w for w in warnings[1] if w not in warnings[0]],
    )


def _outcome(row: dict[str, Any]) -> str:
    return row["verdict"]["outcome"] if row["verdict"] else row["status"]


def _told(outcome: str, ratio: float | None) -> str:
    return outcome if ratio is None else f"{outcome} ({ratio:.4g})"


def flat(value: Any, prefix: str = "") -> dict[str, Any]:
    """Values by their dotted keys; elements of lists by their names where each has another, else by their number."""
    if isinstance(value, dict):
        pairs = [(str(k), v) for k, v in value.items()]
    elif isinstance(value, list):
        pairs = list(zip(_names(value), value, strict=True))
    else:
        return {prefix[:-1]: value}
    found: dict[str, Any] = {}
    for key, inner in pairs:
        found |= flat(inner, f"{prefix}{key}.")
    return found


def _names(values: list) -> list[str]:
    """What the elements of a list are called."""
    for key in NAMES:
        names = [v.get(key) if isinstance(v, dict) else None for v in values]
        if values and all(isinstance(n, str) for n in names) and len(set(names)) == len(names):
            return [str(n) for n in names]
    return [str(k) for k in range(len(values))]


def changes(old: dict[str, Any], new: dict[str, Any], tolerance: float) -> list[Change]:
    """Keys whose values differ, the greatest relative change first; a key of one alone has None in the other."""
    found = []
    for key in dict.fromkeys([*old, *new]):
        one, two = old.get(key), new.get(key)
        if (
            key.rpartition(".")[2] in CLOCK
            or any(part in FOLLOWS for part in key.split("."))
            or one == two
            or any(isinstance(v, str) and len(v) > LONG for v in (one, two))
        ):
            continue
        ratio = None
        if isinstance(one, int | float) and isinstance(two, int | float) and not {type(one), type(two)} & {bool}:
            if abs(two - one) <= tolerance * max(abs(one), abs(two)):
                continue
            ratio = two / one if one else None
        found.append(Change(key, one, two, ratio))
    return sorted(found, key=lambda c: -c.size)
