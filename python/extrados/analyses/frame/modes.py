"""frame-modes: vibration of a frame of macro-elements about its equilibrium under the weight."""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from extrados.analyses.context import Context, Refused
from extrados.analyses.frame.drawn import drawn_arrays
from extrados.analyses.frame.tables import FrameModes
from extrados.core.errors import CoreError
from extrados.core.frame import Frame, Rest
from extrados.results import frame as out
from extrados.results.model import Array, Result
from extrados.views.frame.frame import EquivalentFrame


@dataclass(frozen=True)
class Mode:
    """A shape (n), its frequency [Hz], participation factors of a unit motion along x and y, and modal mass [kg]."""

    shape: np.ndarray
    frequency: float
    participation: np.ndarray
    mass: float

    def participating(self, way: np.ndarray) -> float:
        """Mass [kg] that takes part in a motion along a direction on the plan."""
        return float(way @ self.participation) ** 2 * self.mass


def way_of(degrees: float) -> np.ndarray:
    """Unit vector (2) of a direction on the plan [deg]."""
    angle = np.radians(degrees)
    return np.round(np.array([np.cos(angle), np.sin(angle)]), 15)


class NoEquilibrium(Refused):
    """A frame that does not carry its weight."""


def rest_of(frame: EquivalentFrame, core: Frame) -> Rest:
    """Equilibrium under the weight; NoEquilibrium without one."""
    try:
        return core.at_rest()
    except CoreError as error:
        raise NoEquilibrium(
            f"the frame has no equilibrium under its own weight ({error}): a pier carries no load, or a wall is not connected to others",
            ("structure", "walls"),
        ) from None


def modes_of(frame: EquivalentFrame, tangent: np.ndarray, count: int) -> list[Mode]:
    """Modes of lowest frequency; freedoms without mass are condensed.

    K is symmetric: under the weight alone nothing slides.
    """
    mass = frame.mass
    moving = np.flatnonzero(np.diag(mass) > 0.0)
    still = np.setdiff1d(np.arange(len(mass)), moving)
    k = 0.5 * (tangent + tangent.T)
    follow = -np.linalg.solve(k[np.ix_(still, still)], k[np.ix_(still, moving)])
    own = k[np.ix_(moving, moving)] + k[np.ix_(moving, still)] @ follow
    values, vectors = eigh(own, mass[np.ix_(moving, moving)])
    units = [frame.unit(np.array(d)) for d in ((1.0, 0.0), (0.0, 1.0))]
    found = []
    for value, vector in zip(values[:count], vectors.T[:count], strict=True):
        shape = np.zeros(len(mass))
        shape[moving], shape[still] = vector, follow @ vector
        load = np.array([unit @ mass @ shape for unit in units])
        modal = float(shape @ mass @ shape)
        found.append(Mode(shape, float(np.sqrt(max(value, 0.0)) / (2 * np.pi)), load / modal, modal))
    return found


def _drawn(frame: EquivalentFrame, modes: list[Mode]) -> dict[str, Array]:
    """Arrays of the figure: the walls on the plan, and the displacements of their ends and corners."""
    moved = np.array([[one.rows @ m.shape for one in frame.traces] for m in modes])
    moved /= np.abs(moved).max(axis=(1, 2), keepdims=True)
    drawn = drawn_arrays(frame)
    return {
        **{name: drawn[name] for name in ("wall_line", "wall_thickness", "storey_height")},
        "trace_place": Array(np.array([t.place for t in frame.traces]), ("trace", "axis"), "m", "ends and corners of the walls, in plan"),
        "trace_of": Array(
            np.array([(t.wall, t.level) for t in frame.traces]), ("trace", "part"), "", "number of the wall from 0, and level of each place"
        ),
        "trace_shape": Array(
            moved, ("mode", "trace", "direction"), "", "displacements of these places along x and y; the greatest of each mode is 1"
        ),
    }


def run(context: Context, options: FrameModes) -> Result:
    """The modes of lowest frequency."""
    result = Result("frame-modes")
    frame = context.building.frame(options.frame)
    context.warnings += frame.remarks
    with frame.core() as core:
        modes = modes_of(frame, rest_of(frame, core).tangent, options.modes)
    total = sum(one.mass for one in frame.masses)
    rows = [
        out.FrameMode(
            frequency_Hz=m.frequency,
            period_s=1.0 / m.frequency,
            mass_ratio_x=m.participating(np.array([1.0, 0.0])) / total,
            mass_ratio_y=m.participating(np.array([0.0, 1.0])) / total,
        )
        for m in modes
    ]
    result.results = out.FrameModes(
        modes=rows,
        moving_mass_kg=total,
        weight_N=frame.total_weight,
        piers=frame.piers,
        spandrels=frame.spandrels,
        walls=[wall.name for wall in frame.plan.walls],
    )
    shapes = np.array([[one.rows @ (m.shape / np.abs(m.shape).max()) for one in frame.masses] for m in modes])
    result.arrays["place"] = Array(np.array([one.place for one in frame.masses]), ("mass", "xyz"), "m", "places of the masses")
    result.arrays["shape"] = Array(shapes, ("mode", "mass", "direction"), "", "displacements of the masses along x and y")
    result.arrays |= _drawn(frame, modes)
    first = rows[0]
    result.answer = (
        f"First period {first['period_s']:.3g} s. The participating mass of this mode is "
        f"{100 * first['mass_ratio_x']:.1f} % along x and {100 * first['mass_ratio_y']:.1f} % along y. The stiffness of "
        f"the masonry is {options.frame.stiffness:.3g} of its elastic value."
    )
    return result
