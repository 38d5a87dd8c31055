"""sweep: the capacity as one key of the structure varies; changes of mechanism, optimum, stable range."""

import itertools
import json
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from extrados.analyses.batches import stacked, sweep
from extrados.analyses.changes import changed, read_table
from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.asked import values_of
from extrados.analyses.limit.common import packed
from extrados.analyses.limit.outcome import LOCKED, UNKNOWN, Outcome, Signature, outcomes_of
from extrados.analyses.limit.tables import Sweep
from extrados.analyses.limit.variation import evaluate, spoken
from extrados.analyses.needs import in_space
from extrados.core.calls import stop_if_asked
from extrados.limit.errors import CannotStand
from extrados.limit.finite_motion import finite_motion
from extrados.limit.programme import Mechanism
from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.results import sweeps as out
from extrados.results.limit import DILATANT
from extrados.results.model import Array, Result, TableData
from extrados.views.building import Building

#: Of the greatest capacity: by so little capacities differ that are the same but for rounding
LEVEL = 1e-6
# Of the range: how closely changes of mechanism and the optimum are found.
CLOSE = 1e-7
PROVEN = (1e2, 1e4)  # times as far from a limit of collapse under self-weight its certificate is sought
MOST_CHANGES = 40
MOST_PICTURED = 4  # mechanisms of solids that are stored
GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


@dataclass(frozen=True)
class Range:
    """The question of a sweep, put at any value of the key: a key of `table`, whose data stand in the deck; of ties, tables
    by their numbers."""

    building: Building
    table: str
    path: str
    data: dict[str, Any] | list[dict[str, Any]]
    options: Sweep
    whole: bool

    def at(self, value: float, *, beside: bool = False, explain: bool = False) -> Outcome:
        """The outcome at a value of the key, in SI; beside: also what stands beside the capacity; explain: with the
        reason of a refusal."""
        if self.table == "analysis":  # the direction of the load
            return evaluate(self.building, self.options.model_copy(update={self.path: float(value)}))
        data = changed(self.data, self.path, round(value) if self.whole else float(value))
        try:
            own = getattr(self.building, self.table)
            if isinstance(own, tuple):
                table = tuple(read_table(type(was), one).model_copy(update={"name": was.name}) for was, one in zip(own, data, strict=True))
            else:
                table = read_table(type(own), data)
        except BadGeometry as error:
            return Outcome(signature=UNKNOWN, reason=str(error))
        return evaluate(
            self.building.apart().having(**{self.table: table}),
            self.options,
            fracture=beside and self.options.fracture,
            alone=beside and self.options.buttress_alone,
            explain=explain,
        )


@dataclass(frozen=True)
class Values:
    """Member k is the question put at values[k]."""

    ask: Range
    values: np.ndarray

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        return stacked(lambda k: self.ask.at(self.values[k], beside=True, explain=True).row(), first, count)


def run(context: Context, options: Sweep) -> Result:
    """All values in order, then the places between them where something changes."""
    table, path, unit, whole, values = values_of(context.building, options)
    spatial = in_space(context.building, options)
    locate = not whole and (options.locate if options.locate is not None else not spatial)
    data = context.deck.data.get(table, {})
    if isinstance(data, dict):
        data = {**data, **(options.model_dump(exclude_none=True).get(table) or {})}
    ask = Range(context.building, table, path, data, options, whole)
    swept = sweep(context, "sweep", Values(ask, values), len(values), f"sweep of {options.vary}", slow=True)
    outcomes = outcomes_of(swept.whole())
    if not any(o.gamma for o in outcomes):
        if all(o.status == "cannot-stand" for o in outcomes):
            raise CannotStand(f"the structure cannot stand at any value of {options.vary}. Reason at the last value: {outcomes[-1].reason}")
        raise Refused(f"the structure has no capacity at any value of {options.vary}. Reason: {outcomes[-1].reason}", ("analysis", "vary"))
    changes = _changes(context, ask, values, outcomes) if locate else []
    numbers: dict[Signature, int] = {}
    for _, signature in sorted(
        [(v, o.signature) for v, o in zip(values, outcomes, strict=True)] + [(c["value"], c["after"]) for c in changes],
        key=lambda pair: pair[0],
    ):
        if signature and signature not in (LOCKED, UNKNOWN):
            numbers.setdefault(signature, len(numbers) + 1)
    best, best_gamma = _optimum(context, ask, values, outcomes, locate)
    result = Result("sweep")
    stable = [c for c in changes if () in (both := (c["before"], c["after"])) and UNKNOWN not in both]
    locks = [c["value"] for c in changes if LOCKED in (c["before"], c["after"])]
    r = out.Sweep(
        vary=options.vary,
        unit=unit,
        mechanisms=[out.GoverningMechanism(number=n, hinges=spoken(s)) for s, n in numbers.items()],
        changes=[
            out.Change(
                value=c["value"],
                before=_beside(c["before"], numbers),
                after=_beside(c["after"], numbers),
                collapse_acceleration_g=c["gamma"],
            )
            for c in changes
        ],
        stable_limits=[c["value"] for c in stable],
        locked_limits=locks,
        optimum_value=best,
        optimum_collapse_acceleration_g=best_gamma,
        optimum_tilt_angle_deg=float(np.degrees(np.arctan(best_gamma))),
        optimum_inside=bool(values[0] < best < values[-1]),
        values=values.tolist(),
        collapse_accelerations_g=[o.gamma for o in outcomes],
        upper_bound_values=[v for v, o in zip(values.tolist(), outcomes, strict=True) if o.dilating],
        gaps=[out.Gap(value=v, status=o.status, reason=o.reason) for v, o in zip(values, outcomes, strict=True) if o.status != "ok"],
        duality_gap=max(o.gap for o in outcomes),
        **({"fractured_collapse_accelerations_g": [o.fractured for o in outcomes]} if options.fracture else {}),
        **({"buttress_alone_accelerations_g": [o.alone for o in outcomes]} if options.buttress_alone else {}),
    )
    result.results = r
    _store(options, r, values, outcomes, numbers, result)
    result.arrays.update((_solid_examples if spatial else _examples)(ask, values, outcomes, numbers))
    result.warnings = list(dict.fromkeys(note for o in outcomes for note in o.notes))[:5]
    result.answer = _words(options, r, locate or whole)
    return result


