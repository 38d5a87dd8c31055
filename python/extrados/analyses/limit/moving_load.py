"""moving-load: the collapse load, or adequacy factor of a train, at every place along a vault or a bridge."""

import itertools
from dataclasses import dataclass, replace
from typing import NoReturn

import numpy as np

from extrados.analyses.batches import stacked, sweep
from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.applied import block_under, chain_of
from extrados.analyses.limit.common import (
    answer_of,
    geometry_arrays,
    limit_of,
    line_arrays,
    load_arrays,
    loads_of,
    push_arrays,
    spoken_ties,
    tie_arrays,
    tie_rows,
    zone_arrays,
)
from extrados.analyses.limit.tables import MovingLoad, PartialFactors, Serviceability
from extrados.analyses.limit.trains import Train, fitting_train, train_of, unverified
from extrados.analyses.limit.variation import signature, spoken
from extrados.limit.answer import cannot_stand
from extrados.limit.errors import CannotStand, Immovable, NoAnswer
from extrados.limit.fill import pressed, under_load
from extrados.limit.finite_motion import finite_motion
from extrados.limit.lines import thrust_paths
from extrados.limit.loads import Loads, forces_at
from extrados.limit.programme import LimitAnalysis, Mechanism, State
from extrados.model.dimensions import with_article
from extrados.model.errors import WHOLE
from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.chains import is_stack
from extrados.model.geometry.earth import skyline
from extrados.results import limit as out
from extrados.results.fields import Keys
from extrados.results.model import Array, Result, TableData
from extrados.schema.constants import GRAVITY
from extrados.schema.quantities import three_figures
from extrados.views.building import Building

#: Times that the intervals beside the least factors are halved, and factors over the least beside which they are
HALVINGS, NEARLY = 4, 1.05
PATTERNS = 500  # patterns of even loads that are tried at a place
#: What makes the model of a bridge whole
MODEL = (
    "A ring alone does not represent a bridge. Add fill to the structure, and backing: give both as "
    'blocks, or use a structure of kind "bridge".'
)
MOST_PLACES = 20_000  # of a train
NIL = 1e-6  # of the greatest load on the way: places with less are left away
FINE = 0.02  # of the way: pieces of the top on which even loads stand or do not


@dataclass(frozen=True)
class Collapse:
    """State and mechanism of collapse under `loads`, the multiple of the train that it takes, and the load then on it [N]."""

    state: State
    loads: Loads
    mechanism: Mechanism
    factor: float
    load: float
    standing: np.ndarray  # pieces of the top on which the even loads stand


