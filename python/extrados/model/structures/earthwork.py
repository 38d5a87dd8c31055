"""Earth over arches: tables of fill, surfacing and spandrel walls, and the assembly that carries them."""

from dataclasses import replace
from typing import Literal

import numpy as np

from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.earth import Earth, skyline
from extrados.schema.quantities import Angle, Density, Length, Stress
from extrados.schema.table import Table, key


class Fill(Table):
    """Soil over the arches up to a level formation: weight, dispersal of loads, passive pressure."""

    cover: Length = key(about="depth of the fill over the highest point of the extrados", ge=0)
    density: Density = key(2000.0, "density of the soil", gt=0, le=30000)
    friction_angle: Angle = key(30.0, "angle of friction of the soil", ge=0, le=60)
    cohesion: Stress = key(0.0, "cohesion of the soil, which increases the passive pressure", ge=0)
    passive: float = key(
        0.0,
        "share of the passive pressure by Rankine that acts on blocks which move into the fill; programs for arch bridges use 0.5",
        source="Gilbert and Melbourne 1994",
        ge=0,
        le=1,
    )
    dispersal: Literal["boussinesq", "even"] = key(
        "boussinesq",
        "how a load spreads to the blocks within `dispersal_angle`. boussinesq: by the stresses of Boussinesq; even: uniformly",
    )
    dispersal_angle: Angle = key(
        30.0, "angle from the vertical within which a load spreads; 26.6 degrees is a slope of 1 in 2", ge=0, le=70
    )


class Surfacing(Table):
    """Road or ballast on the fill."""

    thickness: Length = key(about="thickness", ge=0)
    density: Density = key(2300.0, "density", gt=0, le=30000)


class Spandrels(Table):
    """Spandrel walls on both edges of the arches, within their depth, up to the formation: weight in place of fill."""

    thickness: Length = key(about="thickness of each of the two spandrel walls", gt=0)
    density: Density | None = key(None, "density; default: density of [material]", gt=0, le=30000)


def refuse_without_fill(fill: Fill | None, surfacing: Surfacing | None, spandrels: Spandrels | None, depth: float | None) -> None:
    """ValueError where surfacing or spandrel walls have no fill, or the walls leave no room for it in the depth [m]."""
    for name, given in (("surfacing", surfacing), ("spandrels", spandrels)):
        if given is not None and fill is None:
            raise ValueError(f"{name} requires fill: give fill, with cover = 0 if there is no fill over the crown")
    if spandrels is not None and depth is not None and 2.0 * spandrels.thickness >= depth:
        raise ValueError(
            f"spandrels: two walls of {spandrels.thickness:g} m leave no space for fill; the depth of {depth:g} m includes the walls"
        )


def covered(
    assembly: Assembly, crown: float, density: float, fill: Fill | None, surfacing: Surfacing | None, spandrels: Spandrels | None
) -> Assembly:
    """The stones under fill up to its cover over `crown` [m], with surfacing and spandrel walls of `density` [kg/m^3].

    Fill and walls share the depth: the mass per volume is their mean, and passive pressure acts on the fill alone. As the
    pressure is computed from the mean weight above, its share is reduced by both ratios; the part of it from surfacing and
    cohesion is then underestimated. Strength and stiffness of the walls are neglected.
    """
    if fill is None:
        return assembly
    paved = surfacing or Surfacing(thickness=0.0)
    mean, passive = fill.density, fill.passive
    if spandrels is not None:
        walls = 2.0 * spandrels.thickness / assembly.depth
        mean = (1.0 - walls) * fill.density + walls * (spandrels.density or density)
        passive *= (1.0 - walls) * min(fill.density / mean, 1.0)
    earth = Earth(
        skyline(assembly.outlines),
        crown + fill.cover,
        mean,
        paved.thickness,
        paved.density,
        fill.friction_angle,
        fill.cohesion,
        passive,
        fill.dispersal,
        fill.dispersal_angle,
    )
    soil, surface = earth.masses(len(assembly.mass), assembly.depth)
    total = soil[:, :1] + surface[:, :1]
    place = (soil[:, :1] * soil[:, 1:] + surface[:, :1] * surface[:, 1:]) / np.maximum(total, 1e-300)
    resting = np.concatenate([total, np.where(total > 0.0, place, assembly.centroid)], axis=1)
    return replace(assembly, fill=resting, earth=earth)
