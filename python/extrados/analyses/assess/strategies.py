"""The strategies that a building may be asked by, and how each is asked: parameters by stated rules."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from extrados import kinds
from extrados.analyses.assess.hazard import STRONG, strong_end
from extrados.analyses.assess.tables import Assess
from extrados.analyses.assess.tables import Strategy as StrategyName
from extrados.analyses.codes.actions import fits
from extrados.analyses.context import Context
from extrados.model.errors import NoView
from extrados.model.structures.plan import Plan
from extrados.motions.tables import Compatible
from extrados.results import validity
from extrados.results.assess import Axis
from extrados.schema.constants import GRAVITY
from extrados.schema.quantities import engineering
from extrados.views.building import Building

#: Shares of the budget that a strategy may take
SHARES = {"probability": 0.15, "sla": 0.2, "push-x": 0.3, "push-y": 0.3, "dem": 0.15}
#: What of the budget is left to learn more where strategies differ or a margin is thin
REFINING = 0.3
#: Factors on the hazard that rocking is tried at, and those of a set, whose motions are many
LEVELS = [round(float(v), 4) for v in np.geomspace(0.25, 4.0, 33)]
LEVELS_OF_A_SET = [0.5, 0.7, 0.85, 1.0, 1.2, 1.5, 2.0, 3.0]
#: Nominal seconds of counted work on one core of 2024: a run of rocking by the kind of structure; a stone under SLA, an event
#: of a wall's elements; a step of discrete elements, and what each of its joints adds
RUN_SECONDS = {"block": 0.002, "column": 0.002, "arch": 0.012}
RUN_SECONDS_ELSE = 0.15
STONE_SECONDS, EVENT_SECONDS = 0.03, 5e-4
PUSH_SECONDS = 1.6e-6  # of an element of shells in an event
STEP_SECONDS, JOINT_SECONDS = 1.5e-6, 2.5e-7
#: Of the greatest frequency of impact at an edge: what the critical step of discrete elements is at least
STEP_RULE = 0.5
#: Joints that settle by this part of their length under the whole weight are as stiff as need be
STIFF_ENOUGH = 1e-4
#: Coefficient of variation of sizes and restitution where the deck gives none, and of corners that stray
SCATTER, STRAY = 0.05, 0.01
#: Discrete elements come to rest, or down, within so many sqrt(size/g)
AFTER = 12.0
#: Elements along the longer side of a wall, and of all walls of a building on a plan; points through their thickness
ELEMENTS, SHELL_ELEMENTS, LAYERS = 24, 800, 3
#: Size of elements over the lowest storey at most, so that piers and spandrels have some rows each
OF_A_STOREY = 0.25
#: A push goes to two sides, and each takes its part of the time; fewer events than these hardly reach a peak, however little
#: the budget
SIDES, LEAST_EVENTS = 2, 500
#: A push ends where its load has fallen to this part of the peak
FALLEN = 0.8


class LeftOut(Exception):
    """The strategy is not asked; the text says why."""


@dataclass(frozen=True)
class Choice:
    """The table of a strategy without its kind, the rules it was made by, in words, its nominal seconds, and its kind where
    that is not the strategy's own."""

    keys: dict[str, Any]
    words: str
    seconds: float = 0.0
    kind: str | None = None


@dataclass(frozen=True)
class Asked:
    """The building, the deck's assess table, and how many motions the hazard has; context: of the one motion of a set."""

    context: Context
    options: Assess
    motions: int
    peak_g: float

    @property
    def building(self) -> Building:
        """The building that all strategies look at."""
        return self.context.building

    def share(self, name: str) -> float:
        """Nominal seconds that a strategy may take."""
        return SHARES[name] * self.options.for_strategies


@dataclass(frozen=True)
class Strategy:
    """name: as decks call it; kind: of its analysis; label: in words; axis: what it compares (results.assess); assumes:
    what it takes for granted; choose: how it is asked."""

    name: StrategyName | Literal["scaled"]
    kind: str
    label: str
    axis: Axis
    assumes: str
    choose: Callable[[Asked], Choice]

    def applies(self, building: Building) -> bool:
        """Whether it can look at the building: on a plan there are walls, which are pushed and checked, and no stones."""
        on_plan = isinstance(building.structure, Plan)
        return self.name == "code-checks" or on_plan == (self.kind in ("pushover", "frame-pushover"))