def _beside(signature: Signature, numbers: dict[Signature, int]) -> out.Beside:
    """What a change tells of one of its sides."""
    return "locked" if signature == LOCKED else "unknown" if signature == UNKNOWN else numbers.get(signature, 0)


def _store(
    options: Sweep, r: out.Sweep, values: np.ndarray, outcomes: list[Outcome], numbers: dict[Signature, int], result: Result
) -> None:
    """Arrays and table of the swept values; numbers: of the mechanisms."""
    gamma, fractured, alone = (
        np.array([np.nan if (value := getattr(o, name)) is None else value for o in outcomes]) for name in ("gamma", "fractured", "alone")
    )
    number = np.array([numbers.get(o.signature, 0) for o in outcomes])
    columns: dict[str, Any] = {
        options.vary: values,
        "collapse_acceleration": gamma,
        "tilt_angle": np.degrees(np.arctan(gamma)),
        "mechanism": number,
    }
    result.arrays = {
        "value": Array(values, ("value",), "", f"values of {options.vary}"),
        "gamma": Array(
            gamma, ("value",), "g", "collapse acceleration towards +x; 0 for a structure that cannot stand, NaN without a result"
        ),
        "mechanism": Array(number, ("value",), "", "number of the mechanism; 0 if the structure cannot stand, is locked or has no result"),
        "change": Array(
            np.array([c.value for c in r.changes]),
            ("change",),
            "",
            "values of the key in `vary` at which the mechanism changes, or at which a mechanism begins or ceases to exist",
        ),
    }
    if options.fracture:
        result.arrays["fractured"] = Array(fractured, ("value",), "g", "with the leeward buttress cracked")
        columns["fractured_collapse_acceleration"] = fractured
    if options.buttress_alone:
        result.arrays["buttress_alone"] = Array(alone, ("value",), "g", "the leeward buttress by itself")
        columns["buttress_alone_acceleration"] = alone
    for name in next((o.measures for o in outcomes if o.measures), {}):
        columns[name] = [o.measures.get(name, np.nan) for o in outcomes]
    columns["status"] = [o.status for o in outcomes]
    columns["upper_bound"] = ["dilatant friction" if o.dilating else "" for o in outcomes]
    columns["reason"] = [o.reason for o in outcomes]
    units = {
        options.vary: r.unit,
        "collapse_acceleration": "g",
        "fractured_collapse_acceleration": "g",
        "buttress_alone_acceleration": "g",
        "tilt_angle": "deg",
    }
    result.tables = {"sweep": TableData(columns, units)}


@dataclass(frozen=True)
class End:
    """What a neighbour of a change gave: value, mechanism and capacity [g]."""

    value: float
    signature: Signature
    gamma: float | None


