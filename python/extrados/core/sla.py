"""Sequentially linear analysis in the core (fortran/sla, c/sparse): teeth, models, batches of events."""

import os
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from extrados import _core
from extrados.core.calls import integers, long_call, real
from extrados.core.errors import check, status_code

LAWS = {"linear": 1, "exponential": 2, "hordijk": 3}
ELEMENTS = {"T3": 3, "T6": 6, "Q4": 4, "Q8": 8}
EVENTS = {
    1: "tension n", 2: "tension s", 3: "compression n", 4: "compression s",
    5: "closing n", 6: "closing s", 7: "opening n", 8: "opening s",
}  # fmt: skip
STOPS = {
    0: "", 1: "mechanism", 2: "no point limits the load", 3: "all intervals are empty",
    4: "target displacement", 5: "target load", 6: "load fell below the fraction of its peak",
}  # fmt: skip
REPORT = (
    "strain_n", "strain_s", "strain_ns", "stress_n", "stress_s", "stress_ns", "cos", "sin", "ratio_n", "ratio_s",
    "tooth_n", "tooth_s", "lambda_lo", "lambda_hi", "volume", "crush_n", "crush_s", "shut",
)  # fmt: skip
MOST_TEETH = 4096


class Mechanism(ValueError):
    """The structure is free to move; node (0-based) and direction name where."""

    def __init__(self, node: int, direction: str, ratio: float):
        super().__init__(f"node {node + 1} is free to move in {direction}")
        self.node, self.direction, self.ratio = node, direction, ratio


class BadElement(ValueError):
    """An element is inverted or has no area; its 0-based number."""

    def __init__(self, element: int, what: str):
        super().__init__(f"{what} {element + 1} is inverted or has no size")
        self.element = element


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
        return [
            LAWS[self.law], young, self.strength, self.energy, band, self.ripple, float(self.exact),
            float(self.overshoot),
        ]  # fmt: skip


def teeth(softening: Softening, young: float, band: float) -> tuple[np.ndarray, np.ndarray]:
    """Secant moduli [Pa] and peak stresses [Pa] of the teeth of a crack band `band` [m] wide."""
    s = softening
    n, modulus, strength, status = _core.api_sla.teeth(
        LAWS[s.law], young, s.strength, s.energy, band, s.ripple, int(s.exact), int(s.overshoot), MOST_TEETH
    )
    check(status, f"teeth of a {s.law} law, band {band:g} m (largest {largest_band(s, young):g} m)")
    return modulus[:n].copy(), strength[:n].copy()


def largest_band(softening: Softening, young: float) -> float:
    """The crack band width beyond which the law snaps back [m]."""
    return _core.api_sla.band(LAWS[softening.law], young, softening.strength, softening.energy)


def intervals(alpha: float, beta: float, a, b) -> tuple[np.ndarray, np.ndarray]:
    """Multipliers lo, hi (n) that keep r <= alpha - beta m under stresses a + lambda b, both (n, 3)."""
    a = real("a", np.transpose(a), (3, None))
    return _core.api_sla.intervals(alpha, beta, a, real("b", np.transpose(b), (3, a.shape[1])))


def body_force(kind: str, points: tuple[int, int], xy, connect, density) -> np.ndarray:
    """Consistent nodal forces (nodes, 2) [N] of a force per wall area (elements, 2) [N/m^2]."""
    connect = np.asfortranarray(np.asarray(connect).T + 1, dtype=np.int32)
    force, bad, status = _core.api_sla.body_force(
        ELEMENTS[kind], *points, real("xy", np.transpose(xy), (2, None)), connect,
        real("density", np.transpose(density), (2, connect.shape[1])),
    )  # fmt: skip
    if bad:
        raise BadElement(bad - 1, "element")
    check(status, "body force")
    return force.T.copy()


