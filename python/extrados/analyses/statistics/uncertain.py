"""Buildings whose sizes, corners, stones and impacts are not known exactly: rockers at points of the unit cube."""

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.stats import norm, qmc

from extrados.analyses.context import Context, Refused
from extrados.analyses.statistics.tables import STONES, UNCERTAIN, Fragility
from extrados.building.building import Building
from extrados.building.errors import NoView
from extrados.building.geometry.assembly import Assembly
from extrados.building.geometry.deviation import resurveyed
from extrados.building.rockers.rocker import Rocker, make_rocker

#: What is drawn stone by stone, by a generator that the point of the cube seeds
BY_STONE = ("density", "imperfection")


def sampled_models(context: Context, options: Fragility, base: Rocker, count: int) -> list[Rocker | str]:
    """One model for each motion with uncertain values drawn by a scrambled Sobol sequence; see `models_at`."""
    draws = qmc.Sobol(len(options.uncertain), scramble=True, seed=options.seed or 0).random_base2(
        max(1, int(np.ceil(np.log2(count))))
    )[:count]
    return models_at(context, options, base, draws)


def models_at(context: Context, options: Fragility, base: Rocker, draws: np.ndarray) -> list[Rocker | str]:
    """One rocker for each row of draws from the unit cube, by the names of `uncertain` in order; a text tells why a
    building of the sample does not rock, as one that cannot stand.

    Sizes, restitution and the thickness lost at corners have lognormal factors of mean 1. `density` gives each stone
    such a factor on its mass; `imperfection` moves each corner and each end of a joint evenly within a circle, whose
    radius is that share of the shortest joint: the draw of a row seeds the generator of its stones.
    """
    names = sorted(options.uncertain)
    _refuse_unknown(context.building, names, base)
    spread = np.sqrt(np.log1p(np.array([options.uncertain[n] for n in names]) ** 2))
    factors = np.exp(spread * norm.ppf(np.clip(draws, 1e-12, 1.0 - 1e-12)) - 0.5 * spread**2)
    made: list[Rocker | str] = []
    for draw, row in zip(draws, factors, strict=True):
        factor = dict(zip(names, row.tolist(), strict=True))
        seeds = {name: int(draw[k] * 2.0**53) for k, name in enumerate(names) if name in BY_STONE}
        try:
            made.append(_model(context.building, options, factor, seeds))
        except NoView as error:
            made.append(str(error))
    return made


def _refuse_unknown(building: Building, names: list[str], base: Rocker) -> None:
    structure = building.structure
    known = UNCERTAIN.get(base.what, ("restitution",) if structure.rocks_as == "piers" else STONES)
    for name in names:
        if name == "density" and base.what == "block":
            raise Refused("uncertain.density: the rocking of one rigid block does not depend on it")
        sized = name not in (*STONES, "corners")
        if name not in known or (sized and getattr(structure, name) is None):
            raise Refused(f"uncertain.{name} does not belong to this {base.word}; it has {', '.join(known) or 'none'}")
    if base.what == "arch" and building.joints.restitution == "thesis" and set(names) & set(BY_STONE):
        raise Refused(
            "uncertain stones make an arch unsymmetric, where the balance of the thesis says nothing: give another "
            "joints.restitution"
        )
    if "corners" in names and structure.thickness_factor == 1.0:
        raise Refused("uncertain.corners: thickness_factor is 1, so no thickness is lost that could vary")


def _model(building: Building, options: Fragility, factor: dict[str, float], seeds: dict[str, int]) -> Rocker:
    structure = building.structure
    update: dict[str, Any] = {
        name: getattr(structure, name) * value for name, value in factor.items() if name not in (*STONES, "corners")
    }
    if "corners" in factor:
        left = 1.0 - (1.0 - structure.thickness_factor) * factor["corners"]
        if left <= 0.0:
            raise NoView("its corners are worn away")
        update["thickness_factor"] = left
    changed = building.having(structure=structure.model_copy(update=update)).apart()
    stones = _stones(changed.blocks(), options, seeds) if seeds else None
    rocker = make_rocker(changed, options.form == "linear", stones)
    return rocker.rebounding(factor["restitution"]) if "restitution" in factor else rocker


def _stones(assembly: Assembly, options: Fragility, seeds: dict[str, int]) -> Assembly:
    """The assembly with the masses and the places of its stones drawn anew."""
    if "imperfection" in seeds:
        deviation = options.uncertain["imperfection"] * float(assembly.length.min())
        assembly = resurveyed(assembly, deviation, np.random.default_rng([0, seeds["imperfection"]]))
    if "density" in seeds:
        spread = np.sqrt(np.log1p(options.uncertain["density"] ** 2))
        random = np.random.default_rng([1, seeds["density"]])
        share = np.exp(spread * random.standard_normal(len(assembly.mass)) - 0.5 * spread**2)
        assembly = replace(assembly, mass=assembly.mass * share, inertia=assembly.inertia * share)
    return assembly