def _as_it_is(asked: Asked) -> Choice:
    return Choice({}, "as the deck says")


def _levels(asked: Asked) -> Choice:
    if asked.motions > 1:
        return Choice(
            {"intensity": "scale", "levels": LEVELS_OF_A_SET, "count": asked.motions, "bootstrap": 100}
            | ({"uncertain": asked.options.uncertain} if asked.options.uncertain else {}),
            f"{asked.motions} motions, each at {len(LEVELS_OF_A_SET)} scale factors from 0.5 to 3",
        )
    return Choice(
        {"intensity": "scale", "levels": LEVELS, "bootstrap": 0}, "the motion at 33 scale factors from 0.25 to 4, in steps of 9 %"
    )


def _scatter(asked: Asked) -> dict[str, float]:
    """The uncertain values that a kind of structure knows."""
    kind = asked.building.require_structure().kind
    own = {
        "arch": {"thickness": SCATTER, "restitution": SCATTER},
        "block": {"width": SCATTER, "height": SCATTER, "restitution": SCATTER},
        "column": {"width": SCATTER, "height": SCATTER, "restitution": SCATTER},
    }.get(kind, {"density": SCATTER, "imperfection": STRAY, "restitution": SCATTER})
    if asked.building.require_structure().rocks_as == "piers":
        own = {"restitution": SCATTER}
    if kind == "block" and getattr(asked.building.structure, "width", None) is None:
        own = {"centre_height": SCATTER, "toe_right": SCATTER, "restitution": SCATTER}
    return own


def _probability(asked: Asked) -> Choice:
    if asked.motions > 1:
        raise LeftOut(
            "this strategy is not needed: the hazard is already a set of different motions, and the row of the set gives "
            "the share of motions that cause collapse"
        )
    uncertain = asked.options.uncertain or _scatter(asked)
    if asked.building.restraints or asked.building.supports.abutting_wall is not None:
        raise LeftOut("this strategy does not vary the sizes of a building with restraints (ties, dampers, a wall)")
    each = RUN_SECONDS.get(asked.building.require_structure().kind, RUN_SECONDS_ELSE)
    count = int(2 ** np.floor(np.log2(np.clip(asked.share("probability") / each, 16, 1024))))
    told = ", ".join(f"{name} {100 * v:g} %" for name, v in uncertain.items())
    return Choice(
        {"count": count, "seed": 1, "uncertain": uncertain},
        f"{count} samples of the building with uncertain {told} (coefficients of variation); this "
        f"strategy may use {100 * SHARES['probability']:g} % of the time budget, which limits the number of samples",
    )


def _push(asked: Asked, direction: float) -> Choice:
    """The push of a building on a plan along x or y, to both sides."""
    building, plan = asked.building, asked.building.structure
    assert isinstance(plan, Plan)
    materials = [building.material, *building.materials.values()]
    if not any(m.tensile_strength is not None and m.fracture_energy is not None for m in materials):
        raise LeftOut("the walls can crack only if [material] gives `tensile_strength` and `fracture_energy`")
    name = "push-x" if direction == 0.0 else "push-y"
    size = round(min(float(np.sqrt(plan.wall_area / SHELL_ELEMENTS)), OF_A_STOREY * min(plan.storeys)), 3)
    elements = plan.wall_area / size**2
    events = max(int(asked.share(name) / SIDES / (PUSH_SECONDS * elements)), LEAST_EVENTS)
    keys = {
        "direction": direction,
        "directions": ["+", "-"],
        "mesh": {"size": size, "layers": LAYERS},
        "ripple": 0.2,
        "events": events,
        "stop_fraction": FALLEN,
        **_action(asked),
    }
    words = (
        f"forces in proportion to the masses along {'x' if direction == 0.0 else 'y'}, in both senses; elements of {size:g} m, {LAYERS} "
        f"points through the thickness, at most {events} events, until the load has decreased to {FALLEN:g} of its peak"
    )
    return Choice(keys, words)


def _action(asked: Asked) -> dict[str, Any]:
    """Keys by which a push has the spectrum of the assessment; that of [code] it has by itself."""
    spectrum = asked.options.spectrum
    return {} if spectrum is None else {"verification": {"spectrum": spectrum.model_dump(exclude_none=True)}}


