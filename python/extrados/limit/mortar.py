"""Mortar of the contacts of solids in limit analysis: cohesion and tension that last, in terms of dry contacts.

At a point of a contact |tau| <= c + mu sigma and sigma >= -f. With s = sigma + f this is |tau| <= mu s + (c - mu f), s >= 0: a dry
contact under a compression f A more at its middle, beside shear of c - mu f that no pressure needs. The first is a load, the second
acts as dowels do. Where f exceeds c / mu, no point bears more tension than c / mu.

Tension is exact: rigid blocks open a contact everywhere or turn about its edge, and then the opening is linear over its area. The
shear acts at the centres of the kites between corner, middle and both sides, which bear less torsion than an even shear does.
"""

from dataclasses import replace

import numpy as np

from extrados.model.geometry.solids.assembly import Keys, SolidAssembly


def mortared(
    assembly: SolidAssembly, friction: float | np.ndarray | None, cohesion: np.ndarray, tension: np.ndarray
) -> tuple[SolidAssembly, np.ndarray]:
    """Blocks with dowels for the shear of mortar, and the tension (nj) [Pa] of their contacts, for cohesion and tension (nj) [Pa] and a
    coefficient of friction, None where nothing slides."""
    mu = np.full(len(assembly.a), np.inf if friction is None else friction, dtype=float)
    slides = np.isfinite(mu)
    apex = np.full(len(mu), np.inf)
    np.divide(cohesion, mu, out=apex, where=slides & (mu > 0.0))
    borne = np.minimum(tension, apex)
    spare = np.where(slides, cohesion - np.where(slides, mu, 0.0) * borne, 0.0)
    place, area, joint = _kites(assembly)
    strength = spare[joint] * area
    counts = strength > 0.0
    own = Keys(place[counts], joint[counts], strength[counts], np.full(int(counts.sum()), np.inf))
    if (there := assembly.keys) is not None:
        own = Keys(*(np.concatenate([getattr(there, k), getattr(own, k)]) for k in ("point", "joint", "strength", "reach")))
    keys = own if len(own.joint) else None
    return replace(assembly, keys=keys), borne


def _kites(assembly: SolidAssembly) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Centres (nv, 3) [m], areas (nv) [m^2] and contacts (nv) of the parts of the contacts about their corners, each between the
    middle of the contact, the corner and the middles of its sides."""
    place, area = [np.empty((0, 3))], [np.empty(0)]
    for polygon, middle in zip(assembly.polygon, assembly.middle, strict=True):
        after = 0.5 * (polygon + np.roll(polygon, -1, axis=0))
        before = np.roll(after, 1, axis=0)
        first, second = (0.5 * np.linalg.norm(np.cross(polygon - middle, end - middle), axis=1) for end in (before, after))
        whole = first + second
        weighted = first[:, None] * (middle + before + polygon) + second[:, None] * (middle + polygon + after)
        place.append(weighted / (3.0 * whole[:, None]))
        area.append(whole)
    return np.concatenate(place), np.concatenate(area), assembly.corner_joint
