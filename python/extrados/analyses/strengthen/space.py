"""Capacity of blocks in space for strengthening: cone programmes along several directions, ties, chains and hoops among them."""

from typing import Any

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.solid_loads import solid_limit
from extrados.analyses.limit.solid_sliding import slide
from extrados.analyses.limit.solids import MOST_BESIDE, dilating_contacts, mechanism_told, moving_blocks, pose_of
from extrados.analyses.limit.tables import Tilt
from extrados.analyses.strengthen.alternatives import TieAlternative
from extrados.analyses.strengthen.measures import Statics, Worth
from extrados.analyses.strengthen.tables import Strengthen
from extrados.limit.errors import Immovable, NoAnswer, NoEquilibrium
from extrados.limit.solids import Falls, Programme, SolidLimit
from extrados.limit.strengthening import Point
from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building

#: Directions in plan of the load where the deck names none [deg]
AROUND = (0.0, 90.0, 180.0, 270.0)
#: Shares of the blocks that move, which distinguish mechanisms
SHARES = 20
#: Gap between both bounds, over the target, that the accuracy of the conic solver leaves
ACCURACY = 1e-6
#: Gap to the greatest capacity, over that capacity, at which a tie that never yields is taken to have reached it. Friction cones bend the curve
#: there: a smaller gap would require a large force for no gain
REACHED = 1e-3


