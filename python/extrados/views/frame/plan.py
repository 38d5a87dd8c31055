"""A building on a plan as a frame of macro-elements.

Each wall is a plane frame of piers and spandrels between rigid nodes. On a level all nodes of a wall have one displacement
along it; where walls cross, both make up the displacement of the corner, and floors are membranes between corners. Walls have
no stiffness out of their planes; their masses move with the corners.
"""

import itertools

import numpy as np

from extrados.core.frame import UNLIMITED, Link, MacroElement
from extrados.model.description import Description
from extrados.model.errors import BadGeometry, blaming
from extrados.model.geometry.polygons import signed_area
from extrados.model.properties import Material
from extrados.model.structures.plan import DEEPEST_AXIS, Plan
from extrados.model.structures.plan_parts import MEETS, PARALLEL, PlanWall, Rod, StoreyFloor, meeting, nearly_meeting
from extrados.schema.constants import GRAVITY
from extrados.views.frame.division import Division, parts_around_openings
from extrados.views.frame.flanges import Flange, effective_part
from extrados.views.frame.frame import EquivalentFrame, PointMass, Strip, Trace
from extrados.views.frame.options import FrameOptions
from extrados.views.frame.spandrels import BLOCK, flexural_strength, shear_strength, strut_of, strut_strength
from extrados.views.mesh.triangles import fill_ring
from extrados.views.shell.plan_floors import RIGID_THICKNESS, RIGID_YOUNG

#: Shear factor of rectangles
SHEAR_FACTOR = 1.2
#: Share of the compressive strength that masonry has along the wall
HORIZONTAL = 0.5
#: Distance of a rod from the middle plane of a wall, and from its spandrels, within which it is their tie [m]
BESIDE = 0.5
#: Slices of gables, and of the thrust along a wall
SLICES = 8
#: Stiffness of props that do not move [N/m]
HELD = 1e12


def frame_of_plan(building: Description, options: FrameOptions) -> EquivalentFrame:
    """Piers, spandrels and rigid nodes of walls on a plan, with floors, loads and ties; BadGeometry names what does not fit."""
    assert isinstance(building.structure, Plan)
    return _Maker(building, building.structure, options).made()


