"""What the verdicts hang on: sizes and properties moved one by one, margins anew, and the value at which a verdict turns."""

import itertools
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from extrados import interrupts, kinds
from extrados.analyses.assess.asking import Asker
from extrados.analyses.assess.budget import OutOfTime
from extrados.analyses.assess.hazard import Demanded
from extrados.analyses.batches import stacked, sweep
from extrados.analyses.changes import changed, lacking
from extrados.analyses.context import Context
from extrados.analyses.limit.asked import unit_at
from extrados.analyses.sequence import run_one
from extrados.core.calls import within
from extrados.decks.reader import DeckError, make_deck
from extrados.results.limit import Tilt
from extrados.results.statistics import OverLevels
from extrados.views.building import Building

#: How far each value is moved, as a share of it, by the last part of its key; others by ELSE
SHARES = {"friction": 0.2, "density": 0.1, "restitution": 0.1, "thickness_factor": 0.1}
ELSE = 0.1
#: Factors on a value between which the one is sought at which a verdict turns
SOUGHT = (0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.4, 1.7, 2.0)
#: Halvings of the interval in which a verdict turns
HALVINGS = 5
#: Sizes that make a structure thick, by its kind; thickness where none stands here
THICKNESS = {
    "block": ("structure.width",),
    "column": ("structure.width",),
    "stack": ("structure.lower_width",),
    "frame": ("structure.width",),
    "vault": ("structure.thickness", "structure.buttress_width"),
    "bridge": ("structure.spans.0.thickness",),
}
#: Values that cannot pass these
BOUNDS = {"thickness_factor": (0.2, 1.0), "restitution": (0.0, 1.0), "friction": (0.0, 10.0)}
STRATEGIES = ("tilt", "rocking")
UNKNOWN = np.full(len(STRATEGIES), np.nan)


@dataclass(frozen=True)
class Varied:
    """A key of the deck and its value as it is; whole: it takes whole numbers."""

    key: str
    base: float
    unit: str
    share: float
    whole: bool = False

    def bounded(self, value: float) -> float:
        """A value of the key, brought within what the key may be."""
        low, high = BOUNDS.get(self.key.rpartition(".")[2], (0.0, np.inf))
        return float(min(max(value, low), high))


@dataclass(frozen=True)
class MarginsJob:
    """Member k: margins of limit analysis and of rocking with keys[k] at values[k]; NaN where there is none.

    data: the deck without its analyses; levels: the factors at which rocking is tried; peak_g: the demand of statics; without:
    what of the deck tilt and fragility cannot take into account; wall: the side of an abutting wall, "" without one.
    """

    data: dict[str, Any]
    folder: str
    keys: list[str]
    values: list[float]
    levels: list[float]
    count: int | None
    acceptable: float
    peak_g: float
    without: tuple[tuple[str, ...], ...]
    wall: str

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        return stacked(lambda k: self._one(self.keys[k], self.values[k], threads), first, count)

    def _one(self, key: str, value: float, threads: int) -> dict[str, np.ndarray]:
        levels: dict[str, Any] = {"kind": "fragility", "intensity": "scale", "levels": self.levels, "bootstrap": 0}
        if self.count is not None:
            levels["count"] = self.count
        margins = np.full(len(STRATEGIES), np.nan)
        data = changed(self.data, key, value)
        for k, asked in enumerate(({"kind": "tilt"}, levels)):
            try:
                deck = make_deck({**lacking(data, self.without[k]), "analysis": [asked]}, Path(self.folder))
            except DeckError:
                continue
            (options,), (building,) = deck.analyses, deck.buildings
            r = run_one(Context(deck, threads), options, building).results
            if isinstance(r, Tilt):
                senses = {"left": (False,), "right": (True,)}.get(self.wall, (False, True))
                margins[k] = r.judged_towards(Demanded(self.peak_g), senses).ratio
            elif options.kind == "tilt" and (judged := r.judged(Demanded(self.peak_g))) is not None:  # of solids
                margins[k] = np.nan if judged.ratio is None else judged.ratio
            elif isinstance(r, OverLevels):
                margins[k] = margin_over(r, self.acceptable if self.count is not None else 0.0)
        return {"margin": margins}


def margin_over(r: OverLevels, acceptable: float) -> float:
    """The factor between the last level that is borne and the first that is not, on the middle of their logarithms."""
    shares = [1.0 if p is None else p for p in r.collapse_probability]
    first = next((i for i, p in enumerate(shares) if p > acceptable), None)
    if first is None:
        return float(r.levels[-1])
    return float(np.sqrt(r.levels[first] * r.levels[first - 1])) if first else float(r.levels[0])


def varied(building: Building, given: dict[str, float] | None, restitution: float | None) -> list[Varied]:
    """The keys that are moved: those of the deck, or thickness, corners, friction, restitution and density as the
    structure knows them. restitution: c_v of rocking, where a rule gives it."""
    structure = building.require_structure()
    keys = given or dict.fromkeys(
        [
            *THICKNESS.get(structure.kind, ("structure.thickness",)),
            "structure.thickness_factor",
            "joints.friction",
            "joints.restitution",
            "material.density",
        ]
    )
    found = []
    for key, share in keys.items():
        table, _, rest = key.partition(".")
        base = _value(getattr(building, table, None), rest)
        if key == "joints.restitution" and not isinstance(base, float):
            base = restitution
        if isinstance(base, int | float) and not isinstance(base, bool) and base > 0.0:
            name = rest.rpartition(".")[2]
            held = getattr(building, table)
            unit = unit_at(type(held[0] if isinstance(held, tuple) else held), rest)
            found.append(Varied(key, float(base), unit, share or SHARES.get(name, ELSE), isinstance(base, int)))
    return found


