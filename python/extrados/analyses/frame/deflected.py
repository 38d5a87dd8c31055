"""Walls of a plan out of their planes: each wall as a chain of macro-elements whose sections lie across its thickness.

The laws are those of piers in their planes: sections without tension that crush, in equilibrium with the end forces, and the
second-order effect of the deflection (after Vanin, Penna and Beyer 2020). Their block of stress gives a stiff wall the hinge of its
rigid mechanism, so that a deflection only lowers the multiplier. Rigid floors and props hold the chain on their levels.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from extrados.analyses.codes.mechanisms import BLOCK
from extrados.analyses.codes.walls import FloorActions, floor_actions, material_of, parts_of_wall
from extrados.analyses.context import Refused
from extrados.core.errors import Cancelled, CoreError
from extrados.core.frame import UNLIMITED, Frame, MacroElement
from extrados.limit.errors import CannotStand
from extrados.model.structures.plan import Plan
from extrados.model.structures.plan_parts import MEETS, PlanWall
from extrados.results.frame import WallDeflection
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building
from extrados.views.frame.options import FrameOptions
from extrados.views.frame.plan import SHEAR_FACTOR

#: Ends of the elements of a storey over its height, and elements of a gable. A wall without load that is held on top opens just
#: below its top, so that the elements of a held storey are short at both ends.
PARTS = 4
EVEN = np.linspace(0.0, 1.0, PARTS + 1)
GRADED = 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 2 * PARTS + 1)))
#: Shortest element beside the sill or head of an opening, over the height of the storey
SHORTEST = 0.02
#: Greatest mean displacement over the thickness of the wall, and steps up to it
REACH, STEPS = 1.0, 100
#: Share of the greatest acceleration at which a calculation ends
DROP = 0.7


@dataclass(frozen=True)
class Piece:
    """Masonry of a wall between two heights [m]: its length and thickness [m], density [kg/m^3], and the modulus, Poisson's ratio and
    strength of the stress block [Pa] of its sections."""

    low: float
    high: float
    length: float
    thickness: float
    density: float
    young: float
    poisson: float
    strength: float = UNLIMITED

    @property
    def weight(self) -> float:
        """Of the piece [N]."""
        return GRAVITY * self.density * self.length * self.thickness * (self.high - self.low)


@dataclass(frozen=True)
class At:
    """On a height [m]: vertical load and horizontal force [N], whether the load has a mass, and whether a floor holds the wall."""

    height: float
    load: float = 0.0
    force: float = 0.0
    sways: bool = True
    held: bool = False


class Chain:
    """A wall out of its plane: pieces from the foot up, whose first section is on rigid ground, and what acts on their heights."""

    def __init__(self, pieces: Sequence[Piece], actions: Sequence[At] = (), sections: int = 5, second_order: bool = True):
        self.pieces = list(pieces)
        self.heights = np.array([pieces[0].low, *(p.high for p in pieces)])
        place = [(a, int(np.abs(self.heights - a.height).argmin())) for a in actions]
        held = {k for a, k in place if a.held}
        number = itertools.count()
        # u across the wall, w upward, rotation of every height; the ground is held
        self.freedoms = np.array(
            [[-1 if k == 0 or (f == 0 and k in held) else next(number) for f in range(3)] for k in range(len(self.heights))]
        )
        n = next(number)
        self.mass, self.weight = np.zeros(n), np.zeros(n)
        for k, p in enumerate(self.pieces):
            for node in (k, k + 1):
                self._add(node, 0.5 * p.weight, 0.5 * p.weight / GRAVITY)
        for a, k in place:
            self._add(k, a.load, a.load / GRAVITY if a.sways else 0.0)
            if self.freedoms[k, 0] >= 0:
                self.weight[self.freedoms[k, 0]] += a.force
        self.elements = [
            MacroElement(
                tuple(self.freedoms[k : k + 2].ravel().tolist()),
                p.high - p.low,
                p.thickness,
                p.length,
                p.young,
                p.young / (2.0 * (1.0 + p.poisson)) * p.length * p.thickness / (SHEAR_FACTOR * (p.high - p.low)),
                p.strength,
                sections=sections,
                second_order=second_order,
                own_weight=p.weight,
            )
            for k, p in enumerate(self.pieces)
        ]

    def _add(self, node: int, load: float, mass: float) -> None:
        u, w, _ = self.freedoms[node]
        if w >= 0:
            self.weight[w] -= load
        if u >= 0:
            self.mass[u] += mass

    def core(self) -> Frame:
        """The chain in the core."""
        n = len(self.weight)
        return Frame(self.elements, [], np.zeros((n, n)), self.weight, np.diag(self.mass))

    def limit(self) -> tuple[float, float, float, bool]:
        """Greatest constant acceleration [g] that the chain carries across its plane, the greatest deflection there [m] and its height
        [m], and whether the acceleration falls afterwards; 0 without equilibrium under the weight. Of both senses the lesser one."""
        reach = REACH * max(p.thickness for p in self.pieces)
        across = self.freedoms[:, 0]
        found = []
        pushed = np.any(self.weight[across[across >= 0]] != 0.0)
        for sense in (1.0, -1.0) if pushed else (1.0,):
            with self.core() as core:
                path = core.push(sense * GRAVITY * self.mass, sense * self.mass / self.mass.sum(), reach, STEPS, DROP)
            if path.stop == "no equilibrium under the weight":
                return 0.0, 0.0, float(self.heights[-1]), True
            k = int(path.multiple.argmax())
            moved = np.where(across >= 0, path.displacement[k][across], 0.0)
            node = int(np.abs(moved).argmax())
            found.append((float(path.multiple[k]), float(abs(moved[node])), float(self.heights[node]), k + 1 < len(path.multiple)))
        return min(found)


def chain_of(building: Building, wall: PlanWall, actions: FloorActions, options: FrameOptions) -> Chain:
    """A wall of a plan, with the length of its masonry at each height, as far up as floors leave it free to move."""
    plan = building.structure
    assert isinstance(plan, Plan)
    last = plan.reach(wall)[1]
    top = float(plan.levels[last])
    bands = [
        (k, float(plan.levels[k - 1]) + low, float(plan.levels[k - 1]) + high, length)
        for k in range(1, last + 1)
        for length, low, high in plan.strips(wall, k)
    ]
    on_gable = actions.on_gable.get(wall.name, 0.0)
    gable = 0.0 if wall.gable is None else wall.gable.rise
    held = set(actions.held[wall.name])
    loads = [
        At(float(plan.levels[k]), actions.loads.get((wall.name, k), 0.0) - (on_gable if k == last else 0.0), held=k in held)
        for k in range(1, last + 1)
    ]
    if gable and wall.name not in actions.held_gables:
        cuts = np.linspace(0.0, 1.0, PARTS + 1)
        bands += [
            (last, top + gable * a, top + gable * b, wall.length * (1.0 - 0.5 * (a + b))) for a, b in itertools.pairwise(cuts.tolist())
        ]
        loads.append(At(top + 0.5 * gable, on_gable))
    elif gable:
        own = 0.5 * material_of(building, plan, wall, last).density * plan.thickness_of(wall, last) * wall.length * gable
        loads.append(At(top, on_gable + own * GRAVITY))
    normal = np.array([-wall.direction[1], wall.direction[0]])
    loads += [At(float(plan.levels[k]), force=float(force @ normal)) for (name, k), force in actions.thrusts.items() if name == wall.name]
    loads += [At(float(plan.levels[p.level or last]), p.force, sways=False) for p in plan.prestress if p.wall == wall.name]
    pieces = []
    for storey, low, high, length in bands:
        material, thick = material_of(building, plan, wall, storey), plan.thickness_of(wall, storey)
        pressed = material.compressive_strength
        grid = GRADED if storey in held else EVEN
        cuts = float(plan.levels[storey - 1]) + plan.storeys[storey - 1] * grid if low < top - MEETS else np.empty(0)
        apart = SHORTEST * plan.storeys[storey - 1]
        places = [low, *(z for z in cuts.tolist() if low + apart < z < high - apart), high]
        pieces += [
            Piece(
                a,
                b,
                length,
                thick,
                material.density,
                options.stiffness * material.young,
                material.poisson,
                UNLIMITED if pressed is None else BLOCK * pressed / options.confidence_factor,
            )
            for a, b in itertools.pairwise(places)
        ]
    return Chain(pieces, loads, options.sections, options.second_order)


def deflected_walls(building: Building, options: FrameOptions) -> tuple[list[WallDeflection], list[str]]:
    """Every wall out of its plane, the weakest first, beside its rigid bodies; and which of these numbers are not given, with the
    reasons."""
    plan = building.structure
    assert isinstance(plan, Plan)
    actions = floor_actions(plan)
    rows, missing = [], []
    for wall in plan.walls:
        rigid: list[float] = []
        try:
            rigid = [part.body.multiplier() for part in parts_of_wall(building, wall, actions)]
        except (Refused, CannotStand) as error:
            missing.append(f"The rigid mechanism of wall '{wall.name}' out of its plane is not calculated: {error}.")
        try:
            limit, moved, height, falls = chain_of(building, wall, actions, options).limit()
        except Cancelled:
            raise
        except (Refused, CoreError) as error:
            missing.append(
                f"The acceleration that wall '{wall.name}' carries out of its plane, with deflection, is not calculated: {error}."
            )
            continue
        rows.append(
            WallDeflection(
                wall=wall.name,
                acceleration_g=limit,
                deflection_m=moved,
                height_m=height,
                reached=falls,
                rigid_acceleration_g=min(rigid, default=None),
                held_at_m=sorted(float(plan.levels[k]) for k in actions.held[wall.name] if k <= plan.reach(wall)[1]),
            )
        )
    return sorted(rows, key=lambda row: row.acceleration_g), missing
