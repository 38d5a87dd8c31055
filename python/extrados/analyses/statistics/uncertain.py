"""Buildings whose sizes, corners, stones and impacts are not known exactly: rockers at points of the unit cube."""

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
from scipy.stats import norm, qmc

from extrados.analyses.batches import computed, stacked
from extrados.analyses.context import Context, Refused
from extrados.analyses.statistics.tables import BASE, STACK, STONES, UNCERTAIN, Fragility
from extrados.core.rocking import Body
from extrados.limit.errors import CannotStand
from extrados.model.errors import BadGeometry, NoView
from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.deviation import resurveyed
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.views.building import Building
from extrados.views.rockers.block import BlockModel
from extrados.views.rockers.rocker import Rocker, make_rocker
from extrados.views.rockers.stack import rocks_as_stack

#: What is drawn stone by stone, by a generator that the point of the cube seeds
BY_STONE = ("density", "imperfection")


Stones = TypeVar("Stones", Assembly, SolidAssembly)

#: In place of the kind of a body: the building cannot stand
FALLEN = -2


def factors_of(uncertain: dict[str, float], draw: np.ndarray) -> tuple[dict[str, float], dict[str, int]]:
    """Lognormal factors of mean 1 by name, and seeds of the names of BY_STONE, from the coefficients of variation and a point (names,) of
    the unit cube; names in order."""
    names = sorted(uncertain)
    spread = np.sqrt(np.log1p(np.array([uncertain[n] for n in names]) ** 2))
    row = np.exp(spread * norm.ppf(np.clip(draw, 1e-12, 1.0 - 1e-12)) - 0.5 * spread**2)
    factor = dict(zip(names, row.tolist(), strict=True))
    return factor, {name: int(draw[i] * 2.0**53) for i, name in enumerate(names) if name in BY_STONE}


def sobol_draws(names: int, count: int, seed: int) -> np.ndarray:
    """Points (count, names) of the unit cube by a scrambled Sobol sequence."""
    power = max(1, int(np.ceil(np.log2(count))))
    return np.asarray(qmc.Sobol(names, scramble=True, seed=seed).random_base2(power)[:count])


@dataclass(frozen=True)
class Sample:
    """Member k is the rocker of a building at the point draws[k] of the unit cube, by the names of `uncertain` in order.

    Sizes, restitution, the base that gives way and the thickness lost at corners have lognormal factors of mean 1. `density` gives each stone
    such a factor on its mass; `imperfection` moves each corner and each end of a joint evenly within a circle, whose
    radius is that share of the shortest joint: the draw seeds the generator of its stones. width: numbers by which the
    core knows each.
    """

    building: Building
    options: Fragility
    draws: np.ndarray
    width: int = 0

    def rocker(self, k: int) -> Rocker:
        """BadGeometry where that building does not rock, as one that cannot stand."""
        return self.rocker_and_building(k)[0]

    def rocker_and_building(self, k: int) -> tuple[Rocker, Building]:
        """The same with the building itself, whose stones are the nominal ones where `density` or `imperfection` vary."""
        factor, seeds = factors_of(self.options.uncertain, self.draws[k])
        return _model(self.building, self.options, factor, seeds)

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        """Parameters of the structures for the core, NaN with a reason where there is none."""
        return stacked(self._member, first, count)

    def _member(self, k: int) -> dict[str, np.ndarray]:
        kind, values, start, reason = -1, np.full(self.width, np.nan), 0.0, ""
        try:
            rocker = self.rocker(k)
            kind, values, start = rocker.body.kind, rocker.body.parameters, rocker.start_rotation
        except BadGeometry as error:
            reason = str(error)
        except CannotStand as error:
            kind, reason = FALLEN, str(error)
        return {"kind": np.array(kind), "body": values, "start": np.array(start), "reason": np.array(reason)}

    def wide(self, base: Rocker) -> "Sample":
        """The same with the width of the first that rocks; stones of their own make another structure than the base."""
        for k in range(len(self.draws)):
            try:
                return replace(self, width=len(self.rocker(k).body.parameters))
            except (BadGeometry, CannotStand):
                continue
        return replace(self, width=len(base.body.parameters))


@dataclass(frozen=True)
class Bodies:
    """Structures of a sample, or the texts why one is none; rotations from which they start [rad]. fallen: which of them
    cannot stand; another of the sample is put in their place, as no motion is needed to know how they end."""

    bodies: list[Body | str]
    starts: np.ndarray
    fallen: np.ndarray
    sample: Sample | None = None


def sampled(context: Context, options: Fragility, base: Rocker, count: int) -> Bodies:
    """One structure for each motion with uncertain values drawn by a scrambled Sobol sequence."""
    return bodies_at(context, options, base, sobol_draws(len(options.uncertain), count, options.seed or 0))


