"""What a sequentially linear analysis is made of: laws, elements, freedoms, monitors, and what it records."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from extrados.core import lists

LAWS = lists.numbers("sla_law")
#: The freedoms of a node; in the plane it has the first two
DIRECTIONS = ("x", "y", "z", "rotation about x", "rotation about y", "rotation about z")
ELEMENTS = lists.numbers("sla_element")
CRACKING = lists.numbers("sla_cracking")
EVENTS = lists.words("sla_event")
THROUGH = lists.numbers("shell_through")
#: Name of an event -> its number
EVENT = {entry.name: entry.number for entry in lists.entries("sla_event")}
STOPS = lists.words("sla_stop")
#: Rows of a curve from this code on are steps of equilibrium iterations
FIRST_STEP = EVENT["newton"]


@dataclass(frozen=True)
class Softening:
    """How a material loses strength in one sense of stress.

    strength [Pa], energy [N/m] per crack area; `ripple` p is the half-width of the teeth over the strength;
    `exact` teeth carry the energy of the law exactly, else they are those of the ripple (Rots et al. 2008);
    without `overshoot` the first tooth ends at the strength itself.
    """

    strength: float
    energy: float
    law: str = "linear"
    ripple: float = 0.1
    exact: bool = True
    overshoot: bool = True

    def row(self, young: float, band: float) -> list[float]:
        """The line of the core's tooth tables."""
        return [LAWS[self.law], young, self.strength, self.energy, band, self.ripple, float(self.exact), float(self.overshoot)]


@dataclass(frozen=True)
class Monitor:
    """A displacement watched: a weighted sum over node (0-based), direction (0 x, 1 y) and share."""

    node: np.ndarray
    direction: np.ndarray
    share: np.ndarray

    @staticmethod
    def of(node: int, direction: int) -> "Monitor":
        """The displacement of one node in one direction."""
        return Monitor(np.array([node]), np.array([direction]), np.array([1.0]))


@dataclass(frozen=True)
class Stop:
    """When a run ends by itself: `load` carried, `displacement` of the first monitor, `fraction` of the peak
    load after it, compliance over the first (a mechanism). `refuse_overload`: the first state must carry A. `target` of
    the first monitor, met exactly, from below (`side` 1) or above (-1); `already`: loads like B that are on, over B;
    `far`: way of the first monitor beyond which displacements are no longer small [m]."""

    load: float = np.inf
    displacement: float = np.inf
    fraction: float = -1.0
    compliance: float = 1e6
    refuse_overload: bool = False
    target: float = 0.0
    side: int = 0
    already: float = 0.0
    far: float = np.inf


#: Least part of its strength that shear leaves a crack of bedded masonry (fortran/sla/plane_points.f90)
LEAST_SHARE = 0.2


@dataclass(frozen=True)
class Bedding:
    """Masonry in courses: the tension law is that across the bed joints, along them it is different.

    angle of the bed joints to x [rad]; strength, energy along them over those across them; shear factor
    sqrt(fx fy) / shear strength, at least 1 (Lourenco, de Borst and Rots 1997: the root of their alpha).
    """

    angle: float = 0.0
    strength: float = 1.0
    energy: float = 1.0
    shear: float = 1.0

    def __post_init__(self) -> None:
        if not (self.strength > 0.0 and self.energy > 0.0 and self.shear >= 1.0):
            raise ValueError("masonry with bed joints requires ratios above 0 and a shear factor of at least 1")

    def stretch(self) -> tuple[float, float]:
        """Least and greatest f^2 / G over all crack directions, over that across the bed joints: the bands whose teeth
        are those of these cracks, over their own."""
        a, b = self.strength - 1.0, self.energy - 1.0
        # q = nx^2 of a crack's normal in the axes of the joints: 0, 1, and where (1 + a q)^2 / (1 + b q) is extreme
        places = [0.0, 1.0, min(max((b - 2.0 * a) / (a * b), 0.0), 1.0) if a * b != 0.0 else 0.0]
        ratios = [(1.0 + a * q) ** 2 / (1.0 + b * q) for q in places]
        return min(ratios) * (LEAST_SHARE if self.shear > 1.0 else 1.0), max(ratios)


