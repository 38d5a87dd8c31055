"""Relations that must hold between what strategies say of random buildings: the registry.

A relation is a function of a case, which its strategy of hypothesis draws: a deck, or a deck and what is done to it. It
raises Broken where it does not hold, and calls `reject` where there is nothing to compare.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from asking import Answer, Deck, ask, must, near, same
from buildings import KINDS, SECTIONS, SOLIDS, decks, number
from hypothesis import reject
from hypothesis import strategies as st

GRAVITY = 9.80665


#: Discrete elements as rigid contacts
RIGID = {"solver": "nonsmooth"}


#: Accuracy of the tilt test of discrete elements in these relations [g]
SLOW = {"test": "tilt", "solver": "nonsmooth", "tilt_accuracy": 0.002, "time_step": 0.002}


@dataclass(frozen=True)
class Relation:
    """One relation: the strategies that it asks, the cases that it is asked of, what must hold, and within which tolerance.

    exception: a documented reason for which a strategy breaks it, which the function then leaves out. awaits: the fault that
    breaks it today, which is expected to be seen at the first of the examples. share: of the cases of the long run. examples: cases
    that broke it once.
    """

    name: str
    asks: tuple[str, ...]
    case: st.SearchStrategy
    holds: Callable[..., None]
    within: float
    exception: str = ""
    awaits: str = ""
    share: float = 1.0
    examples: tuple = ()

    def check(self, case: Any) -> None:
        """Broken where the case does not keep it."""
        self.holds(*(case if isinstance(case, tuple) else (case,)), self.within)


RELATIONS: dict[str, Relation] = {}


def relation(asks: str, case: st.SearchStrategy, within: float = 1e-6, of: str = "", **more: Any) -> Callable:
    """Register a function of a case and a tolerance under its name. of: the one strategy of several it is registered for."""

    def registered(holds: Callable) -> Callable:
        name = f"{holds.__name__} {of}".strip().replace("_", "-").replace(" ", "-of-")
        RELATIONS[name] = Relation(name, tuple(asks.split()), case, holds, within, **more)
        return holds

    return registered


def ok(*answers: Answer) -> None:
    """Go on only where all have a result."""
    if not all(a.answers for a in answers):
        reject()


def asked_of(deck: Deck) -> Deck:
    """The table of the quickest analysis without a motion that can look at the building."""
    kind = deck["structure"]["kind"]
    if kind == "building":
        return {"kind": "local-mechanism", "mechanism": "building"}
    # One start: the least of random states without dilatancy takes most of the time of solids, and other relations look at it.
    return {"kind": "tilt", "direction": 0.0, "starts": 1} if kind in SOLIDS else {"kind": "tilt"}


def statics(deck: Deck) -> Answer:
    """Its answer."""
    return ask(deck, **asked_of(deck))


def filled(there: Any) -> Any:
    """A table without the keys that hold nothing."""
    if isinstance(there, dict):
        return {k: filled(v) for k, v in there.items() if v is not None}
    return [filled(v) for v in there] if isinstance(there, list) else there


#: Of results: what depends on the way to the answer, on the order of what is equal, or on which of many lines of thrust it is
OF_THE_WAY = (
    "gap",
    "residual",
    "joint",
    "hinge",
    "touching",
    "steps",
    "factor_bytes",
    "opening_contacts",
    "fastest",
    "sliding",
    "reactions",
    "required_friction",
)
#: The part of the joints that holds a thrust line is found within this [-], and its inverse, the geometric safety factor, so
PART = 1e-3


def alike(told: str, one: Answer, other: Answer, within: float) -> None:
    """Two answers have the same outcome and the same numbers; words and counts of work may differ."""
    same(told, one, other)
    a, b = ({k: v for k, v in _flat(x.numbers).items() if not any(word in k for word in OF_THE_WAY)} for x in (one, other))
    must(set(a) == set(b), f"{told}: other results: {sorted(set(a) ^ set(b))}")
    for name in [name for name in a if "safety_factor" in name or "part_of_joints" in name]:
        one, other = (None if v is None else 1.0 / v if "safety_factor" in name else v for v in (a.pop(name), b[name]))
        must(abs((one or 0.0) - (other or 0.0)) <= PART + within, f"{told}: {name}: parts {one} and {other}")
    scale: dict[str, float] = {}  # of all numbers of one unit: one of them may be what is left of a sum
    for name, value in a.items():
        if isinstance(value, float):
            scale[name.rpartition("_")[2]] = max(abs(value), scale.get(name.rpartition("_")[2], 1e-6))
    for name, value in a.items():
        if isinstance(value, float) and isinstance(b[name], float | int):
            near(f"{told}: {name}", value, b[name], within, scale[name.rpartition("_")[2]])


def _flat(there: Any, name: str = "") -> dict[str, Any]:
    if isinstance(there, dict):
        return {k: v for key, value in there.items() for k, v in _flat(value, f"{name}.{key}").items()}
    if isinstance(there, list):
        return {k: v for i, value in enumerate(there) for k, v in _flat(value, f"{name}.{i}").items()}
    return {name: there}


CRACKS = {"density": 2000.0, "young": 2e9, "tensile_strength": 1e5, "fracture_energy": 50.0}


ANY = decks(*KINDS).filter(lambda deck: deck["structure"]["kind"] != "mesh")


STONES = decks(*SECTIONS, *SOLIDS)


#: Why slow tilts of walls are not compared with each other, but with the bounds of limit analysis (a-slow-tilt)
INTERVAL = "states with friction without dilatancy are an interval: a wall of several blocks ends at any of them"


PUSH = {"mesh": {"size": 1.2, "layers": 3}, "events": 15}


MASONRY = st.just(CRACKS)


def recorded(folder: Path, step: float, values: np.ndarray) -> Deck:
    """A motion of a file in the folder, values in g."""
    rows = [f"{k * step:.6f},{value:.9g}" for k, value in enumerate(values)]
    (folder / "motion.csv").write_text("time_s,acceleration_g\n" + "\n".join(rows) + "\n")
    return {"kind": "record", "file": "motion.csv"}


EARTHQUAKES = st.tuples(st.integers(6, 10), st.integers(1, 10**6)).map(
    lambda t: {"kind": "generated", "mmi": t[0], "duration": 2.0, "seed": t[1], "lines": 8}
)


SCALES = st.sampled_from([0.25, 2.0, 4.0])


WEAK = {"kind": "sine-pulse", "amplitude": "0.02 g", "period": 0.3}


WEAK_SET = {"kind": "generated", "mmi": 4, "duration": 1.0, "lines": 5}


RECTANGLES = st.tuples(number(0.2, 2.0), number(1.5, 8.0)).map(lambda t: (t[0], float(f"{t[0] * t[1]:.5g}")))


SLIDERS = st.tuples(number(0.5, 2.0), number(0.3, 0.9), number(0.1, 0.5)).map(
    lambda t: {"structure": {"kind": "block", "width": t[0], "height": float(f"{t[0] * t[1]:.4g}")}, "joints": {"friction": round(t[2], 4)}}
)


SLIDES = {"structure": {"kind": "block", "width": 0.5, "height": 0.3}, "joints": {"friction": 0.2}}
