"""The arch of a deck as limit analysis and rocking see it."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from extrados.building.errors import NoView
from extrados.building.geometry.mass import together
from extrados.building.templates.arch import ArchAssembly, make_arch
from extrados.core import arch as core_arch
from extrados.core.rocking import Body, arch_body
from extrados.limit.programme import LimitAnalysis, Mechanism, State
from extrados.limit.solver import Immovable, NoEquilibrium

#: Bounds of thickness over radius between which the minimum thickness is sought.
THINNEST, THICKEST = 1e-3, 1.9


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
class ArchModel:
    """An arch that stands, its collapse state to +x, and its impact rule ("thesis", "energy-safe" or c_v)."""

    arch: ArchAssembly
    rule: str | float = "thesis"

    @cached_property
    def limit(self) -> LimitAnalysis:
        return LimitAnalysis(self.arch)

    @cached_property
    def collapse(self) -> tuple[State, Mechanism]:
        """State and mechanism under the greatest load to +x; NoView where the arch cannot stand."""
        try:
            state, mechanism = self.limit.collapse(1)
        except Immovable:
            raise NoView(
                "no horizontal load makes a mechanism of this arch: its joints hold it from all sides"
            ) from None
        except NoEquilibrium:
            state = None
        if state is None or state.gamma <= 0.0:
            a = self.arch
            least = minimum_thickness(float(np.degrees(a.embrace)), a.voussoirs)
            raise NoView(
                f"the arch cannot stand under its own weight: the effective thickness is {a.thickness:.4g} m "
                f"(t/R {a.thickness / a.radius:.4f}), the least for {np.degrees(a.embrace):g} deg and "
                f"{a.voussoirs} voussoirs is {least * a.radius:.4g} m (t/R {least:.5f})"
            )
        return state, mechanism

    @cached_property
    def four_hinge(self) -> core_arch.FourHinge:
        """The mechanism that rocks to +x."""
        try:
            return four_hinge(self.arch, self.collapse[1])
        except ValueError as error:
            raise NoView(f"rocking needs a four-hinge mechanism, but {error}") from None

    @cached_property
    def limits(self) -> core_arch.Limits:
        return core_arch.limits(self.four_hinge)

    @cached_property
    def restitutions(self) -> tuple[float, float]:
        """c_v by the momentum balance of the thesis (uncapped) and by the workless-impulse projection."""
        a, m = self.arch, self.four_hinge
        opposite = np.where(
            np.isclose(m.hinge, a.intrados[m.joint]).all(axis=1)[:, None],
            a.extrados[m.joint],
            a.intrados[m.joint],
        )
        return core_arch.restitution(a.mass, a.centroid, a.inertia, m.joint, m.hinge, opposite)

    @property
    def restitution(self) -> float:
        """c_v used: by the rule, never above 1; NoView where the hinges do not reflect."""
        if not isinstance(self.rule, str):
            return float(self.rule)
        thesis, projection = self.restitutions
        value = projection if self.rule == "energy-safe" else thesis
        if value < 0.0:
            raise NoView(
                f'the impact rule "{self.rule}" gives c_v = {value:.3f}: the hinges of an arch this stocky do not reflect '
                "at impact; give restitution a number between 0 and 1"
            )
        return min(value, 1.0)

    @property
    def warnings(self) -> list[str]:
        thesis, projection = self.restitutions
        if self.rule == "thesis" and thesis > 1.0:
            return [
                f"the impact balance of the thesis gives c_v = {thesis:.3f}, which would create energy; 1 is used "
                f'(the energy-safe rule gives {projection:.3f}: restitution = "energy-safe")'
            ]
        return []

    @cached_property
    def body(self) -> Body:
        return arch_body(self.four_hinge, self.restitution)