def _frame(asked: Asked) -> Choice:
    """All pushes of a building on a plan as a frame of macro-elements."""
    building = asked.building
    if building.material.tensile_strength is None and not building.joints.cohesion:
        raise LeftOut("the piers need a shear strength: give `tensile_strength` of [material], or `cohesion` of [joints]")
    # walls out of their planes are a strategy of their own
    return Choice(
        {"out_of_plane": False, **_action(asked)},
        "both directions, in both senses; forces in proportion to the masses, and to the masses times "
        "their height; accidental eccentricity 0 and 5 %",
    )


def _codes(asked: Asked) -> Choice:
    from extrados.analyses.codes.tables import CodeChecks

    spectrum = asked.options.spectrum
    if asked.building.require_structure().rocks_as == "piers":
        raise LeftOut("the pier rules require the vertical load on top of the wall: give options.code-checks = { axial_load = ... }")
    own = asked.building.require_structure().kind in (CodeChecks.structures or ())
    own = own and set(asked.building.special_keys) <= set(CodeChecks.considers)
    keys: dict[str, Any] = {} if own else {"mechanism": "building"}
    on_plan = isinstance(asked.building.structure, Plan)
    words = "" if own else f"{'each wall out of its plane' if on_plan else 'the local mechanism that limit analysis finds'}; "
    kind = None if own else "local-mechanism"
    if spectrum is not None:
        return Choice({**keys, "spectrum": spectrum.model_dump(exclude_none=True)}, f"{words}the spectrum of the deck", 0.0, kind)
    code, motion = asked.context.deck.code, asked.context.deck.motion
    if code is not None and any(code.spectrum(state) is not None for state in code.states):
        return Choice(keys, f"{words}the seismic action of [code], {code.name}", 0.0, kind)
    if isinstance(motion, Compatible) and fits(code, motion):
        return Choice(keys, f"{words}the target spectrum of the motions", 0.0, kind)
    told = f"{words}no code spectrum is given, so the demand is that of the motion itself: its peak and its response spectrum"
    return Choice({**keys, "motion_spectrum": True}, told, 0.0, kind)


def _sla(asked: Asked) -> Choice:
    building = asked.building
    if building.meshed_by_stones:
        stones = len(building.blocks().mass)
        needed = 2.0 * STONE_SECONDS * stones
        if needed > asked.share("sla"):
            raise LeftOut(
                f"the run of {stones} blocks takes about {needed:.0f} s, but its share of the time budget is {asked.share('sla'):.0f} s"
            )
        wall = building.supports.abutting_wall
        if wall is not None:
            return Choice({"directions": ["+" if wall == "left" else "-"]}, "blocks with joints, loaded away from the abutting wall")
        return Choice({"directions": ["+", "-"]}, "blocks with joints that open and slide, loaded in both senses")
    if building.material.tensile_strength is None:
        raise LeftOut("the wall can crack only if [material] gives `tensile_strength` and `fracture_energy`")
    size = getattr(building.structure, "size", None)
    keys: dict[str, Any] = {"directions": ["+"], "events": int(asked.share("sla") / EVENT_SECONDS), "stop_fraction": FALLEN}
    if size is not None:
        keys["mesh"] = {"size": max(size) / ELEMENTS}
    return Choice(
        keys,
        f"{ELEMENTS} elements along the longer side, loaded towards +x until the load has decreased to {FALLEN:g} of its "
        f"peak, at most {keys['events']} events",
    )


