"""The arch of a deck as limit analysis and rocking see it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from extrados.core import arch as core_arch
from extrados.core import mechanism as core_mechanism
from extrados.core.rocking import Body, arch_body
from extrados.limit.answer import cannot_stand
from extrados.limit.errors import CannotStand, without_restraints
from extrados.limit.linkage import Linkage, linkage
from extrados.limit.programme import LimitAnalysis, Mechanism, State
from extrados.limit.solver import Immovable, NoEquilibrium
from extrados.model.errors import WHOLE, NoView
from extrados.model.geometry.mass import together
from extrados.model.structures.arch import ArchAssembly, make_arch
from extrados.views.rockers.impact import energy_kept

#: Bounds of thickness over radius between which the minimum thickness is sought.
THINNEST, THICKEST = 1e-3, 1.9
#: Arches that keep less than this at a blow keep more in discrete elements: up to MORE beyond it, or LEAST, the greater
#: (tests/verification/test_impact_map.py)
STOCKY, MORE, LEAST = 0.7, 0.2, 0.4
#: Motion that repeats itself faster than this times sqrt(.2 m/R) [Hz] fells discrete elements that the blow lets stand
#: (tests/verification/test_impact_tests.py)
FAST = 5.0


def minimum_thickness(embrace: float, voussoirs: int) -> float:
    """Least t/R of an arch that stands under its weight; embrace in degrees (thesis 3.3, Milankovitch)."""

    def capacity(ratio: float) -> float:
        arch = make_arch(1.0, ratio, embrace, voussoirs)
        try:
            return LimitAnalysis(arch).collapse()[0].gamma
        except Immovable:
            return np.inf
        except NoEquilibrium:
            return -1.0

    # The capacity is below zero, or there is no equilibrium at any tilt, where the arch is too thin.
    if capacity(THINNEST) > 0.0:
        return THINNEST
    low, high = THINNEST, THICKEST
    while high - low > 1e-10:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if capacity(middle) > 0.0 else (middle, high)
    return high


def four_hinge(arch: ArchAssembly, mechanism: Mechanism) -> core_arch.FourHinge:
    """The three links between the four hinges of a collapse mechanism.

    Raises ValueError where the mechanism has not exactly four hinges, or one slides.
    """
    hinges = mechanism.hinges
    if mechanism.sliding or len(hinges) != 4:
        raise ValueError(f"the mechanism has {len(hinges)} hinges and {len(mechanism.sliding)} sliding joints")
    joint = np.array([j for j, _ in hinges])
    points = np.array([(arch.intrados if face == "intrados" else arch.extrados)[j] for j, face in hinges])
    part = slice(joint[0], joint[-1])
    link = np.repeat(np.arange(3), np.diff(joint))
    mass, centroid, inertia = together(arch.mass[part], arch.centroid[part], arch.inertia[part], link, 3)
    return core_arch.FourHinge(points, joint, mass, centroid, inertia)


@dataclass(frozen=True)
class Impacts:
    """Rate after over rate before an impact of the four-hinge arch, c_v, by each rule.

    thesis: momentum balances of Eqs B.3, which may exceed 1 or fall below 0; energy_safe: projection on the mirrored
    mechanism alone, below 0 where it would have to close further; inelastic: the energy that a blow without rebound
    leaves, with impulses at all joints (rockers.impact), between 0 and 1 and continuous in the geometry.
    """

    thesis: float
    energy_safe: float
    inelastic: float

    @property
    def by_rule(self) -> dict[str, float]:
        """The same by the words of decks."""
        return {"thesis": self.thesis, "energy-safe": self.energy_safe, "inelastic": self.inelastic}

    def differing(self, factor: float) -> dict[str, float]:
        """All c_v, held between 0 and 1, where the greatest exceeds the least by the factor; else none."""
        used = {rule: float(np.clip(value, 0.0, 1.0)) for rule, value in self.by_rule.items()}
        return used if max(used.values()) > factor * min(used.values()) else {}


@dataclass(frozen=True)
class ArchModel:
    """An arch that stands, its collapse state to +x, and its impact rule (a word of Impacts.by_rule, or c_v)."""

    arch: ArchAssembly
    rule: str | float = "inelastic"

    @cached_property
    def limit(self) -> LimitAnalysis:
        """The limit analysis that finds its collapse states."""
        return LimitAnalysis(self.arch)

    @cached_property
    def collapse(self) -> tuple[State, Mechanism]:
        """State and mechanism under the greatest load to +x; CannotStand where the arch collapses under its own weight."""
        try:
            state, mechanism = self.limit.collapse(1)
        except Immovable:
            raise NoView("no horizontal load causes a mechanism of this arch, because its joints restrain it on all sides", WHOLE) from None
        except NoEquilibrium:
            state = None
        if state is None or state.gamma <= 0.0:
            a = self.arch
            least = minimum_thickness(float(np.degrees(a.embrace)), a.voussoirs)
            proof = without_restraints(cannot_stand(self.limit))
            raise CannotStand(
                f"the effective thickness is {a.thickness:.4g} m (t/R {a.thickness / a.radius:.4f}). The least thickness for "
                f"{np.degrees(a.embrace):g} deg and {a.voussoirs} voussoirs is {least * a.radius:.4g} m (t/R {least:.5f}); {proof}",
                proof.motion,
                proof.neglects,
            )
        return state, mechanism

    @cached_property
    def four_hinge(self) -> core_arch.FourHinge:
        """The mechanism that rocks to +x."""
        _, mechanism = self.collapse
        try:
            return four_hinge(self.arch, mechanism)
        except ValueError as error:
            raise NoView(f"rocking requires a four-hinge mechanism: {error}", WHOLE) from None

    @cached_property
    def limits(self) -> core_arch.Limits:
        """Critical and locking rotation, and what it weighs at rest."""
        return core_arch.limits(self.four_hinge)

    @cached_property
    def linkages(self) -> tuple[Linkage, Linkage]:
        """Links and hinges of the mechanisms to +x and to -x."""
        return linkage(self.arch, self.collapse[1], 1), linkage(self.arch, self.limit.collapse(-1)[1], -1)

    @cached_property
    def impacts(self) -> Impacts:
        """c_v by each rule."""
        a, m = self.arch, self.four_hinge
        opposite = np.where(np.isclose(m.hinge, a.intrados[m.joint]).all(axis=1)[:, None], a.extrados[m.joint], a.intrados[m.joint])
        thesis, projection = core_arch.restitution(a.mass, a.centroid, a.inertia, m.joint, m.hinge, opposite)
        one, _ = self.linkages
        opening = one.velocities(a.centroid, core_mechanism.follow(one, [0.0])[1][0])
        # the mirrored mechanism has the same mass, so that energies are squares of rates
        return Impacts(thesis, projection, float(np.sqrt(energy_kept(a, -opening))))

    @property
    def restitution(self) -> float:
        """c_v used: by the rule, between 0 and 1; NoView where the rule says that the hinges do not reflect."""
        if not isinstance(self.rule, str):
            return float(self.rule)
        value = self.impacts.by_rule[self.rule]
        if value < 0.0:
            raise NoView(
                f'the impact rule "{self.rule}" gives c_v = {value:.3f}: the mechanism towards the opposite side would '
                f'not open after the impact. Give restitution = "inelastic" (c_v = {self.impacts.inelastic:.3f})',
                ("joints", "restitution"),
            )
        return min(value, 1.0)

    @property
    def kept_by_elements(self) -> float | None:
        """c_v up to which discrete elements keep, where the blow at all joints is known to lose too much; else None."""
        if self.rule != "inelastic" or self.restitution >= STOCKY:
            return None
        return max(self.restitution + MORE, LEAST)

    @property
    def fastest_beat(self) -> float | None:
        """Frequency above which motion that repeats itself is worse than the blow at all joints says [Hz]; None where that is
        not the rule."""
        return FAST * float(np.sqrt(0.2 / self.arch.radius)) if self.rule == "inelastic" else None

    @property
    def warnings(self) -> list[str]:
        """What the reader of an answer should know of the impact rule."""
        impacts = self.impacts
        if (kept := self.kept_by_elements) is not None:
            return [
                (
                    f"for this stocky arch, the impact rule gives a coefficient of restitution of {self.restitution:.3f}. "
                    f"Discrete elements give up to {kept:.3f}, and the arch collapses earlier: use `dem`"
                )
            ]
        if self.rule == "thesis" and impacts.thesis > 1.0:
            return [
                (
                    f"the momentum balance of the thesis gives c_v = {impacts.thesis:.3f}, which would create energy, so c_v = 1 is "
                    f'used. With restitution = "inelastic" c_v is {impacts.inelastic:.3f}, and with "energy-safe" it is '
                    f"{impacts.energy_safe:.3f}"
                )
            ]
        return []

    def rivals(self, factor: float) -> dict[str, tuple[float, Body]]:
        """Rule -> (c_v, structure) of all rules where they differ by more than the factor; none for a given number."""
        if not isinstance(self.rule, str):
            return {}
        return {rule: (c_v, arch_body(self.four_hinge, c_v)) for rule, c_v in self.impacts.differing(factor).items()}

    @cached_property
    def body(self) -> Body:
        """What the integrator takes, without rebound at a wall."""
        return self.rebounding(1.0)

    def rebounding(self, factor: float) -> Body:
        """The structure with c_v times a factor, at most 1."""
        return arch_body(self.four_hinge, min(1.0, factor * self.restitution))