class _Maker(Division):
    def __init__(self, building: Description, plan: Plan, options: FrameOptions):
        super().__init__(plan, options)
        self.building = building
        self.placed: list[tuple[int, int, float, float, float]] = []  # vertical forces: wall, level, s from, to, force
        self.flanges: list[Flange] = []
        self.junctions = {
            (a, b): at
            for a, b in itertools.combinations(range(len(plan.walls)), 2)
            if (at := meeting(plan.walls[a], plan.walls[b])) is not None
        }

    def made(self) -> EquivalentFrame:
        plan = self.plan
        for a, b in itertools.combinations(range(len(plan.walls)), 2):
            if (a, b) not in self.junctions and (gap := nearly_meeting(plan.walls[a], plan.walls[b])) is not None:
                self.remarks.append(
                    f"Walls '{plan.walls[a].name}' and '{plan.walls[b].name}' end {gap:.3g} m apart, so they do not meet and are not "
                    "connected."
                )
        for k, corner in enumerate(plan.corners):
            if tuple(sorted(map(self._named, corner.walls))) not in self.junctions:
                raise BadGeometry(f"walls '{corner.walls[0]}' and '{corner.walls[1]}' do not meet", ("structure", "corners", k))
        self.remarks += plan.floor_remarks
        self._remark_beams()
        for w, wall in enumerate(plan.walls):
            with blaming("walls", w):
                if plan.reach(wall)[0] != 1:
                    raise BadGeometry(f"wall '{wall.name}' does not reach the ground, so it has no pier below")
                self.divide_wall(w, wall)
        n = self._number()
        self.linear, self.weight = np.zeros((n, n)), np.zeros(n)
        self.masses: list[PointMass] = []
        self.inertia = np.zeros(n)
        self.total = 0.0
        for strip in self.strips:
            self._weigh(strip)
        for w, wall in enumerate(plan.walls):
            self._weigh_around(w, wall)
            self._gable(w, wall)
        rings: dict[tuple[int, frozenset[int]], int] = {}
        for k, floor in enumerate(plan.floors):
            with blaming("floors", k):
                around = frozenset(w for w, _, _ in plan.around(floor))
                if (first := rings.setdefault((floor.storey, around), k)) != k:
                    raise BadGeometry(f"floor {first + 1} is given for the same walls on storey {floor.storey}")
                self._floor(floor)
        for load in plan.prestress:
            w = self._named(load.wall)
            start, end = load.x or (0.0, plan.walls[w].length)
            self._load(w, load.level or plan.reach(plan.walls[w])[1], start, end, load.force, False)
        for prop in plan.props:
            w = self._named(prop.wall)
            row = self._vector(w, 0.5 * plan.walls[w].length, prop.storey)[int(np.abs(plan.walls[w].direction).argmin())]
            self.linear += HELD * np.outer(row, row)
        if plan.foundation_stiffness is not None:
            self._ground(plan.foundation_stiffness)
        rods = self._rods()
        elements = [self._element(strip) for strip in self.strips]
        for k in sorted(self.idle):
            self.remarks.append(f"Rod {k + 1} passes no spandrel and joins no walls that move apart: it has no effect on the frame.")
        return EquivalentFrame(
            plan,
            self.nodes,
            self.strips,
            elements,
            [*self._corners(), *rods],
            self.linear,
            self.weight,
            self.masses,
            self.inertia,
            self.total,
            self.remarks,
            self.flanges,
            self.along,
            self._unbonded(),
            self._traces(),
        )

    def _remark_beams(self) -> None:
        """Remarks on bed joints and ring beams, which the frame simplifies."""
        plan = self.plan
        if plan.beds:
            self.remarks.append(
                "The frame does not include the bed joints of [[structure.beds]]: only the shear strength of the masonry limits the "
                "sliding of piers."
            )
        if plan.ring_beams:
            elastic = [b for b in plan.ring_beams if b.reinforcement is None]
            if elastic:
                self.remarks.append(
                    "Ring beams of [[structure.ring_beams]] without reinforcement remain elastic: check them for the greatest moment."
                )
            weak = {b.material for b in elastic if (m := self.building.materials.get(b.material)) and m.tensile_strength is None}
            if weak:
                self.remarks.append(
                    f"The tension of ring beams is not limited, because {', '.join(f'[materials.{name}]' for name in sorted(weak))} "
                    "has no `tensile_strength`. Then only `horizontal_strength` limits the strut in spandrels beside a ring beam. Give "
                    "`tensile_strength`, or check the reinforcement."
                )

    def _traces(self) -> list[Trace]:
        found = []
        for w, wall in enumerate(self.plan.walls):
            places = {0.0, wall.length}
            for (a, b), (s, t) in self.junctions.items():
                places |= {s} if a == w else {t} if b == w else set()
            for level in range(1, self.plan.reach(wall)[1] + 1):
                for place in sorted(places):
                    x, y = (np.asarray(wall.start) + place * wall.direction).tolist()
                    found.append(Trace(w, level, (x, y), self._vector(w, place, level)))
        return found

    def _unbonded(self) -> list[str]:
        """A statement of what masonry without cohesion lacks; none with a cohesion or a diagonal strength."""
        o = self.options
        if o.cohesion or o.diagonal_strength or self.building.joints.cohesion:
            return []
        slides = "" if o.shear in ("none", "damage") else f"piers slide at {o.friction:g} times their compression, "
        corners = ", and walls that meet at corners are not bonded" if self.junctions and not o.flange_strength else ""
        return [
            (
                f"Neither cohesion nor `diagonal_strength` is given: {slides}spandrels have no strength{corners}. "
                "For masonry in mortar, give [joints] cohesion, or `diagonal_strength` in [analysis.frame]."
            )
        ]

    def _named(self, name: str) -> int:
        return next(w for w, wall in enumerate(self.plan.walls) if wall.name == name)

    # Freedoms

    def _number(self) -> int:
        """Numbers of the freedoms: displacements of walls along themselves, those of nodes; the ground is held."""
        plan = self.plan
        line = list(range(len(plan.walls)))  # walls in one line that meet move along it together
        for a, b in self.junctions:
            if abs(float(plan.walls[a].direction @ plan.walls[b].direction)) > 1.0 - 1e-9:
                old, new = line[b], line[a]
                line = [new if k == old else k for k in line]
        self.along: dict[tuple[int, int], int] = {}
        self.turned = {w: float(np.sign(plan.walls[w].direction @ plan.walls[line[w]].direction)) for w in range(len(line))}
        if any(sign < 0.0 for sign in self.turned.values()):
            w = next(w for w, sign in self.turned.items() if sign < 0.0)
            raise BadGeometry(
                f"walls '{plan.walls[w].name}' and '{plan.walls[line[w]].name}' lie in one line with opposite directions: give "
                "both the same direction",
                ("structure", "walls", w),
            )
        count = 0
        of: dict[tuple[int, int], int] = {}
        for w, wall in enumerate(plan.walls):
            for level in range(1, plan.reach(wall)[1] + 1):
                if (line[w], level) not in of:
                    of[line[w], level] = count
                    count += 1
                self.along[w, level] = of[line[w], level]
        for node in self.nodes:
            if node.level or plan.foundation_stiffness is not None:
                node.freedoms = (count, count + 1)
                count += 2
        return count

    def _vector(self, w: int, s: float, level: int) -> np.ndarray:
        """Rows (2, n) of the displacement of a place of a wall on a level: along the wall its own, across it that of the corners,
        linear between them."""
        n = len(self.weight)
        d = self.plan.walls[w].direction
        normal = np.array([-d[1], d[0]])
        own = np.zeros(n)
        own[self.along[w, level]] = 1.0
        corners = []
        for (a, b), (sa, sb) in self.junctions.items():
            if w not in (a, b):
                continue
            other, place = (b, sa) if w == a else (a, sb)
            e = self.plan.walls[other].direction
            if (other, level) not in self.along or abs(float(d @ e)) > PARALLEL:
                continue
            row = -float(d @ e) * own
            row[self.along[other, level]] += 1.0
            corners.append((place, row / float(e @ normal)))
        across = np.zeros(n)
        if corners:
            corners.sort(key=lambda corner: corner[0])
            places = np.array([c[0] for c in corners])
            shares = [np.interp(s, places, np.eye(len(places))[k]) for k in range(len(places))]
            across = sum(share * c[1] for share, c in zip(shares, corners, strict=True))
        return np.outer(d, own) + np.outer(normal, across)

    # Loads

    def _load(self, w: int, level: int, start: float, end: float, force: float, massive: bool = True) -> None:
        """A vertical force spread along a wall on a level: on its nodes, up to the middles of the gaps between them."""
        self.total += force if massive else 0.0
        self.placed.append((w, level, start, end, force))
        own = self.at[w, level]
        bounds = [-np.inf]
        bounds += [0.5 * (self.nodes[i].end + self.nodes[j].start) for i, j in itertools.pairwise(own)]
        bounds += [np.inf]
        for k, (low, high) in zip(own, itertools.pairwise(bounds), strict=True):
            a, b = max(start, low), min(end, high)
            if b <= a:
                continue
            node, share, s = self.nodes[k], force * (b - a) / (end - start), 0.5 * (a + b)
            if node.freedoms[0] >= 0:
                self.weight[node.freedoms[0]] -= share
                self.weight[node.freedoms[1]] -= share * (s - node.s)
                if massive:
                    self.inertia[node.freedoms[0]] += share / GRAVITY
                    self.inertia[node.freedoms[1]] += share / GRAVITY * ((s - node.s) ** 2 + (b - a) ** 2 / 12.0)
            if level and massive:
                x, y = np.asarray(self.plan.walls[w].start) + s * self.plan.walls[w].direction
                self.masses.append(
                    PointMass(share / GRAVITY, (float(x), float(y), float(self.plan.levels[level])), self._vector(w, s, level), level)
                )

    def _weigh(self, strip: Strip) -> None:
        """Weight of a pier: half on each of its levels."""
        wall = self.plan.walls[strip.wall]
        if strip.kind != "pier":
            return
        density = self._material(wall, strip.storey).density
        start, end, low, high = strip.masonry
        force = density * GRAVITY * strip.thickness * (end - start) * (high - low)
        for level in (strip.storey - 1, strip.storey):
            self._load(strip.wall, level, start, end, 0.5 * force)

    def _weigh_around(self, w: int, wall: PlanWall) -> None:
        """Weight of masonry above and below openings, on the level that it reaches."""
        for storey in range(1, self.plan.reach(wall)[1] + 1):
            unit = self._material(wall, storey).density * GRAVITY * self.plan.thickness_of(wall, storey)
            for start, end, height, upper in parts_around_openings(self.plan.openings_in(wall, storey), self.plan.storeys[storey - 1]):
                self._load(w, storey if upper else storey - 1, start, end, unit * (end - start) * height)

    def _gable(self, w: int, wall: PlanWall) -> None:
        """Weight of a triangular top on the highest level of its wall, in slices."""
        outline = wall.gable_outline
        for (start, low), (end, high) in itertools.pairwise(outline):
            last = self.plan.reach(wall)[1]
            unit = self._material(wall, last).density * GRAVITY * self.plan.thickness_of(wall, last)
            cuts = np.linspace(start, end, SLICES + 1)
            for a, b in itertools.pairwise(cuts.tolist()) if end - start > MEETS else ():
                height = float(np.interp(0.5 * (a + b), (start, end), (low, high)))
                self._load(w, last, a, b, unit * height * (b - a))

    def _thrust(self, floor: StoreyFloor, around: list[tuple[int, float, float]]) -> None:
        """Thrust of rafters as constant horizontal forces on the level of their eaves, in slices along the walls."""
        for w, a, b, force in self.plan.thrusts(floor, around):
            middles = a + (b - a) * (np.arange(SLICES) + 0.5) / SLICES
            self.weight += sum(force / SLICES @ self._vector(w, s, floor.storey) for s in middles.tolist())
            self.remarks.append(
                f"Floor on storey {floor.storey}: the rafters push wall '{self.plan.walls[w].name}' outward with {float(np.hypot(*force)) / (b - a) / 1000.0:.3g} "
                "kN/m. The transverse walls of the frame resist this thrust: check the wall out of its plane "
                "with `local-mechanism`."
            )

    def _floor(self, floor: StoreyFloor) -> None:
        plan, level = self.plan, floor.storey
        if floor.seat is not None:
            self.remarks.append(
                f"Floor on storey {level}: the frame connects this floor to its walls, so its seat cannot slide. "
                "The floor restrains no wall out of its plane. `pushover` with shells considers seats."
            )
        around = plan.around(floor)
        rows = []
        for w, _, s in around:
            if (w, level) not in self.along:
                raise BadGeometry(f"floor on storey {level}: wall '{plan.walls[w].name}' has no masonry at the level of the floor")
            rows.append(self._vector(w, s, level))
        outline = plan.outline(around)
        area = signed_area(outline)
        if area < 0.0:
            outline, rows, area = outline[::-1], rows[::-1], -area
        bearing = plan.bearing(floor, around)
        if floor.load > 0.0:
            length = sum(abs(b - a) for _, a, b in bearing)
            for w, a, b in bearing:
                self._load(w, level, min(a, b), max(a, b), floor.weight * area * abs(b - a) / length)
        self._thrust(floor, around)
        if floor.kind == "none":
            return
        if floor.kind == "joists":
            across = plan.wall(floor.bears_on[0]).direction
            way = np.array([-across[1], across[0]])
            assert floor.young and floor.joist_area and floor.joist_spacing
            turn = np.array([way[0] ** 2, way[1] ** 2, way[0] * way[1]])  # strain along the joists of exx, eyy, gamma
            law = floor.young * floor.joist_area / floor.joist_spacing * np.outer(turn, turn)
        else:
            young, thickness = (RIGID_YOUNG, RIGID_THICKNESS) if floor.kind == "rigid" else (floor.young, floor.thickness)
            assert young and thickness
            nu = floor.poisson
            law = floor.flatness * young * thickness / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])
        _, triangles = fill_ring(outline, 10.0 * float(np.ptp(outline, axis=0).max()))
        for triangle in triangles:
            p = outline[triangle]
            double = float((p[1, 0] - p[0, 0]) * (p[2, 1] - p[0, 1]) - (p[2, 0] - p[0, 0]) * (p[1, 1] - p[0, 1]))
            strain = np.zeros((3, len(self.weight)))
            for k in range(3):
                by, bx = (p[k - 2, 1] - p[k - 1, 1]) / double, (p[k - 1, 0] - p[k - 2, 0]) / double
                own = rows[triangle[k]]
                strain += np.array([by * own[0], bx * own[1], bx * own[0] + by * own[1]])
            self.linear += 0.5 * double * strain.T @ law @ strain

    def _ground(self, stiffness: float) -> None:
        """Springs under the soles of the piers on the ground."""
        for strip in self.strips:
            if strip.kind == "pier" and strip.storey == 1:
                start, end = strip.masonry[:2]
                w, turn = self.nodes[strip.nodes[0]].freedoms
                own = stiffness * strip.thickness * (end - start)
                arm = 0.5 * (start + end) - self.nodes[strip.nodes[0]].s
                self.linear[w, w] += own
                self.linear[w, turn] += own * arm
                self.linear[turn, w] += own * arm
                self.linear[turn, turn] += own * (arm**2 + (end - start) ** 2 / 12.0)

    # Elements

    def _material(self, wall: PlanWall, storey: int) -> Material:
        name = self.plan.material_of(wall, storey)
        if name is None:
            return self.building.material
        if name not in self.building.materials:
            raise BadGeometry(f"wall '{wall.name}': the deck has no [materials.{name}]")
        return self.building.materials[name]

    def _element(self, strip: Strip) -> MacroElement:
        o, wall = self.options, self.plan.walls[strip.wall]
        material = self._material(wall, strip.storey)
        i, j = (self.nodes[k] for k in strip.nodes)
        u = tuple(self.along.get((strip.wall, node.level), -1) for node in (i, j))
        freedoms = (u[0], *i.freedoms, u[1], *j.freedoms)
        start, end, low, high = strip.part
        young = o.stiffness * material.young
        shear = young / (2.0 * (1.0 + material.poisson))
        cohesion = (o.cohesion or self.building.joints.cohesion) / o.confidence_factor
        tension = 1.5 * (o.diagonal_strength or 0.0) / o.confidence_factor
        strength = material.compressive_strength
        pressed = UNLIMITED if strength is None else BLOCK * strength / o.confidence_factor
        levels = self.plan.levels
        if strip.kind == "pier":
            s = 0.5 * (start + end)
            depth, length = end - start, high - low
            law = _law(o.shear, cohesion, tension)
            return MacroElement(
                freedoms,
                length,
                depth,
                strip.thickness,
                young,
                shear * depth * strip.thickness / ((1.0 if law == "damage" else SHEAR_FACTOR) * length),
                pressed,
                (s - i.s, low - float(levels[i.level]), s - j.s, high - float(levels[j.level])),
                shear=law,
                cohesion=cohesion,
                friction=o.friction,
                tension=tension,
                slenderness=float(np.clip(length / depth, 1.0, 1.5)),
                damage=(o.damage_compliance / shear, o.softening),
                drifts=(o.drift_flexure, o.drift_shear),
                sections=o.sections,
                second_order=o.second_order,
            )
        return self._beam(strip, freedoms, young, shear, cohesion, tension, pressed)

    def _beam(
        self,
        strip: Strip,
        freedoms: tuple[int, int, int, int, int, int],
        young: float,
        shear: float,
        cohesion: float,
        tension: float,
        pressed: float,
    ) -> MacroElement:
        """A spandrel or ring beam; ring beams stay elastic, uncracked."""
        o, wall = self.options, self.plan.walls[strip.wall]
        i, j = (self.nodes[k] for k in strip.nodes)
        start, end, low, high = strip.part
        z = 0.5 * (low + high) - float(self.plan.levels[i.level])
        depth, length = high - low, end - start
        drifts, residual, moment, by_shear = (UNLIMITED, UNLIMITED), 1.0, UNLIMITED, False
        if strip.kind == "ring beam":
            beam = self.plan.ring_beam_on(wall, strip.storey)
            assert beam is not None
            if beam.material not in self.building.materials:
                raise BadGeometry(
                    f"ring beam of storey {beam.storey}: the deck has no [materials.{beam.material}]", ("structure", "ring_beams")
                )
            material = self.building.materials[beam.material]
            young = material.young
            shear = young / (2.0 * (1.0 + material.poisson))
            moment = self._ring_moment(strip, pressed)
        else:
            if high > float(self.plan.levels[strip.storey]) - MEETS:  # the ring beam below the level lies within
                depth -= self.ring_depth(wall, strip.storey)
            tie = self._tie(strip)
            moment, by_shear = self._spandrel_strength(strip, depth, length, cohesion, tension, pressed, tie)
            held = any(x.lintel is not None for x in self.plan.openings_in(wall, strip.storey) if x.x[0] < end and x.x[1] > start)
            residual = o.spandrel_residual if o.spandrel_residual is not None else 0.6 if held else 0.1
            drifts = (o.spandrel_drift_tied if tie > 0.0 else o.spandrel_drift_flexure, o.spandrel_drift_shear)
        return MacroElement(
            freedoms,
            length,
            depth,
            strip.thickness,
            young,
            shear * depth * strip.thickness / (SHEAR_FACTOR * length),
            pressed,
            (start - i.s, z, end - j.s, z),
            pier=False,
            upright=False,
            moment=moment,
            by_shear=by_shear,
            drifts=drifts,
            kept=residual,
            second_order=False,
        )

    def _tie(self, strip: Strip) -> float:
        """Tension [N] that rods along the wall and ring beams can balance beside a spandrel; 0 without any."""
        plan, wall = self.plan, self.plan.walls[strip.wall]
        start, end, low, high = strip.part
        pull, beam = 0.0, plan.ring_beam_on(wall, strip.storey)
        if beam is not None and beam.reinforcement is not None:
            pull = beam.reinforcement.tension
        elif beam is not None:
            strength = self.building.materials[beam.material].tensile_strength if beam.material in self.building.materials else None
            pull = UNLIMITED if strength is None else strength * beam.depth * strip.thickness
        for k, strength in self.along_walls.get(strip.wall, []):
            rod = plan.rods[k]
            places = sorted(float((np.asarray(p[:2]) - wall.start) @ wall.direction) for p in (rod.start, rod.end))
            height = 0.5 * (rod.start[2] + rod.end[2])
            if places[0] <= start + MEETS and places[1] >= end - MEETS and low - BESIDE <= height <= high + BESIDE:
                pull += strength
                self.idle.discard(k)
        return pull

    def _ring_moment(self, strip: Strip, pressed: float) -> float:
        """Moment [N m] of the hinges of a ring beam, M_p (1 - H_p/T): the strut H_p of a spandrel beside it takes that part of the tension
        T of its bars. The chord of the domain of moments and axial forces is on the safe side."""
        wall = self.plan.walls[strip.wall]
        beam = self.plan.ring_beam_on(wall, strip.storey)
        if beam is None or beam.reinforcement is None:
            return UNLIMITED
        place = ("structure", "ring_beams", self.plan.ring_beams.index(beam))
        concrete = self.building.materials[beam.material].compressive_strength
        if concrete is None:
            raise BadGeometry(
                f"ring beam of storey {beam.storey}: its reinforcement requires `compressive_strength` in [materials.{beam.material}]",
                place,
            )
        axis = beam.reinforcement.relative_axis(beam.depth, strip.thickness, concrete)
        if axis > DEEPEST_AXIS:
            raise BadGeometry(
                f"ring beam of storey {beam.storey}, wall '{wall.name}': with a total of {10000.0 * beam.reinforcement.area:.3g} "
                f"cm^2 of bars, the neutral axis is at {axis:.2f} of the effective depth. Above {DEEPEST_AXIS:g}, the "
                "concrete crushes before the hinge rotates. Reduce reinforcement.area, or increase the depth or "
                "the `compressive_strength` of its material",
                place,
            )
        moment, tension = beam.reinforcement.plastic_moment(beam.depth, strip.thickness, concrete), beam.reinforcement.tension
        struts = [
            self._strut(one, one.part[3] - one.part[2], pressed, self._tie(one))
            for one in self.strips
            if (one.kind, one.wall, one.storey, one.nodes) == ("spandrel", strip.wall, strip.storey, strip.nodes)
        ]
        return moment * (1.0 - min(max(struts, default=0.0) / tension, 1.0))

    def _sideways(self, pressed: float) -> float:
        """f_h [Pa] for the strength of stress blocks."""
        o = self.options
        return o.horizontal_strength / o.confidence_factor if o.horizontal_strength else HORIZONTAL * pressed / BLOCK

    def _strut(self, strip: Strip, depth: float, pressed: float, tie: float) -> float:
        """Greatest strut H_p [N] in a spandrel beside a tie."""
        unlimited = pressed >= UNLIMITED and not self.options.horizontal_strength
        return strut_of(depth, strip.thickness, tie, UNLIMITED if unlimited else self._sideways(pressed))

    def _pressure(self, strip: Strip) -> float:
        """Half the mean pressure [Pa] under the loads above a spandrel on the piers beside it."""
        force = area = 0.0
        for node in (self.nodes[k] for k in strip.nodes):
            area += (node.end - node.start) * strip.thickness
            force += sum(self._on(strip.wall, level, node.start, node.end) for level in range(node.level, len(self.plan.levels)))
        return 0.5 * force / area

    def _on(self, w: int, level: int, start: float, end: float) -> float:
        """Vertical forces [N] on a part of a wall on a level."""
        return sum(
            force * max(0.0, min(b, end) - max(a, start)) / (b - a) for wall, at, a, b, force in self.placed if (wall, at) == (w, level)
        )

    def _spandrel_strength(
        self, strip: Strip, depth: float, length: float, cohesion: float, tension: float, pressed: float, tie: float
    ) -> tuple[float, bool]:
        """Moment of its hinges [N m], and whether shear limits it.

        Flexure: the greater of that with tension across the head joints, f_ft = min(f_t, f_v0 + mu sigma_y/phi), sigma_y half the
        pressure beside, and that of a strut against a tie. M = min(M_u, V l/2).
        """
        o = self.options
        sideways, strut = self._sideways(pressed), self._strut(strip, depth, pressed, tie)
        shear = shear_strength(depth, strip.thickness, length, cohesion, tension, strut)
        if not shear > 0.0:
            return 1e-3, False
        pulls = [cohesion + o.friction * self._pressure(strip) / o.interlocking] if cohesion > 0.0 else []
        flexure = flexural_strength(depth, strip.thickness, min([*pulls, tension] if tension > 0.0 else pulls), pressed)
        if strut > 0.0:
            flexure = max(flexure, strut_strength(depth, strip.thickness, strut, sideways))
        return (0.5 * shear * length, True) if 0.5 * shear * length < flexure else (flexure, False)

    # Corners and rods

    def _corners(self) -> list[Link]:
        """Vertical links where walls meet, on each level; strength by the shear of the section along which they hang together."""
        plan, o, links = self.plan, self.options, []
        for (a, b), (s, t) in self.junctions.items():
            one, two = plan.walls[a], plan.walls[b]
            bond = plan.bond(one.name, two.name)
            if o.flanges == "none" or (bond is not None and bond.bond in ("open", "joint")):
                continue
            for level in range(1, min(plan.reach(one)[1], plan.reach(two)[1]) + 1):
                p, q = self.nodes[self.node_at(a, level, s)], self.nodes[self.node_at(b, level, t)]
                if not (p.start - MEETS <= s <= p.end + MEETS and q.start - MEETS <= t <= q.end + MEETS):
                    x, y = np.asarray(one.start) + s * one.direction
                    self.remarks.append(
                        f"Walls '{one.name}' and '{two.name}' meet at ({x:.3g}, {y:.3g}) m in an opening, not in a pier, on level {level}: "
                        "no vertical force passes between them there."
                    )
                    continue
                tall = 0.5 * (plan.storeys[level - 1] + (plan.storeys[level] if level < len(plan.storeys) else 0.0))
                thin = min(plan.thickness_of(wall, level) for wall in (one, two))
                material = self._material(one, max(level, plan.reach(one)[0]))
                shear = o.stiffness * material.young / (2.0 * (1.0 + material.poisson))
                f = o.flange_strength or o.cohesion or self.building.joints.cohesion
                strength = f / o.confidence_factor * thin * tall
                if bond is not None:
                    strength *= bond.strength
                if not strength > 0.0:
                    continue
                strengths, returns = (strength, strength), False
                if o.flanges == "effective" and abs(float(one.direction @ two.direction)) < PARALLEL:
                    lifted = self._flange(b, a, level), self._flange(a, b, level)  # of one by two, of two by one
                    strengths, returns = (min(strength, lifted[0]), min(strength, lifted[1])), min(lifted) < strength
                parts = (1.0, s - p.s, -1.0, q.s - t)
                links.append(Link((*p.freedoms, *q.freedoms), parts, shear * tall, strengths, returns=returns))
        return links

    def _flange(self, web: int, wall: int, level: int) -> float:
        """Weight [N] on the effective width of a wall on a level as the flange of another."""
        plan = self.plan
        thickness, half = (plan.thickness_of(plan.walls[w], level) for w in (wall, web))
        start, end = effective_part(plan, self.junctions, web, wall, level, thickness, 0.5 * half)
        weight = self._on(wall, level, start, end)
        self.flanges.append(Flange(web, wall, level, start, end, weight))
        return weight

    def _rods(self) -> list[Link]:
        """Tie rods between two places on walls: they yield where their material has a strength, and carry no pressure."""
        links = []
        self.along_walls: dict[int, list[tuple[int, float]]] = {}  # wall: rods along it and their strengths
        self.idle: set[int] = set()  # rods that join nothing
        for k, rod in enumerate(self.plan.rods):
            ends = [np.asarray(rod.start), np.asarray(rod.end)]
            way = (ends[1] - ends[0])[:2]
            length = float(np.linalg.norm(ends[1] - ends[0]))
            if rod.material not in self.building.materials:
                raise BadGeometry(f"rod {k + 1}: the deck has no [materials.{rod.material}]", ("structure", "rods", k, "material"))
            steel = self.building.materials[rod.material]
            pull = UNLIMITED if steel.tensile_strength is None else rod.area * steel.tensile_strength
            for w in self._beside(rod, way / length):
                self.along_walls.setdefault(w, []).append((k, pull))
            row = np.zeros(len(self.weight))
            for sign, end in ((-1.0, ends[0]), (1.0, ends[1])):
                level = int(np.abs(self.plan.levels - end[2]).argmin())
                found = [
                    (float(np.linalg.norm(np.asarray(wall.start) + s * wall.direction - end[:2])), w, s)
                    for w, wall in enumerate(self.plan.walls)
                    if level <= self.plan.reach(wall)[1]
                    and (s := float(np.clip((end[:2] - wall.start) @ wall.direction, 0.0, wall.length))) is not None
                ]
                if not found or min(found)[0] > 0.5:
                    raise BadGeometry(
                        f"rod {k + 1}: the end at {', '.join(f'{v:g}' for v in end)} m is not on a wall", ("structure", "rods", k)
                    )
                _, w, s = min(found)
                if level:
                    row += sign * way / length @ self._vector(w, s, level)
            own = np.flatnonzero(np.abs(row) > 1e-12)
            if not len(own):
                self.idle.add(k)
                continue
            if len(own) > 8:
                raise BadGeometry(f"rod {k + 1}: expected ends at corners of walls", ("structure", "rods", k))
            links.append(Link(tuple(own.tolist()), tuple(row[own].tolist()), steel.young * rod.area / length, (0.0, pull), rod.prestress))
        return links

    def _beside(self, rod: Rod, way: np.ndarray) -> list[int]:
        """Walls that a rod in a direction on the plan runs along."""
        return [
            w
            for w, wall in enumerate(self.plan.walls)
            if abs(float(way @ wall.direction)) > PARALLEL
            and all(
                abs(float(np.array([-wall.direction[1], wall.direction[0]]) @ (np.asarray(p[:2]) - wall.start))) < BESIDE
                for p in (rod.start, rod.end)
            )
        ]


def _law(wanted: str, cohesion: float, tension: float) -> str:
    """The law of shear that the strengths allow."""
    if wanted in ("mohr-coulomb", "damage", "none"):
        return wanted
    if wanted == "least" and not tension > 0.0:
        return "mohr-coulomb"
    if not tension > 0.0:
        raise BadGeometry(f'shear = "{wanted}" requires `diagonal_strength`', ("analysis", "frame", "shear"))
    return "turnsek-cacovic" if wanted == "turnsek-cacovic" or not cohesion > 0.0 else wanted