def _dem(asked: Asked) -> Choice:
    from extrados.analyses.dem.from_deck import joint_values

    building = asked.building
    try:
        assembly = building.blocks()
    except NoView:
        _ = building.solids()
        raise LeftOut("assess has no rule for discrete elements in space: add an analysis of kind `dem` to the deck") from None
    values = joint_values(building)
    motion = asked.context.motion
    end = strong_end(motion) + AFTER * float(np.sqrt(assembly.size / GRAVITY))
    joints = len(assembly.a)
    rate = STEP_SECONDS + JOINT_SECONDS * joints

    def seconds(factor: float) -> float:
        """Of a run with stiffnesses times a factor."""
        frequency = float(values.scaled(factor).impact.of("edge").max())
        damped = 0.5 * frequency * values.beta * (1.0 if building.joints.beta is not None else factor**-0.5)
        critical = STEP_RULE * 2.0 / frequency * (np.sqrt(1.0 + damped**2) - damped)
        return rate * end / (0.3 * critical)

    words = (
        f"the run ends at {end:.3g} s: this is {AFTER:g} sqrt(size/g) after the time at which the Arias "
        f"intensity of the motion reaches {100 * STRONG:g} %"
    )
    keys: dict[str, Any] = {"end_time": round(end, 3), "output_step": max(0.01, end / 1500.0)}
    share = asked.share("dem")
    given = building.joints.normal_stiffness is not None or any(t.normal_stiffness for t in building.joints.types)
    if seconds(1.0) <= share or given:
        if seconds(1.0) > 2.0 * share:
            raise LeftOut(_too_long(seconds(1.0), share, "with the joint stiffness of the deck"))
        whose = "the deck says" if given else "E divided by the block length gives"
        return Choice(keys, f"{words}; joint stiffness as {whose}", seconds(1.0))
    # steps grow as the root of the stiffness
    stiffness = float(np.median(values.stiffness)) * (share / seconds(1.0)) ** 2
    grounded = (assembly.a < 0) | (assembly.b < 0)
    weight = float(assembly.mass.sum()) * GRAVITY
    pressure = weight / (float(assembly.length[grounded].sum()) * assembly.depth)
    least = pressure / (STIFF_ENOUGH * float(assembly.length.min()))
    factor = least / float(np.median(values.stiffness))
    if stiffness < least and seconds(factor) <= 2.0 * share:
        stiffness = least
    elif stiffness < least:
        raise LeftOut(
            _too_long(seconds(factor), share, f"even with joints of {engineering(least, 'Pa/m')}, the least stiffness that is sufficient,")
        )
    taken = max(share, seconds(factor)) if stiffness == least else share
    stiffness = float(f"{stiffness:.1e}")
    keys["joints"] = {"normal_stiffness": stiffness}
    return Choice(
        keys,
        f"{words}; the joints have {engineering(stiffness, 'Pa/m')}, the greatest stiffness for which the "
        f"run fits into {100 * SHARES['dem']:g} % of the time budget. E divided by the block length would give {engineering(float(np.median(values.stiffness)), 'Pa/m')}. "
        f"The least stiffness that is sufficient is {engineering(least, 'Pa/m')}",
        taken,
    )


def _too_long(seconds: float, share: float, how: str) -> str:
    return f"{how} the run takes about {seconds:.0f} s, but its share of the time budget is {share:.0f} s"


_ALL: tuple[tuple[StrategyName, str, str, Axis, validity.Validity, Callable[[Asked], Choice]], ...] = (
    ("tilt", "tilt", "limit analysis", "acceleration", validity.Tilt, _as_it_is),
    ("rocking", "rocking", "rocking", "displacement", validity.Rocking, _as_it_is),
    ("assessment", "assessment", "primary impulse", "pulse", validity.Assessment, _as_it_is),
    ("code-checks", "code-checks", "codes", "check", validity.CodeChecks, _codes),
    ("probability", "fragility", "probability", "probability", validity.Fragility, _probability),
    ("sla", "sla", "sequentially linear analysis", "acceleration", validity.Sla, _sla),
    ("push-x", "pushover", "push along x", "acceleration", validity.Pushover, lambda asked: _push(asked, 0.0)),
    ("push-y", "pushover", "push along y", "acceleration", validity.Pushover, lambda asked: _push(asked, 90.0)),
    ("frame", "frame-pushover", "equivalent frame", "acceleration", validity.FramePushover, _frame),
    ("dem", "dem", "discrete elements", "displacement", validity.Dem, _dem),
)
ALL = tuple(Strategy(name, kind, label, axis, assumed.assumes, choose) for name, kind, label, axis, assumed, choose in _ALL)
#: Rocking at many factors on the hazard: the margin of `rocking`, and of a set the share of its motions
SCALED = Strategy("scaled", "fragility", "rocking under the hazard multiplied by scale factors", "probability", "", _levels)


def reckon_with(options: Assess, building: Building) -> set[str]:
    """Properties of the building that at least one of the strategies takes into account that are asked and can look at it."""
    asked = [s for s in ALL if s.name in (options.strategies or (s.name,)) and s.applies(building)]
    every = {s.kind for s in asked} | {"local-mechanism" for s in asked if s.name == "code-checks"}
    tables = [kinds.table("analysis", kind).model_construct(kind=kind, mechanism="building") for kind in every]
    return set().union(*(table.reckons_with(building) for table in tables))


def of(name: str) -> Strategy:
    """The strategy that decks call so."""
    return next(s for s in ALL if s.name == name)
