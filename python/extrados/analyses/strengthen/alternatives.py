"""The interventions of a deck, each as places of a tie or values of a key; those taken where the deck names none."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados import kinds
from extrados.analyses.assess.sensitivity import THICKNESS, varied
from extrados.analyses.changes import changed
from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.asked import number_of, unit_at
from extrados.analyses.limit.tables import AppliedLoad
from extrados.analyses.strengthen.tables import Anchorage, Change, Strengthen
from extrados.model.errors import BadGeometry, Key, NoView
from extrados.model.geometry.assembly import Assembly
from extrados.model.ties import Tie
from extrados.views.building import Building

#: Shares of the height at which ties are tried where the deck names none, and how far behind a wall they end, in heights
HEIGHTS, BEHIND = (0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.98), 0.5
#: The same of hoops, whose number is less as a programme of cones takes longer
HOOPS = (0.1, 0.2, 0.3, 0.45, 0.6, 0.8)
#: Greatest size tried of a key that the deck does not name, over its value
GREATEST = 3.0
#: Modulus of elasticity of a steel bar, and its yield strength where the deck gives none [Pa]: defaults of this program
YOUNG, STEEL = 210e9, 235e6
#: Of the size of the assembly: gaps between stones that no tie spans; how far within a stone a tie ends
GAP, INSIDE = 0.02, 1e-3


@dataclass(frozen=True)
class TieAlternative:
    """A tie whose yield force is sought, at any of the places; lengths [m]; most: the greatest force [N];
    debonds_by: source of the debonding force of a bonded strip, which `most` is."""

    name: str
    places: list[Tie]
    lengths: list[float]
    most: float
    anchorage: Anchorage | None
    beam_weight: float = 0.0
    debonds_by: str = ""

    def loads(self, place: int) -> list[AppliedLoad]:
        """The weight of a ring beam on the blocks at its ends."""
        tie = self.places[place]
        ends = [tie.start] if tie.end is None else [tie.start, tie.end]
        half = 0.5 * self.beam_weight
        return [AppliedLoad(x=x, y=y, force=half, sways=True) for x, y in ends] if half else []

    def having(self, building: Building, place: int, force: float | None) -> Building:
        """The building with the tie; force: None never yields, 0 leaves it out."""
        if force == 0.0:
            return building
        return building.having(ties=(*building.ties, self.places[place].model_copy(update={"yield_force": force})))

    def data(self, data: dict[str, Any], place: int, force: float) -> dict[str, Any]:
        """The deck with the tie, as elastic as runs need it."""
        if force == 0.0:
            return data
        tie = self.places[place].model_copy(update={"yield_force": force, "stiffness": self.stiffness(place, force)})
        table = {k: v for k, v in tie.model_dump(exclude_unset=True).items() if v is not None}
        return {**data, "ties": [*data.get("ties", []), table]}

    def stiffness(self, place: int, force: float) -> float:
        """EA/L [N/m]: that of the deck, else of a steel bar whose section is no larger than the force needs."""
        tie = self.places[place]
        if tie.stiffness is not None:
            return tie.stiffness
        strength = STEEL if self.anchorage is None else self.anchorage.steel_strength or STEEL
        return YOUNG * force / strength / self.lengths[place]


@dataclass(frozen=True)
class ChangeAlternative:
    """A key of the deck whose least change is sought, from `start` to `stop` in its unit."""

    name: str
    key: str
    unit: str
    start: float
    stop: float
    count: int
    whole: bool

    def data(self, data: dict[str, Any], value: float) -> dict[str, Any]:
        """The deck, or a table of options below "options", with another value."""
        return changed(data, self.key, round(value) if self.whole else float(value))


def tie_alternatives(building: Building, options: Strengthen) -> list[TieAlternative]:
    """The ties of the table; without ties and changes horizontal ones at several heights."""
    if not options.ties and not options.changes:
        return usual_ties(building)
    found = []
    for k, option in enumerate(options.ties):
        word = "bonded strip" if option.debonding_force is not None else "ring beam" if option.beam_weight else word_of(option)
        name = option.name or f"{word} {k + 1}"
        count = option.places if option.start_to is not None or option.far_to is not None else 1
        shares = np.linspace(0.0, 1.0, count).tolist()
        places = [option.at(share).model_copy(update={"name": f"{name} (strengthening)"}) for share in shares]
        placed: list[Tie] = []
        lengths: list[float] = []
        trouble: BadGeometry | None = None
        for tie in places:
            try:
                lengths.append(length_of(building, tie))
                placed.append(tie)
            except BadGeometry as error:  # an end between two stones of a range is passed over
                trouble = error
        if not placed and trouble is not None:
            raise Refused(str(trouble), ("analysis", "ties", k))
        found.append(
            TieAlternative(name, placed, lengths, option.greatest, option.anchorage, option.beam_weight or 0.0, option.source or "")
        )
    return found


def is_spatial(building: Building) -> bool:
    """Whether limit analysis takes the building as blocks in space, since it has no plane section."""
    if building.structure is None:
        return False
    try:
        building.blocks()
    except NoView:
        return True
    return False


def length_of(building: Building, tie: Tie) -> float:
    """Length of a tie, chain or hoop [m]; BadGeometry where its ends are in no block."""
    tied = building.having(ties=(tie,))
    if is_spatial(building):
        return float(sum(np.linalg.norm(s.point[k] - s.point[n]) for s in tied.strands() for k, n in s.segments))
    tied.anchored()
    return float(np.hypot(tie.far[0] - tie.start[0], tie.far[1] - tie.start[1]))


def usual_hoops(building: Building) -> list[TieAlternative]:
    """A hoop around blocks in space at one of several heights."""
    z = np.concatenate([part.vertices[:, 2] for part in building.solids().parts])
    low, high = float(z.min()), float(z.max())
    hoops = [
        Tie.model_validate({"name": "hoop (strengthening)", "start": [0.0, 0.0, low + share * (high - low)], "hoop": True})
        for share in HOOPS
    ]
    placed = [tie for tie in hoops if _holds(building, tie)]
    lengths = [length_of(building, tie) for tie in placed]
    return [TieAlternative("hoop", placed, lengths, np.inf, None)] if placed else []


def word_of(tie: Tie) -> str:
    """What a tie is called by its course and the senses in which it works."""
    if tie.hoop or tie.via:
        return "hoop" if tie.hoop else "chain"
    return {"tension": "tie", "compression": "strut", "both": "spring"}[tie.works_in]


def usual_ties(building: Building) -> list[TieAlternative]:
    """A horizontal tie across a hollow section, or an anchor of a wall to what stands behind it, at one of several heights."""
    if is_spatial(building):
        return usual_hoops(building)
    stones = building.blocks()
    points = np.concatenate(stones.outlines)
    low, high = points[:, 1].min(), points[:, 1].max()
    spans, anchors = [], []
    for share in HEIGHTS:
        y = float(low + share * (high - low))
        parts = _parts_at(stones, y)
        if len(parts) > 1:
            tie = _tie((parts[0][1], y), (parts[-1][0], y), "end", "tension", stones)
            spans.append(tie)
        elif parts:
            left = building.supports.abutting_wall != "right"
            x, away = (parts[0][0], -1.0) if left else (parts[0][1], 1.0)
            anchors.append(_tie((x, y), (x + away * BEHIND * float(high - low), y), "ground", "both", stones))
    found = []
    for name, ties in (
        ("horizontal tie", spans),
        ("anchor to an existing structure behind, in tension and compression", [] if spans else anchors),
    ):
        placed = [tie for tie in ties if _holds(building, tie)]
        if placed:
            lengths = [length_of(building, tie) for tie in placed]
            found.append(TieAlternative(name, placed, lengths, np.inf, None))
    return found


def _tie(start: tuple[float, float], far: tuple[float, float], end: str, works_in: str, stones: Assembly) -> Tie:
    """A horizontal tie from within a stone."""
    inside = INSIDE * stones.size
    (x, y), (x_far, _) = start, far
    towards = 1.0 if x_far > x else -1.0
    x -= towards * inside
    x_far += towards * inside if end == "end" else 0.0
    return Tie.model_validate({"name": "tie (strengthening)", "start": [x, y], end: [x_far, y], "works_in": works_in})


def _holds(building: Building, tie: Tie) -> bool:
    try:
        length_of(building, tie)
    except BadGeometry:
        return False
    return True


def _parts_at(stones: Assembly, y: float) -> list[tuple[float, float]]:
    """Where stone is along a horizontal line, in intervals of x [m]; narrow gaps count as stone."""
    found = []
    for outline in stones.outlines:
        one, two = outline, np.roll(outline, -1, axis=0)
        crosses = (one[:, 1] - y) * (two[:, 1] - y) < 0.0
        if crosses.any():
            a, b = one[crosses], two[crosses]
            x = a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
            found.append((float(x.min()), float(x.max())))
    parts: list[tuple[float, float]] = []
    for low, high in sorted(found):
        if parts and low - parts[-1][1] < GAP * stones.size:
            parts[-1] = (parts[-1][0], max(parts[-1][1], high))
        else:
            parts.append((low, high))
    return parts


def change_alternatives(context: Context, options: Strengthen) -> list[ChangeAlternative]:
    """The changes of the table; without ties and changes the sizes that make the kind of structure thick."""
    building = context.building
    if options.ties or options.changes:
        return [_change(context, options, k, one) for k, one in enumerate(options.changes)]
    structure = building.structure
    if structure is None:
        return []
    found = []
    for what in varied(building, dict.fromkeys(THICKNESS.get(structure.kind, ("structure.thickness",)), 0.1), None):
        name = what.key.rpartition(".")[2].replace("_", " ")
        found.append(ChangeAlternative(f"greater {name}", what.key, what.unit, what.base, GREATEST * what.base, 9, False))
    return found


def _change(context: Context, options: Strengthen, k: int, one: Change) -> ChangeAlternative:
    """Refused where the deck has no such number."""
    at: Key = ("analysis", "changes", k)
    name = one.name or one.vary
    if one.vary.startswith("options."):
        way = one.vary.removeprefix("options.")
        base, unit = _option(options.options, way), unit_at(kinds.load(kinds.ANALYSES[options.by].table), way)
        if base is None and one.start is None:
            raise Refused(
                f"{one.vary}: this key of the options has no plain number as its value. Give a number in SI units, or give the key `start`",
                (*at, "vary"),
            )
        start = base if one.start is None else number_of(one.start, unit, (*at, "start"))
        return ChangeAlternative(name, one.vary, unit, float(start or 0.0), number_of(one.stop, unit, (*at, "stop")), one.count, False)
    there = varied(context.building, {one.vary: 0.1}, None)
    if not there and one.start is None:
        raise Refused(
            f"{one.vary}: the building has no value above 0 for this key, from which the sizes could start: give the key `start`",
            (*at, "vary"),
        )
    unit = there[0].unit if there else ""
    start = there[0].base if one.start is None else number_of(one.start, unit, (*at, "start"))
    stop = number_of(one.stop, unit, (*at, "stop"))
    if start == stop:
        raise Refused(f"{one.vary}: start and stop have the same value, {start:g}", (*at, "stop"))
    return ChangeAlternative(name, one.vary, unit, start, stop, one.count, bool(there) and there[0].whole)


def _option(table: Any, way: str) -> float | None:
    """The number at a dotted key of the options."""
    for part in way.split("."):
        if isinstance(table, list):
            table = table[int(part)] if part.isdecimal() and int(part) < len(table) else None
        else:
            table = table.get(part) if isinstance(table, dict) else None
    return float(table) if isinstance(table, int | float) and not isinstance(table, bool) else None