@dataclass(frozen=True)
class Places:
    """Member k is the train with its first axle at places[k] [m], heading to +x where ways[k] is 1, to -x where -1.

    Its loads stand on the `span` [m]; axles of a train on earth press over `contact` [m] and spread. Where its loads
    are not known it is as heavy as the structure. `adverse`: even loads stand where they press the mechanism on.
    """

    assembly: Assembly
    friction: float | np.ndarray | None
    strength: float | None
    associated: bool
    dead: Loads
    places: np.ndarray
    ways: np.ndarray
    train: Train
    span: tuple[float, float]
    contact: float
    adverse: bool
    pieces: tuple[np.ndarray, np.ndarray, np.ndarray]

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        return stacked(self._member, first, count)

    def collapse(self, k: int) -> Collapse | None:
        """Collapse under the train; None where it brings nothing down.

        Even loads only on adverse lengths, and the mechanism that they belong to, are found in turn until a pattern repeats, or
        PATTERNS are tried; the least factor counts.
        """
        axles, (force, x, block) = self._axles(k), self._even(k)
        best: Collapse | None = None
        followed: set[bytes] = set()
        for start in self._starts(x, bool(axles.any())):
            standing = start
            while standing.tobytes() not in followed and len(followed) < PATTERNS:
                followed.add(standing.tobytes())
                found = self.under(axles + pressed(np.where(standing, force, 0.0), x, block, len(axles)), standing)
                if found is None:
                    break
                if best is None or found.factor < best.factor * (1.0 - 1e-9):
                    best = found
                if not self.adverse:
                    break
                v = found.mechanism.velocity[block]
                standing = v[:, 1] + v[:, 2] * (x - self.assembly.centroid[block, 0]) < 0.0
        return best

    def _starts(self, x: np.ndarray, axles: bool) -> list[np.ndarray]:
        """Which even loads at x [m] stand at first: all of them; where they may be left away also those on the parts of every arch, because
        loads on more of a thick arch may only compress it. Axles select a mechanism: none beside them, and halves, are enough."""
        every = np.ones(len(x), dtype=bool)
        if not self.adverse or not len(x):
            return [every]
        ends = (sorted(self.assembly.q[[joints[0], joints[-1]], 0].tolist()) for joints in self.assembly.chains.values())
        arches = [(low, high) for low, high in ends] or [self.span]
        cuts = [np.linspace(low, high, parts + 1) for low, high in arches for parts in ((2,) if axles else (4, 8))]
        within = [(low <= x) & (x <= high) for cut in cuts for low, high in itertools.pairwise(cut)]
        return [every, *([~every] if axles else []), *(one for one in within if one.any())]

    def under(self, live: np.ndarray, standing: np.ndarray) -> Collapse | None:
        """Collapse under given loads on the blocks, None where they bring nothing down."""
        total = -float(live[:, 1].sum())
        if total <= 0.0:
            return None
        scale = self.dead.scale / total
        loads = Loads(self.dead.dead, live * scale, self.dead.resistance)
        limit = LimitAnalysis(self.assembly, self.friction, strength=self.strength, associated=self.associated, loads=loads)
        try:
            state, mechanism = limit.collapse(1)
        except Immovable:
            return None
        return Collapse(state, loads, mechanism, state.gamma * scale, state.gamma * self.dead.scale, standing)

    def at(self, k: int) -> np.ndarray:
        """Where the axles stand [m]."""
        return self.places[k] - self.ways[k] * self.train.axles

    def _axles(self, k: int) -> np.ndarray:
        """The axles on the way as loads on the blocks (blocks, 3)."""
        (low, high), earth, count = self.span, self.assembly.earth, len(self.dead.dead)
        live = np.zeros((count, 3))
        for axle, force in zip(self.at(k), self.train.forces, strict=True):
            if not low <= axle <= high:
                continue
            if earth is not None:
                live += under_load(earth, count, float(axle), float(force), self.contact)
            else:
                block, y = block_under(self.assembly, float(axle))
                live += forces_at(count, block, np.array([axle, y]), (0.0, -float(force)))
        return live

    def _even(self, k: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Even loads on the pieces of the top: force [N], x [m], block."""
        x0, x1, block = self.pieces
        force = np.zeros(len(block))
        for start, stop, load in self.train.even:
            ends = self.places[k] - self.ways[k] * np.array([start, stop])
            force += load * np.maximum(np.minimum(x1, ends.max()) - np.maximum(x0, ends.min()), 0.0)
        laden = force > 0.0
        return force[laden], 0.5 * (x0 + x1)[laden], block[laden]

    def _member(self, k: int) -> dict[str, np.ndarray]:
        found = self.collapse(k)
        if found is None:
            nothing = np.full(self.assembly.p.shape, np.nan)
            return {
                "capacity": np.array(np.inf),
                "factor": np.array(np.inf),
                "mechanism": np.array(""),
                "gap": np.array(0.0),
                "line": nothing,
                "normal": nothing[:, 0],
            }
        state, mechanism = found.state, found.mechanism
        return {
            "capacity": np.array(found.factor if not self.train.known else found.load),
            "factor": np.array(found.factor),
            "mechanism": np.array(spoken(signature(self.assembly, mechanism))),
            "gap": np.array(abs(state.gamma - mechanism.upper_bound)),
            "line": state.points(self.assembly),
            "normal": state.normal,
        }


def _way(assembly: Assembly, chain: str | None) -> tuple[float, float]:
    """From where to where a load crosses [m]: the extrados of a chain, or the whole top where there is no arch."""
    if chain is not None and not is_stack(assembly, assembly.chains[chain]):
        ends = assembly.q[[assembly.chains[chain][k] for k in (0, -1)], 0]
        return float(ends.min()), float(ends.max())
    points = np.concatenate(assembly.outlines)[:, 0]
    return float(points.min()), float(points.max())


def _top(assembly: Assembly, low: float, high: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Short pieces of the tops of the stones between two places: x of both ends [m], block."""
    line = skyline(assembly.outlines)
    x0, x1, block = [], [], []
    for a, b, one in zip(line.start[:, 0], line.end[:, 0], line.block, strict=True):
        a, b = max(a, low), min(b, high)
        if b > a:
            cuts = np.linspace(a, b, max(1, int(np.ceil((b - a) / (FINE * (high - low))))) + 1)
            x0.append(cuts[:-1])
            x1.append(cuts[1:])
            block.append(np.full(len(cuts) - 1, one))
    return np.concatenate(x0), np.concatenate(x1), np.concatenate(block)


def factored(assembly: Assembly, loads: Loads, factors: PartialFactors) -> Loads:
    """The dead loads with the partial factors of stones, fill and surfacing; point loads of the deck are left alone."""
    resting = [(assembly.mass, assembly.centroid, factors.masonry)]
    if assembly.earth is not None:
        soil, paved = assembly.earth.masses(len(assembly.mass), assembly.depth)
        resting += [(soil[:, 0], soil[:, 1:], factors.fill), (paved[:, 0], paved[:, 1:], factors.surfacing)]
    elif assembly.fill is not None:
        resting.append((assembly.fill[:, 0], assembly.fill[:, 1:], factors.fill))
    extra = np.zeros_like(loads.dead)
    for mass, place, factor in resting:
        weight = (factor - 1.0) * GRAVITY * mass
        extra -= np.column_stack([np.zeros_like(weight), weight, place[:, 0] * weight])
    return replace(loads, dead=loads.dead + extra)


def job_of(building: Building, options: MovingLoad) -> tuple[Places, LimitAnalysis, Train, str | None]:
    """The places of the load, the structure with its partial factors, the train as the deck gives it, and the chain that it crosses."""
    factors = options.factors
    assembly, structure = building.blocks(), building.require_structure()
    whole = (structure.crossed == "top" or assembly.earth is not None) and options.chain is None
    chain = None if whole else chain_of(assembly, options.chain)
    if not limit_of(building, options).stands():
        answer_of(building, options)  # refuses, and says why it cannot stand
    low, high = _way(assembly, chain)
    train = fitting_train(building, options)
    dead = factored(assembly, loads_of(assembly, options, building), factors)
    friction, strength = building.friction(), building.material.compressive_strength
    friction = None if friction is None else friction / factors.friction
    strength = None if strength is None else strength / factors.strength
    reduced = _standing_factored(LimitAnalysis(assembly, friction, strength=strength, loads=dead))
    # The whole depth stands for the strip that carries the load: as much heavier is the load on all of it.
    strip = assembly.depth / (options.width or assembly.depth)
    design = factors.live * factors.dynamic * strip if train.known else 1.0
    places, ways = _places(options, train, low, high)
    job = Places(
        assembly,
        friction,
        strength,
        options.friction_rule == "associated",
        dead,
        places,
        ways,
        Train(train.name, train.axles, train.forces * design, train.even * (1.0, 1.0, design), train.known),
        (low, high),
        options.contact_length,
        options.adverse,
        _top(assembly, low, high),
    )
    return job, reduced, train, chain


def run(context: Context, options: MovingLoad) -> Result:
    """Collapse load over place; the most dangerous place with its thrust line, zone and mechanism."""
    building, factors, structure = context.building, options.factors, context.building.require_structure()
    job, reduced, train, chain = job_of(building, options)
    assembly, dead, friction, places, ways, (low, high) = job.assembly, job.dead, job.friction, job.places, job.ways, job.span
    strip = assembly.depth / (options.width or assembly.depth)
    found = sweep(context, "moving-load", job, len(places), "moving load", slow=True).whole()
    swept = {name: found[name] for name in ("capacity", "factor", "mechanism", "gap", "line", "normal")}
    even = job
    if options.places is None:
        job, swept = _refined(context, "moving-load", job, swept)
        places, ways = job.places, job.ways
    mechanisms, gap, factor = swept["mechanism"].tolist(), float(swept["gap"].max()), swept["factor"]
    capacity = swept["capacity"] / strip if train.known else swept["capacity"]
    if options.force is not None:  # all of it, also where an axle is not on the way yet
        capacity = factor * options.force * factors.live * factors.dynamic
    k = int(factor.argmin())
    if not np.isfinite(factor[k]):
        _refuse_unlimited(structure.word, job, train)
    worst = job.collapse(k)
    if worst is None:  # the sweep found it by the same steps
        raise NoAnswer(
            f"the load at {places[k]:.4g} m caused collapse in the calculation of all positions, but not in the repeated calculation"
        )
    state, mechanism = worst.state, worst.mechanism
    result = Result("moving-load")
    asked: Keys = {}
    live = factors.live * factors.dynamic
    if options.force is not None:
        asked |= {"load_N": options.force, "safety_factor": capacity[k] / options.force}
    if train.known:
        asked |= {"adequacy_factor": float(factor[k]), "train": train.name, "live_load_factor": live}
    if options.serviceability is not None:
        asked |= _permissible(context, options, options.serviceability, even, strip)
    if job.associated and friction is not None:
        asked["dilating_joints"] = reduced.dilating(mechanism)
    r = out.MovingLoad(
        chain=chain,
        collapse_load_N=float(capacity[k]),
        collapse_load_kN_per_m=float(capacity[k] / assembly.depth / 1e3),
        worst_place_m=float(places[k]),
        worst_place_over_span=float((places[k] - low) / (high - low)),
        worst_way="+x" if ways[k] > 0 else "-x",
        hinges=[out.NamedHinge(joint=j, side=side, name=assembly.joint_names[j]) for j, side in mechanism.hinges],
        sliding_joints=mechanism.sliding,
        places_without_limit=int(np.isinf(factor).sum()),
        greatest_compression_N=float(np.nanmax(state.normal)),
        **tie_rows(building, dead, state),
        duality_gap=gap,
        characteristic=factors == PartialFactors(),
        violated=_violated(train, assembly),
        **asked,
    )
    result.results = r
    result.warnings += [f"{one} {MODEL}" for one in r.violated]
    if source := unverified(options.train):
        result.warnings.append(f"The axles of {train.name} were not verified against the standard: compare them with {source}.")
    finite = np.where(np.isinf(capacity), np.nan, capacity)
    result.arrays = {
        **geometry_arrays(assembly),
        **push_arrays(assembly, state),
        **load_arrays(assembly, options.load),
        **tie_arrays(building, dead, {"collapse": state}),
        **zone_arrays(assembly, state, job.strength),
        **_worst_arrays(assembly, job, k, worst, replace(assembly, mass=factors.masonry * assembly.mass)),
        "capacity": Array(finite, ("place",), "N", "collapse load; NaN if no load causes collapse"),
        "envelope_point": Array(swept["line"], ("place", "joint", "axis"), "m", "thrust lines at collapse, for all positions of the load"),
        "envelope_normal": Array(swept["normal"], ("place", "joint"), "N", "compression at collapse, all places"),
    }
    adequacy = np.where(np.isinf(factor), np.nan, factor)
    if train.known:
        result.arrays["adequacy"] = Array(adequacy, ("place",), "", "multiple of the factored train that causes collapse, at each position")
    columns = {"place": places, **({"way": ways, "adequacy": adequacy} if train.known else {}), "collapse_load": finite}
    result.tables = {"moving_load": TableData({**columns, "mechanism": mechanisms}, {"place": "m", "collapse_load": "N"})}
    result.tables["moving_load_envelope"] = _envelope(assembly, swept["line"], swept["normal"])
    filled = structure.kind == "blocks" and assembly.earth is not None
    crossed = r.chain or ("bridge" if filled else structure.word)
    result.answer = _words(options, r, with_article(crossed), _where(job, k, worst, r), len(places))
    return result


def _standing_factored(reduced: LimitAnalysis) -> LimitAnalysis:
    """The structure with the partial factors; CannotStand if they exceed it."""
    if not reduced.stands():
        proof = cannot_stand(reduced)
        raise CannotStand(f"with the partial factors: {proof}", proof.motion)
    return reduced


def _worst_arrays(assembly: Assembly, job: Places, k: int, worst: Collapse, heavier: Assembly) -> dict[str, Array]:
    """Places of the load, and thrust line and mechanism at the worst place k; heavier: with the partial factor of the masonry."""
    state = worst.state
    chains = list(assembly.chains.values())
    return {
        "place": Array(job.places, ("place",), "m", "x of the first axle"),
        "way": Array(job.ways, ("place",), "", "direction of the train: 1 towards +x, -1 towards -x"),
        "axle": Array(job.at(k), ("axle",), "m", "axles at the worst place"),
        "even_load": Array(_standing(job, k, worst), ("stretch", "end"), "m", "uniform loads at the governing position"),
        "collapse_point": Array(state.points(assembly), ("joint", "axis"), "m", "thrust line at collapse, at the governing position"),
        **line_arrays("collapse", thrust_paths(heavier, worst.loads, state, sway=0.0), "at collapse, worst place"),
        "mechanism_pose": Array(
            finite_motion(assembly, worst.mechanism), ("block", "component"), "m, m, rad", "mechanism at a finite displacement"
        ),
        "chain_joint": Array(
            np.concatenate([np.array(j, dtype=int) for j in chains] or [np.empty(0, dtype=int)]),
            ("link",),
            "",
            "joints of each chain (arch or stack), one chain after the other",
        ),
        "chain_start": Array(
            np.cumsum([0, *map(len, chains)]),
            ("chain_edge",),
            "",
            "index of the first joint of each chain in `chain_joint`; the last value is the length of `chain_joint`",
        ),
    }


def _refuse_unlimited(word: str, job: Places, train: Train) -> NoReturn:
    """Say why no position limits the load: none has a load on the structure, or loads only compress it."""
    low, high = job.span
    if not any(train.within(low, high, place if way > 0 else low + high - place) for place, way in zip(job.places, job.ways, strict=True)):
        raise Refused(f"places: no load acts on the {word} at any of these positions", ("analysis", "places"))
    raise Refused(f"no load of this kind causes collapse of the {word}, because such loads only compress the joints", WHOLE)


def _permissible(context: Context, options: MovingLoad, service: Serviceability, job: Places, strip: float) -> dict[str, object]:
    """Of the permissible limit state: least factor over all places [-], its place [m] and the permissible stress [Pa].

    All partial factors are one; the dynamic factor, an effect of the motion, multiplies the train here too. Limit analysis with the permissible stress as strength gives the greatest multiple of the
    train under which a thrust line exists that no joint carries with more; 0 where none exists without the train.
    """
    building = context.building
    whole = building.material.compressive_strength
    if whole is None:
        raise Refused("serviceability: requires compressive_strength", ("material", "compressive_strength"))
    stress, assembly = service.strength_share * whole, job.assembly
    if assembly.earth is not None:
        passive = assembly.earth.passive * service.passive_share
        assembly = replace(assembly, earth=replace(assembly.earth, passive=passive))
    dead, friction = loads_of(assembly, options, building), building.friction()
    found: dict[str, object] = {"permissible_stress_Pa": stress}
    if not LimitAnalysis(assembly, friction, strength=stress, loads=dead).stands():
        return found | {"permissible_factor": 0.0, "permissible_place_m": float(job.places[0])}
    given, live = train_of(options, assembly.depth), service.live * options.factors.dynamic * strip
    train = replace(job.train, forces=given.forces * live, even=given.even * (1.0, 1.0, live))
    one = replace(job, assembly=assembly, friction=friction, strength=stress, dead=dead, train=train)
    swept = {"factor": sweep(context, "permissible", one, len(one.places), "permissible limit state", slow=True).whole()["factor"]}
    if options.places is None:
        one, swept = _refined(context, "permissible", one, swept)
    factor = swept["factor"]
    k = int(factor.argmin())
    return found | {"permissible_factor": float(factor[k]), "permissible_place_m": float(one.places[k])}


def _places(options: MovingLoad, train: Train, low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    """Places of the first axle [m] and which way it heads, 1 or -1: all those at which an axle, or an end of an even load, is on the way.

    Loads far apart cross one after the other. The places of each group are as close as `count` places on the way.
    """
    span, marks = high - low, train.marks
    if options.places is not None:
        ahead = back = np.array(options.places, dtype=float)
    elif not len(marks):  # loads without an end are the same everywhere
        ahead = back = np.array([low])
    else:
        ahead = np.concatenate(
            [
                _crossing(options.count, low + one[0], high + one[-1], span)
                for one in np.split(marks, np.flatnonzero(np.diff(marks) > span) + 1)
            ]
        )
        laden = np.array([train.within(low, high, place) for place in ahead])
        ahead = ahead[laden > NIL * laden.max()]
        back = low + high - ahead
    if len(ahead) > MOST_PLACES:
        raise Refused(
            f"the train has {len(ahead)} positions; at most {MOST_PLACES} are allowed: reduce `count`, or give `places`",
            ("analysis", "count"),
        )
    if not options.both_ways:
        return ahead, np.ones(len(ahead))
    return np.concatenate([ahead, back]), np.concatenate([np.ones(len(ahead)), -np.ones(len(back))])


def _crossing(count: int, first: float, last: float, span: float) -> np.ndarray:
    """Even places from first to last [m], at most span / (count - 1) apart, a hair inside, so that an axle at the ends is on a block."""
    places = np.linspace(first, last, int(np.ceil(1.0 + (count - 1) * (last - first) / span - NIL)))
    places[0], places[-1] = places[0] + 1e-9 * span, places[-1] - 1e-9 * span
    return places


def _refined(context: Context, name: str, job: Places, swept: dict[str, np.ndarray]) -> tuple[Places, dict[str, np.ndarray]]:
    """Further places around those of least factor: the intervals beside each are halved, and those beside the least of them again.
    Each round is a sweep of that name, with progress and checkpoint.

    Without fill the factor jumps where an axle goes from one block to the next: then also a hair before and behind each such place.
    """
    widest = 1.01 * max(np.median(np.abs(np.diff(job.places[job.ways == way]))) if (job.ways == way).sum() > 1 else 0.0 for way in (1, -1))
    for _ in range(HALVINGS):
        more = [(0.5 * (low + high), way) for low, high, way in _lowest(job, swept["factor"], widest)]
        job, swept = _with_places(context, name, job, swept, more)
    if job.assembly.earth is None:
        _, x1, block = job.pieces
        ends = x1[:-1][np.diff(block) != 0]
        at = [(ends[:, None] + way * job.train.axles).ravel() for way in (1.0, -1.0)]
        hair = 1e-6 * (job.span[1] - job.span[0])
        more = [
            (place + side * hair, way)
            for low, high, way in _lowest(job, swept["factor"], widest)
            for place in at[0 if way > 0 else 1]
            if low < place < high
            for side in (-1.0, 1.0)
        ]
        job, swept = _with_places(context, name, job, swept, more[:MOST_PLACES])
    return job, swept


def _lowest(job: Places, factor: np.ndarray, widest: float) -> list[tuple[float, float, float]]:
    """Intervals of places (from, to [m], way) beside the local minima that are near to the least; those wider than `widest` carry no load."""
    found = []
    for way in np.unique(job.ways):
        own = np.flatnonzero(job.ways == way)
        own = own[np.argsort(job.places[own])]
        place, padded = job.places[own], np.concatenate([[np.inf], factor[own], [np.inf]])
        low = np.flatnonzero((padded[1:-1] <= np.minimum(padded[:-2], padded[2:])) & (padded[1:-1] <= NEARLY * factor.min()))
        beside = sorted({int(k) for i in low for k in (i - 1, i) if 0 <= k < len(place) - 1}) if np.isfinite(factor).any() else []
        found += [(place[k], place[k + 1], float(way)) for k in beside if place[k + 1] - place[k] <= widest]
    return found


def _with_places(
    context: Context, name: str, job: Places, swept: dict[str, np.ndarray], more: list[tuple[float, float]]
) -> tuple[Places, dict[str, np.ndarray]]:
    """The job and its rows with further places (place [m], way), in the order in which the train passes them."""
    if not more:
        return job, swept
    places, ways = np.array(more).T
    further = replace(job, places=places, ways=ways)
    found = sweep(context, name, further, len(more), "further positions near the one with the least factor", slow=True).whole()
    places, ways = np.append(job.places, places), np.append(job.ways, ways)
    order = np.lexsort((ways * places, -ways))
    swept = {key: np.concatenate([values, found[key]])[order] for key, values in swept.items()}
    return replace(job, places=places[order], ways=ways[order]), swept


def _standing(job: Places, k: int, worst: Collapse) -> np.ndarray:
    """Stretches (n, 2) [m] on which even loads stand."""
    x0, x1, _ = job.pieces
    _, x, _ = job._even(k)
    on = x[worst.standing] if len(x) else x
    laden = np.isin(0.5 * (x0 + x1), on)
    ends = np.flatnonzero(np.diff(np.concatenate([[False], laden, [False]]).astype(int)))
    return np.array([(x0[a], x1[b - 1]) for a, b in ends.reshape(-1, 2)]).reshape(-1, 2)


def _envelope(assembly: Assembly, line: np.ndarray, normal: np.ndarray) -> TableData:
    """Of each joint over all places at collapse: greatest compression, and the ends of where the thrust line passes."""
    share = ((line - assembly.p) * assembly.tangent).sum(axis=2) / assembly.length
    pressed_on = (normal > 0.0) & np.isfinite(share)
    some = pressed_on.any(axis=0)
    low, high = (
        np.where(some, getattr(np.where(pressed_on, share, fill), end)(axis=0), np.nan) for end, fill in (("min", np.inf), ("max", -np.inf))
    )
    return TableData(
        {
            "joint": assembly.joint_names,
            "greatest_compression": np.where(pressed_on, normal, 0.0).max(axis=0) / assembly.depth / 1e3,
            "least_position": low,
            "greatest_position": high,
        },
        {"greatest_compression": "kN/m"},
    )


def _where(job: Places, k: int, worst: Collapse, r: out.MovingLoad) -> str:
    """Position of the loads at the worst place k: the first axle or, without axles, the stretches of the uniform loads."""
    if len(job.train.axles):
        way = "span" if r.chain else "way"
        return f"its first axle at x = {r.worst_place_m:.2f} m ({100 * r.worst_place_over_span:.0f} % of the {way})"
    return "uniform loads on x = " + " and ".join(f"{start:.2f} to {stop:.2f} m" for start, stop in _standing(job, k, worst))


def _words(options: MovingLoad, r: out.MovingLoad, what: str, where: str, positions: int) -> str:
    """The result in words; what: the chain or the structure that the load crosses."""
    if r.adequacy_factor is not None and options.force is None:
        heading = f", heading to {r.worst_way}" if options.both_ways else ""
        factors = "" if r.live_load_factor == 1.0 else f" with its load factor of {r.live_load_factor:.3g}"
        text = (
            f"{what[:1].upper()}{what[1:]} carries {r.adequacy_factor:.3g} times {'the train' if r.train == 'train' else r.train}{factors} at "
            f"the most dangerous place, with {where}{heading}. The total load on the structure is then "
            f"{three_figures(r.collapse_load_N / 1e3)} kN."
        )
    else:
        text = f"The least collapse load of {what} is {three_figures(r.collapse_load_kN_per_m)} kN per metre of depth, with {where}."
        if not {"axles", "uniform"} & options.model_fields_set:
            text += " The load is a single axle (default)."
    if r.places_without_limit:
        text += f" At {r.places_without_limit} of {positions} positions, the load never causes collapse."
    if options.force is not None:
        text += f" The given load of {three_figures(options.force / 1000.0)} kN has a safety factor of {r.safety_factor:.2f}."
        if r.adequacy_factor is not None and abs(r.adequacy_factor / r.safety_factor - 1.0) > 1e-9:
            text += f" With the partial factors of the load, the adequacy factor is {r.adequacy_factor:.3g}."
    if r.permissible_factor is not None:
        text += (
            f" Permissible limit state: up to {r.permissible_factor:.3g} times the train, a thrust line exists "
            f"with stresses below {r.permissible_stress_Pa / 1000000.0:.3g} MPa."
        )
    if r.dilating_joints:
        text += f" Joints slide, so the capacity is an {out.DILATANT}."
    if r.characteristic and (r.load_N is not None or r.adequacy_factor is not None):
        text += f" {out.CHARACTERISTIC}"
    return text + spoken_ties(r.ties)


def _violated(train: Train, assembly: Assembly) -> list[str]:
    """What a load that crosses a bridge supposes of the structure, where it has none: earth that spreads the load."""
    if assembly.earth is not None:
        return []
    weight = "" if assembly.fill is None else "; the fill acts only by its weight"
    load = f"The {train.name}" if train.name in ("load", "train") else train.name
    return [
        (
            f"{load} acts directly on the blocks{weight}: fill does not spread the load, and neither "
            "passive pressure nor backing restrains the blocks."
        )
    ]