@dataclass(frozen=True)
class Hill:
    """Compressive strength of masonry in courses by Hill's criterion: the compression law is that across the bed joints.

    angle of the bed joints to x [rad]; ratio fx / fy of the strengths along and across them; coupling b and shear c of
    (sx/fx)^2 + b sx sy / (fx fy) + (sy/fy)^2 + c t^2 / (fx fy) = 1.
    """

    angle: float
    ratio: float
    coupling: float
    shear: float

    def __post_init__(self) -> None:
        if not (self.ratio > 0.0 and self.shear > 0.0 and abs(self.coupling) < 2.0):
            raise ValueError("Hill's criterion requires a ratio and a shear factor above 0, and a coupling between -2 and 2")


@dataclass(frozen=True)
class Plane:
    """Plane-stress elements of one kind, all arrays by element (or one value for all).

    connect (elements, nodes) 0-based; thickness [m], young [Pa], nu, band [m], `reach` (elements, 2) narrowest and
    widest tension band where it follows from the direction of the crack, None where it is `band`; tension and compression
    softening, one for all or a sequence by element, None where it stays linear; `lateral` compressive
    strength that reduces the tensile one (0 none); `confinement` growth of the compressive strength per lateral pressure; `axis` angle of the only crack normal allowed [rad], NaN
    where cracks choose theirs; `joint`: cracks there keep the shear stiffness, so that the joint opens but does not
    slide; `points` Gauss points of quadrilaterals; `selective`: shear by the middle; `bedding` one for all or a
    sequence by element, None where the strength is the same in all directions.
    """

    kind: str
    connect: np.ndarray
    thickness: float | np.ndarray
    young: float | np.ndarray
    nu: float | np.ndarray
    band: float | np.ndarray = 0.0
    tension: Softening | Sequence[Softening | None] | None = None
    compression: Softening | Sequence[Softening | None] | None = None
    lateral: float | np.ndarray = 0.0
    axis: float | np.ndarray = np.nan
    points: tuple[int, int] = (2, 2)
    selective: bool = False
    joint: bool = False
    reach: np.ndarray | None = None
    confinement: float | np.ndarray = 0.0
    bedding: Bedding | Sequence[Bedding | None] | None = None
    hill: Sequence[Hill | None] | None = None

    @property
    def points_each(self) -> int:
        """Integration points of an element."""
        return {"T3": 1, "T6": 3}.get(self.kind, self.points[0] * self.points[1])


@dataclass(frozen=True)
class Shells(Plane):
    """Flat shells of three or four nodes in space, fields as of Plane; angles are to the element's own x axis, which is
    horizontal.

    frames (nodes, 3, 3) columns: axes of the rotations of each node of the model; flat (nodes) True where all shells at
    a node lie in the plane across its third axis, whose rotation is then to be held. `layers` through the thickness at
    Gauss's or Lobatto's points; a group that does not bend is a membrane of one layer.
    """

    frames: np.ndarray = field(default_factory=lambda: np.empty((0, 3, 3)))
    flat: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=bool))
    layers: int = 5
    through: str = "lobatto"
    bends: bool = True

    @property
    def points_each(self) -> int:
        """Integration points of an element, those of one place through the thickness one after the other."""
        return {"T3": 3, "Q4": 4}[self.kind] * self.layers