def _value(table: Any, way: str) -> Any:
    for part in way.split("."):
        if isinstance(table, list | tuple):
            table = table[int(part)] if part.isdecimal() and int(part) < len(table) else None
        else:
            table = getattr(table, part, None)
    return table


@dataclass(frozen=True)
class Moved:
    """A varied key: values below and above, margins [tilt, rocking] there, and the values at which each margin passes 1
    (None: at none that was tried); tried: values and margins of all, ascending."""

    what: Varied
    low: float
    high: float
    at_base: list[float | None]
    at_low: list[float | None]
    at_high: list[float | None]
    turns: list[float | None]
    tried: list[tuple[float, list[float | None]]]


class Margins:
    """Margins over keys and values, each computed once, by the batch layer."""

    def __init__(
        self, context: Context, data: dict[str, Any], levels: list[float], count: int | None, acceptable: float, peak_g: float, asker: Asker
    ):
        self.context, self.data, self.levels, self.count = context, data, levels, count
        self.acceptable, self.peak_g, self.asker, self.stopped = acceptable, peak_g, asker, False
        self.known: dict[tuple[str, float], np.ndarray] = {}

    def ask(self, wanted: list[tuple[str, float]]) -> None:
        """Compute the margins that are missing; OutOfTime after the deadline, batches.Unfinished where the user stopped it."""
        new = [w for w in dict.fromkeys(wanted) if w not in self.known]
        if not new:
            return
        building = self.context.building
        considered = [kinds.load(kinds.ANALYSES[kind].table).considers for kind in ("tilt", "fragility")]
        without = tuple(tuple(what for what in building.special_keys if what not in able) for able in considered)
        job = MarginsJob(
            self.data,
            str(self.context.deck.folder),
            [k for k, _ in new],
            [v for _, v in new],
            self.levels,
            self.count,
            self.acceptable,
            self.peak_g,
            without,
            building.supports.abutting_wall or "",
        )
        clock, signals = self.asker.clock, len(interrupts.asked)
        with within(self.asker.deadline - clock(), clock) as limit:
            swept = sweep(self.context, "sensitivity", job, len(new), "sensitivity", slow=True)
        if swept.interrupted and limit.passed and len(interrupts.asked) == signals:
            raise OutOfTime
        found = swept.whole()
        self.known |= {w: found["margin"][i] for i, w in enumerate(new)}

    def moved(self, keys: list[Varied]) -> list[Moved]:
        """All keys at once, so that each round is one sweep; of rounds that the deadline stops the values stay unknown."""
        ends = {v.key: (v.bounded(v.base * (1.0 - v.share)), v.bounded(v.base * (1.0 + v.share))) for v in keys}
        tried = {v.key: sorted({v.bounded(v.base * f) for f in SOUGHT} | set(ends[v.key])) for v in keys}
        try:
            self.ask([(v.key, value) for v in keys for value in (v.bounded(v.base), *ends[v.key])])
            self.ask([(key, value) for key, values in tried.items() for value in values])
        except OutOfTime:
            self.stopped = True
        turns = {v.key: [self._bracket(v, tried[v.key], s) for s in range(len(STRATEGIES))] for v in keys}
        for _ in range(HALVINGS):
            open_ones = [(key, s, pair) for key, there in turns.items() for s, pair in enumerate(there) if pair is not None]
            try:
                self.ask([(key, 0.5 * (a + b)) for key, _, (a, b) in open_ones])
            except OutOfTime:
                self.stopped = True
            if self.stopped:  # the bracket is as wide as the last round left it
                break
            for key, s, (a, b) in open_ones:
                middle = 0.5 * (a + b)
                same = (self.known[key, a][s] < 1.0) == (self.known[key, middle][s] < 1.0)
                turns[key][s] = (middle, b) if same else (a, middle)
        return [
            Moved(
                v,
                *ends[v.key],
                self._row(v.key, v.bounded(v.base)),
                self._row(v.key, ends[v.key][0]),
                self._row(v.key, ends[v.key][1]),
                [None if pair is None else 0.5 * (pair[0] + pair[1]) for pair in turns[v.key]],
                [(value, self._row(v.key, value)) for value in tried[v.key]],
            )
            for v in keys
            if (v.key, v.bounded(v.base)) in self.known
        ]

    def _row(self, key: str, value: float) -> list[float | None]:
        return [None if np.isnan(m) else float(m) for m in self.known.get((key, value), UNKNOWN)]

    def _bracket(self, v: Varied, values: list[float], s: int) -> tuple[float, float] | None:
        """The pair of neighbours, nearest to the value as it is, between which the margin of a strategy passes 1."""
        pairs = [
            (a, b)
            for a, b in itertools.pairwise(x for x in values if (v.key, x) in self.known)
            if np.isfinite([self.known[v.key, a][s], self.known[v.key, b][s]]).all()
            and (self.known[v.key, a][s] < 1.0) != (self.known[v.key, b][s] < 1.0)
        ]
        return min(pairs, key=lambda p: abs(0.5 * (p[0] + p[1]) - v.base), default=None)
