"""Vertical lines through solid blocks: where they enter and leave them."""

from dataclasses import dataclass

import numpy as np

from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.geometry.solids.polyhedra import moments

STEEP = 1e-9  # upward part of a normal below which a face is vertical


@dataclass(frozen=True)
class Columns:
    """The blocks on vertical lines: low, high (n) [m], where a line first enters and last leaves a block, NaN on lines beside all
    blocks; depth (n) [m] of the line within blocks; mass (n) [kg/m^2] of the blocks per area of plan."""

    low: np.ndarray
    high: np.ndarray
    depth: np.ndarray
    mass: np.ndarray


def columns_of(assembly: SolidAssembly, points: np.ndarray) -> Columns:
    """The columns of the blocks at points (n, 2) of the plan [m]; the mass of a block is spread evenly over its volume."""
    count = len(points)
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    depth, mass = np.zeros(count), np.zeros(count)
    volume = np.bincount(assembly.owner, [moments(part.vertices, part.triangles)[0] for part in assembly.parts], len(assembly.mass))
    density = assembly.mass / volume
    slack = STEEP * assembly.size
    for part, owner in zip(assembly.parts, assembly.owner, strict=True):
        near = np.flatnonzero(((points >= part.low[:2] - slack) & (points <= part.high[:2] + slack)).all(axis=1))
        if not len(near):
            continue
        up = part.normals[:, 2]
        left = part.offsets - points[near] @ part.normals[:, :2].T  # above: up z <= left
        upper, lower = up > STEEP, up < -STEEP
        top = (left[:, upper] / up[upper]).min(axis=1)
        bottom = (left[:, lower] / up[lower]).max(axis=1)
        inside = (top > bottom) & (left[:, ~(upper | lower)] >= -slack).all(axis=1)
        near, top, bottom = near[inside], top[inside], bottom[inside]
        low[near], high[near] = np.minimum(low[near], bottom), np.maximum(high[near], top)
        depth[near] += top - bottom
        mass[near] += density[owner] * (top - bottom)
    nothing = high < low
    low[nothing] = high[nothing] = np.nan
    return Columns(low, high, depth, mass)
