"""What earth over stones does: it pushes back where they move into it, and spreads loads on its surface."""

import numpy as np

from extrados.limit.resistance import Resistance
from extrados.model.geometry.earth import BESIDE, Earth
from extrados.schema.constants import GRAVITY


def passive_pressure(earth: Earth, depth: float, centroid: np.ndarray) -> Resistance | None:
    """Horizontal passive pressure on the sloping tops of stones, those of one block that face one way together.

    At a depth z below the formation it is m (K_p sigma_v + 2 c sqrt(K_p)), sigma_v the weight of fill and surfacing
    above, m the share that counts (Rankine; Gilbert and Melbourne 1994). What faces left is pushed to the right. Each is
    anything from nothing up to its whole; drawn where it meets the upright through the centroid (blocks, 2) [m] of its block.
    """
    if earth.passive <= 0.0:
        return None
    y0, y1 = earth.line.start[:, 1], earth.line.end[:, 1]
    low, high = np.minimum(y0, y1), np.minimum(np.maximum(y0, y1), earth.formation)
    steep = high - low > 0.0
    low, high, way, block = low[steep], high[steep], np.sign(y1 - y0)[steep], earth.line.block[steep]
    coefficient = earth.passive_coefficient
    surcharge = earth.surfacing_density * earth.surfacing

    def pressure(y: np.ndarray) -> np.ndarray:
        above = GRAVITY * (earth.density * (earth.formation - y) + surcharge)
        return earth.passive * (coefficient * above + 2.0 * earth.cohesion * np.sqrt(coefficient))

    one, two, tall = pressure(low), pressure(high), high - low
    force = 0.5 * (one + two) * tall * depth
    arm = low + tall * (one + 2.0 * two) / (3.0 * (one + two))
    side, index = np.unique(np.column_stack([block, way]), axis=0, return_inverse=True)
    index = index.ravel()
    push = np.bincount(index, force, len(side)) * side[:, 1]
    moment = -np.bincount(index, force * arm, len(side)) * side[:, 1]
    block, count = side[:, 0].astype(int), len(side)
    return Resistance(
        np.arange(count),
        block,
        np.column_stack([push, np.zeros(count), moment]),
        np.column_stack([centroid[block, 0], -moment / push]),
        np.zeros(count),
        np.ones(count),
    )


def under_load(earth: Earth, count: int, x: float, force: float, length: float) -> np.ndarray:
    """Forces (count, 3) on blocks of a load [N] on the surface about x [m], over a length of contact [m].

    Vertical stresses under an even strip load on an elastic half space (Boussinesq), or even ones, within the angle of
    dispersal; at each place of the stones by the cover there. They are scaled so that all of the load arrives; what
    falls beside the stones is lost to the ground.
    """
    x0, x1, cover, block = earth.pieces
    cover = np.maximum(cover, 1e-6 * max(length, 1e-3))
    reach = 0.5 * length + cover * np.tan(np.radians(earth.angle))
    overlap = np.maximum(np.minimum(x1, x + reach) - np.maximum(x0, x - reach), 0.0)
    if earth.dispersal == "even":
        stress = 1.0 / (2.0 * reach)
    else:
        away = 0.5 * (x0 + x1) - x
        one, two = (np.arctan((away + half) / cover) for half in (-0.5 * length, 0.5 * length))
        stress = (two + np.sin(two) * np.cos(two) - one - np.sin(one) * np.cos(one)) / (np.pi * length)
    share = stress * overlap
    share *= force / share.sum()
    return pressed(share, 0.5 * (x0 + x1), block, count)


def pressed(force: np.ndarray, x: np.ndarray, block: np.ndarray, count: int) -> np.ndarray:
    """Downward forces [N] at x [m] on blocks as loads (count, 3); those beside the stones are left out."""
    on = block != BESIDE
    out = np.zeros((count, 3))
    out[:, 1] = -np.bincount(block[on], force[on], count)
    out[:, 2] = -np.bincount(block[on], (force * x)[on], count)
    return out
