"""Coulomb's limit of the base shear: where a pushed building slides as a whole, on a bed joint or at the base of a storey.

Joints between shells slide along their walls and not across them, and where there is none nothing slides: that a level
carries a shear is checked here apart, by the friction of all that stands above it and the cohesion of all walls in it.
"""

from dataclasses import dataclass

import numpy as np

from extrados.analyses.shell.model import ShellModel
from extrados.analyses.shell.tables import Pushover
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building
from extrados.views.shell.mesh import nodal_areas

#: Heights that are the same [m]; of the area of the walls in a level: bed joints that have so much of it cut all of them
SAME, ALL = 1e-6, 0.999


@dataclass(frozen=True)
class SlidingLimit:
    """A level on which all above may slide: its name and height [m], weight and prestress on it [N], area of its walls
    [m^2], resistance to sliding [N], and what of the base shear acts above it."""

    level: str
    height_m: float
    normal_N: float
    area_m2: float
    resistance_N: float
    shear_share: float

    @property
    def base_shear_N(self) -> float:
        """Base shear under which the level slides [N]."""
        return self.resistance_N / self.shear_share


def sliding_limits(model: ShellModel, building: Building, options: Pushover, under: dict[str, np.ndarray]) -> list[SlidingLimit]:
    """The bases of all storeys, and all heights at which bed joints cut all walls; none of a vault without walls, and none
    of a level whose friction excludes sliding. At the base of a storey walls without a bed joint resist by the friction and
    cohesion of [joints]. under: report of all points under the constant loads (core.sla.REPORT)."""
    mesh = model.mesh
    if not mesh.walls or model.driven:
        return []
    beds: dict[float, list[tuple[str, float, float, float, float]]] = {}  # name, friction, cohesion, area, normal force
    for joint, points in model.joints():
        if abs(joint.normal[0, 2]) > 0.5 and not joint.floor:
            force = -float((under["stress_n"][points] * under["volume"][points]).sum())
            z = round(float(mesh.xyz[joint.connect[0, 0], 2]), 6)
            of = (joint.strength["friction"], joint.strength["cohesion"], float(joint.length @ joint.thickness), force)
            beds.setdefault(z, []).append((joint.name, *of))
    found = []
    for storey, z in enumerate(mesh.levels[:-1].tolist(), 1):
        cut = [one for bed, of in beds.items() if abs(z - bed) < SAME for one in of]
        friction, area, normal = building.joints.coefficient, _area(model, z), _normal(model, z)
        jointed = sum(one[3] for one in cut)
        if jointed < ALL * area and friction is not None and not any(np.isnan(one[1]) for one in cut):
            rest = max(normal - sum(max(one[4], 0.0) for one in cut), 0.0)
            resistance = _coulomb(cut) + friction * rest + building.joints.cohesion * (area - jointed)
            found.append((f"the base of storey {storey}", z, normal, area, resistance))
    for z, cut in beds.items():
        area = sum(one[3] for one in cut)
        if area >= ALL * _area(model, z) and not any(np.isnan(one[1]) for one in cut):
            names = list(dict.fromkeys(one[0] for one in cut))
            resistance = _coulomb(cut)
            title = f"bed joint{'s' if len(names) > 1 else ''} {', '.join(names)}"
            found.append((title, z, sum(one[4] for one in cut), area, resistance))
    rows = [SlidingLimit(*one, _share(model, options, one[1])) for one in found]
    return [row for row in rows if row.shear_share > 0.0]


def _coulomb(cut: list[tuple[str, float, float, float, float]]) -> float:
    """Resistance to sliding [N] of bed joints, each by its friction, cohesion, area and normal force."""
    return sum(friction * max(force, 0.0) + cohesion * area for _, friction, cohesion, area, force in cut)


def _area(model: ShellModel, z: float) -> float:
    """Area of the walls on a level [m^2]: the lower edges of their elements there."""
    total = 0.0
    for part in model.mesh.parts:
        if part.wall < 0:
            continue
        corner = model.mesh.xyz[part.connect]
        lowest = np.abs(corner[..., 2].min(axis=1) - z) < SAME
        other = np.roll(corner, -1, axis=1)
        edge = (np.abs(corner[..., 2] - z) < SAME) & (np.abs(other[..., 2] - z) < SAME) & lowest[:, None]
        total += float((np.linalg.norm(other - corner, axis=2) * edge * part.thickness[:, None]).sum())
    return total


def _above(model: ShellModel, z: float) -> np.ndarray:
    """Of the mass of each node what lies above a level (nodes) [kg]: elements by their middle, floors by their height."""
    mesh = model.mesh
    mass = np.where(mesh.xyz[:, 2] > z + SAME, mesh.floor_mass, 0.0)
    for part in mesh.parts:
        density = np.array([m.density for m in mesh.materials])[part.material]
        high = mesh.xyz[part.connect, 2].mean(axis=1) > z
        np.add.at(mass, part.connect, nodal_areas(mesh.xyz, part.connect) * (density * part.thickness * high)[:, None])
    return mass


def _normal(model: ShellModel, z: float) -> float:
    """Weight and prestress on a level [N]; forces that are no weight act at the height of their nodes."""
    mesh = model.mesh
    high = mesh.xyz[:, 2] > z + SAME
    normal = GRAVITY * float(_above(model, z).sum()) - float(mesh.push[high, 2].sum())
    for bar in mesh.bars:
        low, top = sorted(mesh.xyz[list(bar.nodes)], key=lambda place: float(place[2]))
        if low[2] <= z + SAME < top[2]:
            normal += bar.prestress * float((top[2] - low[2]) / np.linalg.norm(top - low))
    return normal


def _share(model: ShellModel, options: Pushover, z: float) -> float:
    """Of the base shear what acts above a level; 0 of drives that do not all lie above it, whose parts are not known."""
    if options.drives:
        return float(all(model.mesh.levels[drive.storey] > z + SAME for drive in options.drives))
    mass = model.mesh.mass()
    force = model.reference[:, :3] @ model.along
    part = np.divide(_above(model, z), mass, out=np.zeros_like(mass), where=mass > 0.0)
    return float(abs((force * part).sum()) / np.abs(force).sum())