class SpaceStatics(Statics):
    """Capacity of blocks in space by limit analysis [g]: the least along the directions of the load, which are its senses."""

    def __init__(self, context: Context, options: Strengthen):
        super().__init__(context, options, False)
        self.senses: tuple[float, ...] = tuple(options.directions) or AROUND
        self.smooth, self.reached = True, REACHED
        self.beams = np.empty((0, 5))

    def of(self, building: Building, picture: bool = False) -> Worth:
        """The capacity and what governs; picture: also the mechanism carried on."""
        try:
            limit = self._limit(building)
        except (BadGeometry, Refused) as error:
            return Worth(None, reason=str(error))
        found: list[Programme | None] = []
        for sense in self.senses:
            try:
                found.append(self._pushed(limit, sense))
            except Immovable:
                found.append(None)
            except NoEquilibrium as error:
                return Worth(0.0, "collapse under self-weight", bound="exact", reason=str(error))
            except NoAnswer as error:
                return Worth(None, reason=str(error))
        values = [np.inf if one is None else one.gamma for one in found]
        k = int(np.argmin(values))
        governs = found[k]
        if governs is None:
            return Worth(np.inf, "none: the contacts restrain the blocks on all sides", bound="exact", by_sense=tuple(values))
        slides = [one is not None and dilating_contacts(limit, one) > 0 for one in found]
        beside, unfound = self._without_dilatancy(limit, found, slides) if picture and any(slides) else (None, "")
        # blocks are counted, as mechanisms of a round structure along several directions differ by their names alone
        moving = len(moving_blocks(limit.assembly, governs)) / len(limit.assembly.mass)
        shape = (("moving blocks", f"{round(SHARES * moving)}"),)
        return Worth(
            values[k],
            self._told(limit, governs, self.senses[k]),
            shape,
            "upper" if any(slides) else "exact",
            by_sense=tuple(values),
            sense=self.senses[k],
            in_space=(limit.assembly, pose_of(limit.assembly, governs.motion)) if picture else None,
            beside=beside,
            unfound=unfound,
        )

    def _without_dilatancy(self, limit: SolidLimit, found: list[Programme | None], slides: list[bool]) -> tuple[float | None, str]:
        """The least design value over the directions [g], of those without sliding the value itself, and why it is None: a large
        structure, or a direction along which contacts slide and no state is certified."""
        none = "friction governs, and no state without dilatancy was found"
        if len(limit.assembly.a) > MOST_BESIDE:
            return None, f"{none}, because such states are not calculated for more than {MOST_BESIDE} contacts"
        values: list[float] = []
        for sense, one, sliding in zip(self.senses, found, slides, strict=True):
            if one is None:
                continue
            row = slide(limit, sense, one.gamma, self.options.starts, patient=False)[0] if sliding else None
            states = [one.gamma] if row is None else [v for v in (row.load_path_g, row.least_g) if v is not None]
            if not states:
                return None, f"{none} along {self.word(sense)}, because none is certified"
            values += states
        return min(values), ""

    def carrying(self, one: TieAlternative, place: int) -> "SpaceStatics":
        """Itself with a ring beam along the strands of a tie: its weight is even along them and rests on the blocks at their points."""
        if not one.beam_weight:
            return self
        strands = self.context.building.having(ties=(one.places[place],)).strands()
        whole, rows = sum(strand.length for strand in strands), []
        for strand in strands:
            for ends in strand.segments:
                length = float(np.linalg.norm(strand.point[ends[1]] - strand.point[ends[0]]))
                for k in ends:
                    half = 0.5 * one.beam_weight / GRAVITY * length / whole / len(strand.blocks[k])
                    rows += [(block, half, *strand.point[k]) for block in strand.blocks[k] if block != GROUND]
        loaded = SpaceStatics(self.context, self.options)
        loaded.beams = np.array(rows)
        return loaded

    def point(self, one: TieAlternative, place: int, force: float) -> Point:
        """A point of the capacity curve over the yield force; Immovable where nothing moves."""
        building = self.context.building
        limit = self._limit(one.having(building, place, force))
        strands = building.having(ties=(one.places[place],)).strands()
        sign = {"tension": (1.0,), "compression": (-1.0,), "both": (1.0, -1.0)}[one.places[place].works_in]
        found = []
        for sense in self.senses:
            try:
                state = self._pushed(limit, sense)
            except Immovable:
                continue
            # the power of the push is the scale of the programme
            longer = [s.lengthening(limit.assembly.centroid, state.motion) for s in strands]
            slope = sum(max(w * rate for w in (*sign, 0.0)) for rate in longer) / limit.scale
            found.append(Point(force, state.gamma, slope, sense, self._told(limit, state, sense)))
        if not found:
            raise Immovable("no load of this kind causes collapse")
        return min(found, key=lambda p: p.capacity)

    def force(self, one: TieAlternative, place: int, target: float) -> float:
        """The least yield force [N] at a place; infinite where none suffices. The load along each direction is a programme of
        its own: more force than one of them needs does no harm to it."""
        building = self.context.building
        held = building.having(ties=(*building.ties, one.places[place].model_copy(update={"yield_force": None})))
        limit = self._limit(held)
        sized = [k for k, strand in enumerate(limit.strands) if strand.tie == len(building.ties)]
        needed = max(limit.least_force(sense, target, sized) for sense in self.senses)
        return needed if needed <= one.most else np.inf

    def forces(self, ties: list[tuple[TieAlternative, int]], target: float) -> np.ndarray:
        """Yield forces [N] of least sum with which the blocks carry the target along all directions, by one cone programme."""
        building = self.context.building
        added = tuple(one.places[place].model_copy(update={"yield_force": None}) for one, place in ties)
        limit = self._limit(building.having(ties=(*building.ties, *added)))
        groups = [[k for k, s in enumerate(limit.strands) if s.tie == len(building.ties) + n] for n in range(len(ties))]
        return limit.least_forces(self.senses, target, groups, np.array([one.most for one, _ in ties]))

    def unlimited(self, one: TieAlternative, place: int) -> float | None:
        """The capacity with a tie that never yields; None where it leaves no mechanism."""
        value = self.of(one.having(self.context.building, place, None)).value
        return value if value is not None and np.isfinite(value) else None

    def told_at(self, point: Point) -> str:
        """The mechanism of a point of a curve in words."""
        return str(point.mechanism)

    def word(self, sense: float) -> str:
        """A direction in words."""
        return f"{sense:g} degrees"

    def other_sense_told(self, building: Building) -> str:
        """That one direction alone was asked for."""
        return (
            f"The target refers only to a load along {self.word(self.senses[0])}. An earthquake acts in all directions: "
            "remove the key `directions`, unless the other sides are restrained."
        )

    @property
    def aimed(self) -> float:
        """The capacity for which ties are sized [g]."""
        return self.target * (1.0 + ACCURACY) + ACCURACY

    def _limit(self, building: Building) -> SolidLimit:
        building.refuse_weightless(building.solids())
        return solid_limit(building, Tilt.model_construct(load=self.options.load), self.beams)

    def _pushed(self, limit: SolidLimit, sense: float) -> Programme:
        """Collapse along a direction; NoEquilibrium where the blocks do not stand at rest."""
        found = limit.push(sense)
        if isinstance(found, Falls) or found.gamma < 0.0:
            falls = found if isinstance(found, Falls) else limit.falls()
            name = "" if falls is None else limit.assembly.block_names[int(np.linalg.norm(falls.motion[:, :3], axis=1).argmax())]
            raise NoEquilibrium(f"certificate: a mechanism, fastest at {name}, in which the weights do positive work")
        return found

    def _told(self, limit: SolidLimit, found: Programme, sense: float) -> str:
        return f"load along {self.word(sense)}: {mechanism_told(limit.assembly, found)}"


def refuse_in_space(context: Context, options: Strengthen) -> None:
    """Refused where a deck asks in space for what is known in a plane section alone."""
    wrong: dict[str, tuple[bool, Any]] = {
        "the key `direction` is only for plane sections: give `directions`": (options.direction != "both", ("analysis", "direction")),
        "friction_rule: in space, ties are sized for dilatant sliding only. Remove `friction_rule`": (
            options.friction_rule != "associated",
            ("analysis", "friction_rule"),
        ),
        "compressive_strength: limit analysis in space neglects crushing. Remove `compressive_strength`": (
            context.building.material.compressive_strength is not None,
            ("material", "compressive_strength"),
        ),
    }
    for text, (there, key) in wrong.items():
        if there:
            raise Refused(text, key)