@dataclass(frozen=True)
class Between:
    """Member k: every value between gaps[k] at which the mechanism becomes another, found by bisection."""

    ask: Range
    gaps: list[tuple[End, End]]
    close: float

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        return stacked(lambda k: {"changes": np.array(json.dumps(self._changes(*self.gaps[k])))}, first, count)

    def _changes(self, low: End, high: End) -> list[dict[str, Any]]:
        found: list[dict[str, Any]] = []
        for _ in range(MOST_CHANGES):
            if low.signature == high.signature:
                break
            before, after = low, high
            while after.value - before.value > self.close:
                middle = self._at(0.5 * (before.value + after.value))
                if middle.signature == before.signature:
                    before = middle
                else:
                    after = middle
            sides = self._certified(before, low.value), self._certified(after, high.value)
            low, (before, after) = after, sides
            if before.signature != after.signature:
                gamma = before.gamma if before.signature not in ((), UNKNOWN) else after.gamma
                found.append({"value": after.value, "before": before.signature, "after": after.signature, "gamma": gamma})
        return found

    def _at(self, value: float, explain: bool = False) -> End:
        stop_if_asked()
        found = self.ask.at(value, explain=explain)
        return End(value, found.signature, found.gamma)

    def _certified(self, end: End, away: float) -> End:
        """An end that the bisection took for collapse under self-weight, unknown without a certificate towards the value `away`: at
        the end itself the weights do no more work than rounding does."""
        if end.signature != () or end.gamma is not None:
            return end
        for beyond in PROVEN:
            step = min(beyond * self.close, abs(away - end.value))
            if self._at(end.value + float(np.copysign(step, away - end.value)), True).signature == ():
                return end
        return End(end.value, UNKNOWN, None)


def _changes(context: Context, ask: Range, values: np.ndarray, outcomes: list[Outcome]) -> list[dict[str, Any]]:
    """The first MOST_CHANGES values at which the mechanism becomes another."""
    ends = [End(float(v), o.signature, o.gamma) for v, o in zip(values, outcomes, strict=True)]
    gaps = [(one, two) for one, two in itertools.pairwise(ends) if one.signature != two.signature][:MOST_CHANGES]
    if not gaps:
        return []
    job = Between(ask, gaps, CLOSE * float(values[-1] - values[0]))
    swept = sweep(context, "sweep-changes", job, len(gaps), "changes of mechanism", slow=True).whole()
    found = [change for text in swept["changes"] for change in json.loads(str(text))]
    for change in found:
        for key in ("before", "after"):
            change[key] = tuple((name, marks) for name, marks in change[key])
    return found[:MOST_CHANGES]


@dataclass(frozen=True)
class Best:
    """Its one member: the value of greatest capacity between low and high by golden section, and the capacity [g]."""

    ask: Range
    low: float
    high: float
    close: float

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        low, high = self.low, self.high
        one, two = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        at_one, at_two = self._capacity(one), self._capacity(two)
        while high - low > self.close:
            if at_one >= at_two:
                high, two, at_two = two, one, at_one
                one = high - GOLDEN * (high - low)
                at_one = self._capacity(one)
            else:
                low, one, at_one = one, two, at_two
                two = low + GOLDEN * (high - low)
                at_two = self._capacity(two)
        gamma, value = max((at_one, one), (at_two, two))
        return {"value": np.array([value]), "gamma": np.array([gamma])}

    def _capacity(self, value: float) -> float:
        stop_if_asked()
        found = self.ask.at(value).gamma
        return -np.inf if found is None else found


def _optimum(context: Context, ask: Range, values: np.ndarray, outcomes: list[Outcome], closely: bool) -> tuple[float, float]:
    """The value of greatest capacity, searched between the neighbours of the best one, and the capacity [g]."""
    gamma = np.array([-np.inf if o.gamma is None else o.gamma for o in outcomes])
    k = int(gamma.argmax())
    if not closely:
        return float(values[k]), float(gamma[k])
    low, high = float(values[max(k - 1, 0)]), float(values[min(k + 1, len(values) - 1)])
    job = Best(ask, low, high, CLOSE * float(values[-1] - values[0]))
    found = sweep(context, "sweep-optimum", job, 1, "optimum", slow=True).whole()
    best = max((float(gamma[k]), float(values[k])), (float(found["gamma"][0]), float(found["value"][0])))
    return best[1], best[0]