def bodies_at(context: Context, options: Fragility, base: Rocker, draws: np.ndarray) -> Bodies:
    """One structure for each row of draws from the unit cube, see `Sample`; Unfinished where some are missing."""
    refuse_unknown(context.building, sorted(options.uncertain))
    job = Sample(context.building, options, draws).wide(base)
    rows = computed(context, "sample", job, len(draws), "buildings of the sample")
    bodies: list[Body | str] = [
        str(reason) if kind < 0 else Body(int(kind), values)
        for kind, values, reason in zip(rows["kind"], rows["body"], rows["reason"], strict=True)
    ]
    fallen = rows["kind"] == FALLEN
    stand_in = next((body for body in bodies if isinstance(body, Body)), base.body)
    return Bodies([stand_in if down else body for body, down in zip(bodies, fallen, strict=True)], rows["start"], fallen, job)


def refuse_unknown(building: Building, names: list[str]) -> None:
    """Refused where the structure does not have an uncertain value."""
    structure = building.structure
    assert structure is not None
    what = structure.kind
    stack = rocks_as_stack(building)
    known = UNCERTAIN.get(what, STACK if stack else ("restitution",) if structure.rocks_as == "piers" else STONES)
    if building.supports.stiffness is not None:
        known = tuple(name for name in known if name != "restitution") + tuple(name for name in BASE if getattr(building.supports, name))
    for name in names:
        key = ("analysis", "uncertain", name)
        if name == "density" and what == "block" and name not in known:
            raise Refused(
                "the densities of blocks cannot vary, because the structure is modelled as one rigid block: remove uncertain.density", key
            )
        sized = name not in (*STONES, *BASE, "corners")
        if name not in known or (sized and getattr(structure, name) is None):
            raise Refused(f"this {structure.word} has no value of this name; its values are {', '.join(known) or 'none'}", key)
    if what == "arch" and building.joints.restitution == "thesis" and set(names) & set(BY_STONE):
        raise Refused(
            "random differences between the blocks make the arch unsymmetric, but the impact rule of the "
            "thesis covers only symmetric arches: give `restitution` of [joints] another value than "
            '"thesis"',
            ("analysis", "uncertain"),
        )
    refuse_mixed_friction(building, names)
    if "corners" in names and getattr(structure, "thickness_factor", 1.0) == 1.0:
        raise Refused("`thickness_factor` is 1, so there is no lost thickness that could vary", ("analysis", "uncertain", "corners"))


def refuse_mixed_friction(building: Building, names: Collection[str]) -> None:
    """Refused where the friction is uncertain and not one number for all joints."""
    joints = building.joints
    if "friction" in names and (joints.coefficient is None or any(t.friction is not None for t in joints.types)):
        raise Refused(
            "friction varies for all joints together: give [joints] friction as one number, and no friction of joint types",
            ("analysis", "uncertain", "friction"),
        )


def _model(building: Building, options: Fragility, factor: dict[str, float], seeds: dict[str, int]) -> tuple[Rocker, Building]:
    structure = building.require_structure()
    update: dict[str, Any] = {
        name: getattr(structure, name) * value for name, value in factor.items() if name not in (*STONES, *BASE, "corners")
    }
    joints = building.joints
    if "friction" in factor and joints.coefficient is not None:
        joints = joints.model_copy(update={"friction": joints.coefficient * factor["friction"]})
    base = {name: getattr(building.supports, name) * factor[name] for name in BASE if name in factor}
    if "corners" in factor:
        given: float | None = getattr(structure, "thickness_factor", None)
        if given is None:
            raise NoView(f"a structure of kind '{structure.kind}' has no worn corners", ("analysis", "uncertain", "corners"))
        left = 1.0 - (1.0 - given) * factor["corners"]
        if left <= 0.0:
            raise NoView("its corners are worn away", ("analysis", "uncertain", "corners"))
        update["thickness_factor"] = left
    changed = building.having(
        structure=structure.model_copy(update=update), supports=building.supports.model_copy(update=base), joints=joints
    ).apart()
    stones = drawn_stones(changed.blocks(), options.uncertain, seeds) if seeds else None
    rocker = make_rocker(changed, options.form == "linear", stones, options.soft_base)
    if not isinstance(rocker.model, BlockModel) and not options.watches_samples:
        rocker = rocker.unwatched()  # tables of the joints of many stones are long
    return (rocker.rebounding(factor["restitution"]) if "restitution" in factor else rocker), changed


def drawn_stones(assembly: Assembly, uncertain: dict[str, float], seeds: dict[str, int]) -> Assembly:
    """The assembly with the masses and the places of its blocks drawn anew."""
    if "imperfection" in seeds:
        deviation = uncertain["imperfection"] * float(assembly.length.min())
        assembly = resurveyed(assembly, deviation, np.random.default_rng([0, seeds["imperfection"]]))
    return drawn_masses(assembly, uncertain, seeds)


def drawn_masses(assembly: Stones, uncertain: dict[str, float], seeds: dict[str, int]) -> Stones:
    """The assembly with the masses of its blocks drawn anew."""
    if "density" not in seeds:
        return assembly
    spread = np.sqrt(np.log1p(uncertain["density"] ** 2))
    random = np.random.default_rng([1, seeds["density"]])
    share = np.exp(spread * random.standard_normal(len(assembly.mass)) - 0.5 * spread**2)
    return replace(assembly, mass=assembly.mass * share, inertia=(assembly.inertia.T * share).T)