def memory_limit() -> int:
    """Bytes a factor may take: 60 % of the machine's memory."""
    try:
        return int(0.6 * os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (ValueError, OSError):  # not every system says
        return 4 << 30


@dataclass
class Events:
    """What was recorded, one row per event; n_* before the damage of that event is done.

    load: multiplier; limit_t, limit_c: least upper and greatest lower limit; stored, external, dissipated
    (path), crack (area of the teeth) energies [J]; compliance fB.uB; residual of the last guard check.
    point (0-based), code (see EVENTS), equilibrium; monitors (events, monitors) [m].
    """

    load: np.ndarray
    limit_t: np.ndarray
    limit_c: np.ndarray
    stored: np.ndarray
    external: np.ndarray
    dissipated: np.ndarray
    crack: np.ndarray
    compliance: np.ndarray
    residual: np.ndarray
    point: np.ndarray
    code: np.ndarray
    number: np.ndarray
    equilibrium: np.ndarray
    monitors: np.ndarray
    reason: str = ""
    guard: tuple[int, int, int] = (0, 0, 0)
    interrupted: bool = False
    crack_total: float = 0.0  # with the last event applied [J]

    def __len__(self) -> int:
        return len(self.load)

    @property
    def ledger_error(self) -> float:
        """Greatest imbalance of the energies over the greatest work."""
        if not len(self):
            return 0.0
        gap = self.external - self.stored - self.dissipated
        scale = np.maximum(np.abs(self.external), np.abs(self.stored)).max()
        return float(np.abs(gap).max() / scale) if scale > 0.0 else 0.0

    @staticmethod
    def join(parts: Sequence["Events"]) -> "Events":
        """Batches one behind the other."""
        last = parts[-1]
        columns = {
            name: np.concatenate([getattr(p, name) for p in parts])
            for name in Events.__dataclass_fields__
            if name not in ("reason", "guard", "interrupted", "crack_total")
        }
        return Events(
            **columns, reason=last.reason, guard=last.guard, interrupted=last.interrupted, crack_total=last.crack_total
        )


@dataclass(frozen=True)
class Monitor:
    """A displacement watched: a weighted sum over node (0-based), direction (0 x, 1 y) and share."""

    node: np.ndarray
    direction: np.ndarray
    share: np.ndarray

    @staticmethod
    def of(node: int, direction: int) -> "Monitor":
        return Monitor(np.array([node]), np.array([direction]), np.array([1.0]))


@dataclass(frozen=True)
class Stop:
    """When a run ends by itself: `load` carried, `displacement` of the first monitor, `fraction` of the peak
    load after it, compliance over the first (a mechanism). `refuse_overload`: the first state must carry A."""

    load: float = np.inf
    displacement: float = np.inf
    fraction: float = -1.0
    compliance: float = 1e6
    refuse_overload: bool = False


@dataclass(frozen=True)
class Plane:
    """Plane-stress elements of one kind, all arrays by element (or one value for all).

    connect (elements, nodes) 0-based; thickness [m], young [Pa], nu, band [m]; tension and compression
    softening, one for all or a sequence by element, None where it stays linear; `lateral` compressive
    strength that reduces the tensile one (0 none); `axis` angle of the only crack normal allowed [rad], NaN
    where cracks choose theirs; `points` Gauss points of quadrilaterals; `selective`: shear by the middle.
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


@dataclass(frozen=True)
class Bars:
    """Bars of two nodes: connect (bars, 2) 0-based, area [m^2], young [Pa], band [m], softening as of Plane."""

    connect: np.ndarray
    area: float | np.ndarray
    young: float | np.ndarray
    band: float | np.ndarray = 0.0
    tension: Softening | Sequence[Softening | None] | None = None
    compression: Softening | Sequence[Softening | None] | None = None


@dataclass(frozen=True)
class Springs:
    """Linear springs between freedoms: node (springs, 2) 0-based, -1 the ground; direction 0 x, 1 y;
    stiffness [N/m]."""

    node: np.ndarray
    direction: np.ndarray
    stiffness: np.ndarray


@dataclass(frozen=True)
class Behaviour:
    """Of cracked material: `isotropic` damage; shear `retention` constant, None for thesis Eq. 4.11; `closure`
    with at most `most_changes` openings and closings of a crack; stiffness `floor` left after the last tooth."""

    isotropic: bool = False
    retention: float | None = None
    closure: bool = False
    most_changes: int = 10
    floor: float = 1e-6


@dataclass
class Freedoms:
    """Which equation each freedom (nodes, 2) belongs to (-1 held) and its share of it."""

    equation: np.ndarray
    factor: np.ndarray

    @staticmethod
    def make(nodes: int, held=(), ties: Sequence[Sequence[tuple[int, int, float]]] = ()) -> "Freedoms":
        """held: (node, direction) pairs; ties: lists of (node, direction, factor) that move as one."""
        equation = np.zeros((nodes, 2), dtype=np.int64)
        factor = np.ones((nodes, 2))
        for node, direction in held:
            equation[node, direction] = -1
        number = 0
        for tie in ties:
            for node, direction, share in tie:
                if equation[node, direction] != 0:
                    what = "held" if equation[node, direction] < 0 else "tied already"
                    raise ValueError(f"node {node + 1} cannot be tied in {'xy'[direction]}: it is {what}")
                equation[node, direction] = number + 1
                factor[node, direction] = share
            number += 1
        free = equation == 0
        equation[free] = number + 1 + np.arange(int(free.sum()))
        return Freedoms(np.where(equation < 0, -1, equation - 1), factor)


class Model:
    """A model in the core; close it, or use it in a `with`.

    xy (nodes, 2) [m]. `algorithm` "update" changes the factor at each event, "refactor" makes it anew.
    """

    def __init__(
        self,
        xy,
        freedoms: Freedoms,
        groups: Sequence[Plane | Bars | Springs],
        behaviour: Behaviour | None = None,
        *,
        algorithm: str = "update",
        ordering: str | None = None,
        threads: int = 1,
        memory: int | None = None,
    ):
        behaviour = behaviour or Behaviour()
        self.nodes = len(xy)
        self._handle = 0
        self.behaviour = behaviour
        self.plane_points: list[tuple[Plane, int, int]] = []  # group, first point, points per element
        retention = -1.0 if behaviour.retention is None else float(behaviour.retention)
        handle, status = _core.api_sla.create(
            real("xy", np.transpose(xy), (2, self.nodes)),
            np.asfortranarray(freedoms.equation.T + 1, dtype=np.int32),
            real("factor", freedoms.factor.T, (2, self.nodes)),
            int(behaviour.isotropic), retention, int(behaviour.closure), int(behaviour.most_changes),
            float(behaviour.floor),
        )  # fmt: skip
        self._handle = int(handle)
        try:
            check(status, "model")
            for group in groups:
                self._add(group)
            if algorithm not in ("update", "refactor"):
                raise ValueError(f"algorithm is {algorithm!r}, expected 'update' or 'refactor'")
            equations = int(freedoms.equation.max()) + 1
            metis = equations > 3000 if ordering is None else ordering == "metis"
            limit = memory_limit() if memory is None else memory
            sizes, status = long_call(
                _core.api_sla.prepare, self._handle, int(metis), limit // 8, int(algorithm == "refactor"), int(threads)
            )
            self.equations, self.points, self.nonzeros, self.factor_values = (int(x) for x in sizes)
            if status == status_code("too_large"):
                raise MemoryError(
                    f"{self.equations} equations need {self.factor_values * 8 / 2**30:.1f} GiB for the factor, "
                    f"{limit / 2**30:.1f} GiB are allowed: use larger elements"
                )
            check(status, "analysis of the stiffness matrix")
            self.factorise()
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> "Model":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def close(self) -> None:
        """Give the memory back."""
        if self._handle:
            _core.api_sla.free(self._handle)
            self._handle = 0

    @staticmethod
    def _tables(count: int, young, band, *laws) -> tuple[np.ndarray, list[np.ndarray]]:
        """Distinct rows of tooth tables (8, rows) and, for each law, the row of each element (1-based, 0 none)."""
        found: dict[tuple, int] = {}
        numbers = []
        for law in laws:
            each = [law] * count if law is None or isinstance(law, Softening) else law
            number = np.zeros(count, dtype=np.int32)
            for k, softening in enumerate(each):
                if softening is not None:
                    key = tuple(softening.row(float(young[k]), float(band[k])))
                    number[k] = found.setdefault(key, len(found) + 1)
            numbers.append(number)
        rows = np.array(list(found), dtype=float).reshape(-1, 8)
        if not len(rows):
            rows = np.array([[1, 1e9, 1e6, 1e2, 1e-3, 0.5, 1, 1]], dtype=float)  # f2py wants one row; none refers to it
        return np.asfortranarray(rows.T), numbers

    def _add(self, group: Plane | Bars | Springs) -> None:
        if isinstance(group, Springs):
            count = len(group.stiffness)
            status = _core.api_sla.add_springs(
                self._handle,
                np.asfortranarray(np.asarray(group.node).T + 1, dtype=np.int32),
                np.asfortranarray(np.asarray(group.direction).T + 1, dtype=np.int32),
                real("stiffness", group.stiffness, (count,)),
            )
            check(status, "springs")
            return
        connect = np.asarray(group.connect)
        count = len(connect)

        def each(name: str, value) -> np.ndarray:
            return real(name, np.broadcast_to(np.asarray(value, dtype=float), count).copy(), (count,))

        young, band = each("young", group.young), each("band", group.band)
        rows, (table, crush) = self._tables(count, young, band, group.tension, group.compression)
        one_based = np.asfortranarray(connect.T + 1, dtype=np.int32)
        if isinstance(group, Bars):
            bad, bad_row, status = _core.api_sla.add_bars(
                self._handle, one_based, each("area", group.area), young, table, crush, rows
            )
            what = "bar"
        else:
            axis = np.broadcast_to(np.asarray(group.axis, dtype=float), count)
            given = np.isfinite(axis)
            bad, bad_row, status = _core.api_sla.add_plane(
                self._handle, ELEMENTS[group.kind], *group.points, int(group.selective), one_based,
                each("thickness", group.thickness), young, each("nu", group.nu), table, crush,
                each("lateral", group.lateral), given.astype(np.int32), np.where(given, axis, 0.0), rows,
            )  # fmt: skip
            what = "element"
            per = {"T3": 1, "T6": 3}.get(group.kind, group.points[0] * group.points[1])
            first = sum(len(g.connect) * n for g, _, n in self.plane_points)
            self.plane_points.append((group, first, per))
        if bad:
            raise BadElement(int(bad) - 1, what)
        if bad_row:
            row = rows[:, bad_row - 1]
            law = next(name for name, number in LAWS.items() if number == int(row[0]))
            softening = Softening(row[2], row[3], law)
            check(
                status,
                f"teeth of a {law} law with E {row[1]:g} Pa, strength {row[2]:g} Pa, energy {row[3]:g} N/m: "
                f"band {row[4]:g} m, the largest is {largest_band(softening, row[1]):g} m",
            )
        check(status, f"{what}s")

    def factorise(self) -> float:
        """Factor of the present damage; returns the smallest over the largest pivot."""
        node, direction, ratio, status = long_call(_core.api_sla.factorise, self._handle)
        if status == status_code("not_positive_definite"):
            raise Mechanism(int(node) - 1, "xy"[max(int(direction) - 1, 0)], float(ratio))
        check(status, "factor of the stiffness matrix")
        return float(ratio)

    def loads(self, constant, reference, *, carried: bool = False, events: int = 0, ledger=(0.0, 0.0, 0.0)) -> None:
        """Start a stage under nodal forces (nodes, 2) [N]: constant + lambda reference."""
        status = long_call(
            _core.api_sla.loads,
            self._handle,
            real("constant", np.transpose(constant), (2, self.nodes)),
            real("reference", np.transpose(reference), (2, self.nodes)),
            int(carried),
            int(events),
            real("ledger", ledger, (3,)),
        )
        check(status, "loads")

    def run(self, room: int, monitors: Sequence[Monitor], stop: Stop | None = None) -> Events:
        """Up to `room` events; the last one recorded is chosen but not applied until the next call."""
        stop = stop or Stop()
        first = np.cumsum([1] + [len(m.node) for m in monitors]).astype(np.int32)
        huge = np.finfo(float).max
        count, reals, ints, watched, guard, cracked, reason, status = long_call(
            _core.api_sla.run, self._handle, int(room), min(stop.load, huge), min(stop.displacement, huge),
            float(stop.fraction), float(stop.compliance), int(stop.refuse_overload), first,
            integers("node", np.concatenate([m.node for m in monitors])) + np.int32(1),
            integers("direction", np.concatenate([m.direction for m in monitors])) + np.int32(1),
            real("share", np.concatenate([m.share for m in monitors]), (None,)),
        )  # fmt: skip
        interrupted = status == status_code("cancelled")
        if not interrupted:
            check(status, "events")
        reals, ints = reals[:, :count].copy(), ints[:, :count]
        return Events(
            *reals, ints[0] - 1, ints[1].copy(), ints[2].copy(), ints[3].astype(bool), watched[:, :count].T.copy(),
            STOPS[int(reason)], tuple(int(g) for g in guard), interrupted, float(cracked),
        )  # fmt: skip

    def displacement(self, load: float) -> np.ndarray:
        """Displacements (nodes, 2) [m] under constant + load * reference."""
        ua, ub = _core.api_sla.displacement(self._handle, self.nodes)
        return (ua + load * ub).T.copy()

    def residual(self) -> float:
        """Greater norm of the residual forces of the two displacements over that of their load, measured now."""
        return float(long_call(_core.api_sla.measure, self._handle))

    def report(self, load: float) -> dict[str, np.ndarray]:
        """State of all points at a multiplier, columns as in REPORT."""
        values = _core.api_sla.report(self._handle, float(load), self.points)
        return dict(zip(REPORT, values.copy(), strict=True))

    def damage(self) -> np.ndarray:
        """The damage of all points (11, points), to be kept or set again."""
        return _core.api_sla.damage(self._handle, 1, np.zeros((11, self.points), order="F"))

    def set_damage(self, damage: np.ndarray) -> None:
        """Go on from a stored damage: the factor is made anew."""
        _core.api_sla.damage(self._handle, 0, real("damage", damage, (11, self.points)))
        self.factorise()

    def standing(self) -> np.ndarray:
        """Where the loop stands between two calls of `run`, beside loads and damage."""
        return _core.api_sla.standing(self._handle).copy()

    def renew(self, damage: np.ndarray, standing: np.ndarray) -> None:
        """Go on from a damage and where the loop stood, under the loads of the stage, with a new factor.

        Whoever goes on from the same two gets the same bits, after whatever history. Raises Mechanism.
        """
        self.set_damage(damage)
        check(long_call(_core.api_sla.resume, self._handle, real("standing", standing, (27,))), "displacements")