@dataclass(frozen=True)
class Bars:
    """Bars: connect (bars, nodes) 0-based, area [m^2], young [Pa], band [m], softening as of Plane.

    Of two nodes, or of more whose displacements make the strain by `gradient` (bars, nodes, 2 or 3) [1/m], with the `length`
    (bars) [m]. bears: "both", "tension" or "compression" alone.
    """

    connect: np.ndarray
    area: float | np.ndarray
    young: float | np.ndarray
    band: float | np.ndarray = 0.0
    tension: Softening | Sequence[Softening | None] | None = None
    compression: Softening | Sequence[Softening | None] | None = None
    gradient: np.ndarray | None = None
    length: np.ndarray | None = None
    bears: str = "both"

    def strains(self, xy: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gradient (bars, nodes, 2) [1/m] and length (bars) [m] between nodes at xy (nodes, 2) [m]."""
        if self.gradient is not None and self.length is not None:
            return np.asarray(self.gradient, dtype=float), np.asarray(self.length, dtype=float)
        along = xy[self.connect[:, 1]] - xy[self.connect[:, 0]]
        length = np.hypot(*along.T) if along.shape[1] == 2 else np.linalg.norm(along, axis=1)
        with np.errstate(invalid="ignore", divide="ignore"):
            each = along / (length**2)[:, None]
        return np.stack([-each, each], axis=1), length


#: What a bar bears, as the core numbers it
BEARS = {"both": 0, "tension": 1, "compression": 2}


@dataclass(frozen=True)
class Joints:
    """Joints of no thickness that open, slide and crush; all arrays by element, or one value for all.

    connect (elements, 4) 0-based, along the lower side and back along the upper one; normal (elements, 2) unit vectors
    from the lower to the upper side; area (elements, 2) of its two points [m^2], 0 where a neighbour has it; normal and shear stiffness [Pa/m]; friction coefficient,
    NaN where nothing slides. tension, compression and cohesion soften as in Plane, their strain the jump [m] and their
    band 1 m; None where there is no limit, or no cohesion. `dry` True where nothing holds in tension; `small` stress
    [Pa] that counts as none; `ripple` half-width of the steps of friction over the friction.
    """

    connect: np.ndarray
    normal: np.ndarray
    area: np.ndarray
    normal_stiffness: float | np.ndarray
    shear_stiffness: float | np.ndarray
    friction: float | np.ndarray = np.nan
    tension: Softening | Sequence[Softening | None] | None = None
    compression: Softening | Sequence[Softening | None] | None = None
    cohesion: Softening | Sequence[Softening | None] | None = None
    dry: bool | np.ndarray = False
    small: float | np.ndarray = 1.0
    ripple: float = 0.02
    points_each = 2  # at the ends of each element
    reach = None

    @property
    def young(self) -> np.ndarray:
        """By element what the strain of its tooth tables, the opening, gives a stress with [Pa/m]."""
        return np.broadcast_to(np.asarray(self.normal_stiffness, dtype=float), (len(self.connect),))

    @property
    def band(self) -> np.ndarray:
        """1 m by element."""
        return np.ones(len(self.connect))


@dataclass(frozen=True)
class ShellJoints(Joints):
    """Joints between shells: an element is one layer of a stretch between two pairs of nodes with six freedoms.

    row (elements, 2, 3, 24): at each of its two points the vectors whose products with the displacements of its nodes are
    the jump across the joint, that along it in the plane of the wall, and that out of this plane. What goes out of the plane
    stays elastic. normal: within the plane of the wall, along and up.
    """

    row: np.ndarray = field(default_factory=lambda: np.empty((0, 2, 3, 24)))

    @staticmethod
    def rows(normal: np.ndarray, along: np.ndarray, out: np.ndarray, height: np.ndarray, frames: np.ndarray) -> np.ndarray:
        """The vectors (elements, 2, 3, 24). normal, along, out: (elements, 3) unit vectors across the joint, along it in the
        plane of the wall, and of the wall's normal; height (elements) of the layer over the middle [m]; frames (elements, 4,
        3, 3) axes of the rotations of its nodes, columns."""
        found = np.zeros((len(normal), 2, 3, 4, 6))
        for point, (lower, upper) in enumerate(((0, 3), (1, 2))):
            for k, way in enumerate((normal, along, out)):
                for node, sign in ((lower, -1.0), (upper, 1.0)):
                    found[:, point, k, node, :3] = sign * way
                    if k < 2:  # of a rotation w the layer goes by w x height out
                        turn = height[:, None] * np.cross(out, way)
                        found[:, point, k, node, 3:] = sign * np.einsum("ex,exr->er", turn, frames[:, node])
        return found.reshape(len(normal), 2, 3, 24)


@dataclass(frozen=True)
class Springs:
    """Linear springs between freedoms: node (springs, 2) 0-based, -1 the ground; direction 0 x, 1 y;
    stiffness [N/m]."""

    node: np.ndarray
    direction: np.ndarray
    stiffness: np.ndarray


#: A group of elements of one sort
Group = Plane | Bars | Joints | Springs


@dataclass(frozen=True)
class Behaviour:
    """Of cracked material: `cracking` orthotropic (fixed), rotating or isotropic; shear `retention` constant, None for thesis Eq. 4.11; `closure`
    with at most `most_changes` openings and closings of a crack; stiffness `floor` left after the last tooth; `extent`: crack bands of
    quadrilaterals are their extents across the crack."""

    cracking: str = "orthotropic"
    retention: float | None = None
    closure: bool = False
    most_changes: int = 10
    floor: float = 1e-6
    extent: bool = False


@dataclass
class Freedoms:
    """Which equation each freedom belongs to (-1 held) and its share of it, both (nodes, 2), of shells (nodes, 6) with
    the rotations; the last `moved` equations are those of supports whose displacements are given."""

    equation: np.ndarray
    factor: np.ndarray
    moved: int = 0

    @property
    def of_node(self) -> int:
        """Freedoms of a node."""
        return int(np.shape(self.equation)[1])

    @staticmethod
    def make(
        nodes: int, held: Iterable[tuple[int, int]] = (), ties: Sequence[Sequence[tuple[int, int, float]]] = (), of_node: int = 2
    ) -> "Freedoms":
        """held: (node, direction) pairs; ties: lists of (node, direction, factor) that move as one; `of_node` freedoms."""
        held = list(held)
        for node, direction, *_ in [*held, *(entry for tie in ties for entry in tie)]:
            if not (0 <= node < nodes and 0 <= direction < of_node):
                raise IndexError(
                    f"a degree of freedom has node {node} and direction {direction}, but there are {nodes} nodes with {of_node} directions"
                )
        equation = np.zeros((nodes, of_node), dtype=np.int64)
        factor = np.ones((nodes, of_node))
        for node, direction in held:
            equation[node, direction] = -1
        number = 0
        for tie in ties:
            for node, direction, share in tie:
                if equation[node, direction] != 0:
                    what = "held" if equation[node, direction] < 0 else "tied already"
                    raise ValueError(f"node {node + 1} cannot be tied in {DIRECTIONS[direction]}: it is {what}")
                equation[node, direction] = number + 1
                factor[node, direction] = share
            number += 1
        free = equation == 0
        equation[free] = number + 1 + np.arange(int(free.sum()))
        return Freedoms(np.where(equation < 0, -1, equation - 1), factor)


@dataclass
class Events:
    """What was recorded, one row per event; n_* before the damage of that event is done.

    load: multiplier; limit_t, limit_c: least upper and greatest lower limit; stored, external, lost (on the straight way
    from event to event) and crack (area of the teeth passed, never falls) energies [J]; compliance fB.uB (where supports move with lambda their stiffness
    instead); residual of the last guard check; scale of all loads, below 1 where they went down together; pull, the force
    that moves such supports [N].
    point (0-based), code (see EVENTS), equilibrium; monitors (events, monitors) [m].
    """

    load: np.ndarray
    limit_t: np.ndarray
    limit_c: np.ndarray
    stored: np.ndarray
    external: np.ndarray
    lost: np.ndarray
    crack: np.ndarray
    compliance: np.ndarray
    residual: np.ndarray
    scale: np.ndarray
    pull: np.ndarray
    point: np.ndarray
    code: np.ndarray
    number: np.ndarray
    equilibrium: np.ndarray
    monitors: np.ndarray
    reason: str = ""
    guard: tuple[int, int, int] = (0, 0, 0)
    interrupted: bool = False
    crack_total: float = 0.0  # with the last event applied [J]
    solutions: int = 0  # linear systems of equilibrium iterations
    released: float = 0.0  # energy lost as motion between their states [J]

    def __len__(self) -> int:
        return len(self.load)

    @property
    def ledger(self) -> tuple[float, float, float]:
        """Work of the loads, energy lost and area of the teeth at the last event [J]; 0 without events."""
        return tuple(float(e[-1]) if len(e) else 0.0 for e in (self.external, self.lost, self.crack))  # type: ignore[return-value]

    @property
    def steps(self) -> np.ndarray:
        """Which rows are steps of equilibrium iterations, not events (bool)."""
        return self.code >= FIRST_STEP

    @property
    def ledger_error(self) -> float:
        """Greatest imbalance of the energies over the greatest work."""
        if not len(self):
            return 0.0
        gap = self.external - self.stored - self.lost
        scale = np.maximum(np.abs(self.external), np.abs(self.stored)).max()
        return float(np.abs(gap).max() / scale) if scale > 0.0 else 0.0

    @staticmethod
    def none() -> "Events":
        """No events, one monitor."""
        columns = {name: np.zeros(0) for name in Events.__dataclass_fields__ if name not in ONCE}
        columns |= {name: np.zeros(0, dtype=int) for name in ("point", "code", "number")}
        return Events(**columns | {"equilibrium": np.zeros(0, dtype=bool), "monitors": np.zeros((0, 1))})

    @staticmethod
    def join(parts: Sequence["Events"]) -> "Events":
        """Batches one behind the other."""
        last = parts[-1]
        columns = {name: np.concatenate([getattr(p, name) for p in parts]) for name in Events.__dataclass_fields__ if name not in ONCE}
        return Events(
            **columns,
            reason=last.reason,
            guard=last.guard,
            interrupted=last.interrupted,
            crack_total=last.crack_total,
            solutions=last.solutions,
            released=last.released,
        )


#: What events have once, not each
ONCE = ("reason", "guard", "interrupted", "crack_total", "solutions", "released")