def _examples(ask: Range, values: np.ndarray, outcomes: list[Outcome], numbers: dict[Signature, int]) -> dict[str, Array]:
    """One section of each mechanism, in the middle of where it governs, with its mechanism carried on."""
    outlines: dict[str, np.ndarray] = {}
    moved: dict[str, np.ndarray] = {}
    blocks: dict[int, int] = {}
    for signature, number in numbers.items():
        same = [v for v, o in zip(values, outcomes, strict=True) if o.signature == signature]
        if not same:
            continue
        one = ask.at(same[len(same) // 2])
        assert isinstance(one.assembly, Assembly) and isinstance(one.mechanism, Mechanism)  # sections of one mechanism have one
        pose = finite_motion(one.assembly, one.mechanism)
        blocks[number] = len(pose)
        for i, (outline, c, p) in enumerate(zip(one.assembly.outlines, one.assembly.centroid, pose, strict=True)):
            cos, sin = np.cos(p[2]), np.sin(p[2])
            outlines[f"{number}/{i}"] = outline
            moved[f"{number}/{i}"] = (outline - c) @ np.array([[cos, sin], [-sin, cos]]) + p[:2]
    of = [number for number, count in blocks.items() for _ in range(count)]
    return {
        "example_mechanism": Array(
            np.array(of, dtype=int), ("example_path",), "", "number of the mechanism to which each block outline of `example` belongs"
        ),
        **packed(
            "example",
            outlines,
            "m",
            "block outlines of one structure for each mechanism; the name of a path is mechanism number / block number",
        ),
        **packed("example_moved", moved, "m", "outlines of `example`, moved by the mechanism"),
    }


def _solid_examples(ask: Range, values: np.ndarray, outcomes: list[Outcome], numbers: dict[Signature, int]) -> dict[str, Array]:
    """The same of solids, of the first mechanisms: solids and poses by the numbers of the mechanisms."""
    from extrados.analyses.limit.solids import pose_of, scene_arrays  # with a solver that takes a while to load

    found: dict[str, Array] = {}
    shown = []
    for signature, number in list(numbers.items())[:MOST_PICTURED]:
        same = [v for v, o in zip(values, outcomes, strict=True) if o.signature == signature]
        if not same:
            continue
        one = ask.at(same[len(same) // 2])
        assert isinstance(one.assembly, SolidAssembly) and one.mechanism is not None and not isinstance(one.mechanism, Mechanism)
        shown.append(number)
        found |= {
            f"{name}_{number}": replace(array, dims=(f"{array.dims[0]}_{number}", *array.dims[1:]))
            for name, array in scene_arrays(one.assembly).items()
            if name.startswith("solid_")
        }
        pose = pose_of(one.assembly, one.mechanism.motion)
        found[f"solid_pose_{number}"] = Array(
            pose, (f"block_{number}", "pose"), "m, m, m, rad, rad, rad", "mechanism at a finite displacement"
        )
    return found | {"example_mechanism": Array(np.array(shown, dtype=int), ("example",), "", "numbers of the mechanisms that are drawn")}


def _words(options: Sweep, r: out.Sweep, located: bool) -> str:
    unit = f" {r.unit}" if r.unit else ""
    best, most = f"{r.optimum_value:.4g}{unit}", r.optimum_collapse_acceleration_g
    level = [v for v, g in zip(r.values, r.collapse_accelerations_g, strict=True) if g is not None and abs(g - most) <= LEVEL * abs(most)]
    if r.locked_limits:
        where = f"near locking, at {best}"
    elif len(level) == len(r.values):
        where = "the same for all values"
    elif len(level) > 1:
        where = f"at values from {level[0]:.4g} to {level[-1]:.4g}{unit}"
    else:
        where = f"at the optimum {best}" if r.optimum_inside else f"at the end of the range, {best}"
    text = (
        f"{options.vary} from {r.values[0]:.4g} to {r.values[-1]:.4g}{unit}: the greatest collapse acceleration is {most:.4f} g "
        f"({r.optimum_tilt_angle_deg:.2f} degrees), {where}. {len(r.mechanisms)} mechanism{'s' if len(r.mechanisms) != 1 else ''}"
    )
    moves = [f"{c.before} to {c.after} at {c.value:.4g}" for c in r.changes if {c.before, c.after}.isdisjoint({0, "unknown"})]
    locked = ", ".join(f"{v:.4g}" for v in r.locked_limits)
    text += f"; changes {', '.join(moves[:8])}." if moves else "."
    if not located:
        text += " The values at which the mechanism changes are not located precisely: `locate = true` locates them."
    if locked:
        text += f" At {locked} the structure locks: beyond this value a load of this kind never causes collapse."
    if r.stable_limits:
        text += f" Collapse under self-weight begins or ends at {', '.join(f'{v:.4g}' for v in r.stable_limits)}."
    counts = {status: sum(gap.status == status for gap in r.gaps) for status in ("cannot-stand", "no-answer")}
    if counts["cannot-stand"]:
        text += f" At {counts['cannot-stand']} of {len(r.values)} values the structure cannot stand (capacity 0)."
    if counts["no-answer"]:
        text += f" {counts['no-answer']} of {len(r.values)} values have no result."
    if r.upper_bound_values:
        text += f" For {len(r.upper_bound_values)} of the {len(r.values)} values, joints slide; the capacity is then an {DILATANT}."
    return text
