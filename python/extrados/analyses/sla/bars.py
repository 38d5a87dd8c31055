"""Bars and ties of a wall made into groups of the core, and the forces in them."""

from dataclasses import dataclass

import numpy as np

from extrados.analyses.sla.tables import Sla
from extrados.core import sla as core
from extrados.core.sla import EVENT
from extrados.model.errors import BadGeometry
from extrados.model.properties import Material
from extrados.model.structures.walls import Bar
from extrados.model.ties import Tie
from extrados.views.mesh.mesh import Mesh
from extrados.views.mesh.rods import Corners, Rod, bonded

#: Rows of the damage of a bar: its tooth in tension and in pressure, from 1, and whether it is taut
TENSION, PRESSURE, TAUT = 3, 5, 7
#: Stiffness of a rigid tie over that of a square of wall, E t
RIGID = 100.0
#: Strain at which a tie of [[ties]] breaks, which says none: far beyond what a building bears. At least so many times
#: that at which it yields
LONG, LONGER = 0.2, 1e3


@dataclass(frozen=True)
class NamedBar:
    """A bar or tie of the deck: its group in the core, the number of its first piece among those of all bars, places of
    its pieces from its start (pieces) [m]."""

    name: str
    group: core.Bars
    first: int
    place: np.ndarray

    @property
    def held_at_ends(self) -> bool:
        """True where it is one piece, whose force is followed from event to event."""
        return len(self.group.connect) == 1

    def strain(self, xy: np.ndarray) -> core.Monitor:
        """The strain of its only piece as something to watch; nodes at xy (nodes, 2) [m]."""
        gradient, _ = self.group.strains(xy)
        node = np.asarray(self.group.connect)[0]
        return core.Monitor(np.repeat(node, 2), np.tile([0, 1], len(node)), gradient[0].ravel())

    def modulus(self, start: np.ndarray, code: np.ndarray, floor: float) -> np.ndarray:
        """Its modulus (events) [Pa] before each event: `start` its damage at first (11), code (events) what happened to
        it in each, 0 to another; `floor` is left over its first modulus after the last tooth, or where it is slack."""
        young = float(np.asarray(self.group.young))
        taut = np.full(len(code), start[TAUT] > 0.0)
        for k in np.flatnonzero(np.isin(code, [EVENT["open"], EVENT["close"]])).tolist():
            taut[k + 1 :] = code[k] == EVENT["close"]
        found = np.full(len(code), young)
        for law, row, kind in ((self.group.tension, TENSION, "tension"), (self.group.compression, PRESSURE, "compression")):
            if isinstance(law, core.Softening):
                passed = int(start[row]) - 1 + np.cumsum(code == EVENT[kind]) - (code == EVENT[kind])
                each = np.append(core.teeth(law, young, float(np.max(self.group.band)))[0], floor * young)
                found = np.minimum(found, each[np.minimum(passed, len(each) - 1)])
        return np.where(taut, found, floor * young)


def yielding(strength: float, young: float, ultimate: float, options: Sla) -> core.Softening:
    """A plateau at a strength [Pa] that ends at the strain `ultimate`; its energy is that of a band of 1 m."""
    return core.Softening(strength, strength * (ultimate - 0.5 * strength / young), "yielding", options.ripple)


def bar_group(
    mesh: Mesh, bar: Bar, tension: core.Softening | None, crushing: core.Softening | None, options: Sla
) -> tuple[core.Bars, np.ndarray]:
    """One of the bars of a wall, between nodes or embedded, and the places of its pieces from its start [m]; tension and
    crushing are those of its material."""
    material: Material = mesh.named[bar.material]
    what = f"a bar from {bar.start} to {bar.end}"
    if material.tensile_strength_parallel is not None:
        raise BadGeometry(
            f"`tensile_strength_parallel` of {bar.material!r} is only for masonry, and a bar has only one strength: remove this key"
        )
    rod = None
    if bar.bonded:
        rod = bonded(Corners.of(mesh), np.array([bar.start, bar.end], dtype=float), what)
        connect, length = rod.connect, rod.length
    else:
        ends = [int(np.hypot(*(mesh.xy - at).T).argmin()) for at in (bar.start, bar.end)]
        if ends[0] == ends[1]:
            raise BadGeometry(f"{what} begins and ends at the same node")
        connect, length = np.array([ends]), np.array([float(np.hypot(*(mesh.xy[ends[1]] - mesh.xy[ends[0]])))])
    band: float | np.ndarray = options.crack_band or length
    if bar.yield_strength is not None:
        if not bar.ultimate_strain > bar.yield_strength / material.young:
            raise BadGeometry(
                f"{what}: `ultimate_strain` {bar.ultimate_strain:g} is below the yield strain, {bar.yield_strength / material.young:g}"
            )
        band = 1.0
        tension = crushing = yielding(bar.yield_strength, material.young, bar.ultimate_strain, options)
    group = core.Bars(connect, bar.area, material.young, band, tension, crushing, *((None, None) if rod is None else _shape(rod)))
    return group, 0.5 * length if rod is None else rod.place


def tie_group(mesh: Mesh, tie: Tie, rod: Rod, options: Sla) -> core.Bars:
    """One of [[ties]]: a bar of 1 m^2, so that its stress is its force."""
    if tie.prestress:
        raise BadGeometry(
            f"{tie.name}: this analysis does not include prestress. Add the two forces of the prestress to the constant loads"
        )
    length = float(rod.length[0])
    thickness = max(float(group.thickness.max()) for group in mesh.groups if group.joint is None)
    young = (tie.stiffness or RIGID * mesh.materials[0].young * thickness) * length
    law = None
    if tie.yield_force is not None:
        law = yielding(tie.yield_force, young, max(LONG, LONGER * tie.yield_force / young), options)
    return core.Bars(
        rod.connect, 1.0, young, 1.0, law if tie.most > 0.0 else None, law if tie.least < 0.0 else None, *_shape(rod), tie.works_in
    )


def _shape(rod: Rod) -> tuple[np.ndarray, np.ndarray]:
    return rod.gradient, rod.length
