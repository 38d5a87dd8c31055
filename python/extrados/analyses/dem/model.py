"""A deck's structure as a discrete-element model: bodies, joint types, damping."""

from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from extrados.analyses.context import Refused
from extrados.analyses.dem import impact_rules
from extrados.analyses.dem.impact_rules import ContactValues
from extrados.analyses.dem.solid_model import SolidModel
from extrados.analyses.dem.tables import DemTable
from extrados.analyses.dem.ties import NO_TIES, ElementTies
from extrados.core import dem, dem_run
from extrados.core.dem_run import Law
from extrados.core.errors import Cancelled, status_code
from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.earth import passive_left_out
from extrados.model.geometry.water import Pressure
from extrados.results.verdict import loads_at_rest
from extrados.schema.constants import GRAVITY
from extrados.views.rigid import RigidBodies

#: Of contacts that crush
RECOVERY = "crushed corners recover when the joint closes: the damage by crushing and its energy loss are neglected"

#: Of water
STILL_WATER = (
    "the water pressure is constant: hydrodynamic pressure, water that enters cracks during the motion, and a change of the wet "
    "faces are neglected. The pressure acts from the start, together with the self-weight"
)

Found = TypeVar("Found", bound=dem_run.FoundRun)


@dataclass(frozen=True)
class JointValues(ContactValues):
    """Properties of all joints of an assembly, and their lengths (joints,) [m]."""

    length: np.ndarray


@dataclass(frozen=True)
class Model:
    """An assembly with its bodies; laws come from joint values, so that sweeps share the geometry. strength: at which the corners of joints
    crush, 0 never [Pa]; water: its pressure on the blocks."""

    assembly: Assembly
    rigid: RigidBodies
    values: JointValues
    ties: ElementTies = NO_TIES
    strength: float = 0.0
    water: Pressure | None = None

    @property
    def count(self) -> int:
        """Mobile bodies."""
        return self.rigid.count

    @property
    def mass(self) -> np.ndarray:
        """Masses of the bodies [kg]."""
        return self.rigid.mass

    @property
    def load(self) -> np.ndarray | None:
        """Constant loads of all bodies (bodies, 4) [N, N, N m, N m], as core.dem.Bodies has them."""
        return None if self.water is None else self.water.on_bodies(self.rigid.body_of_block, self.rigid.centroid)

    @property
    def other_loads(self) -> str:
        """Constant loads besides the own weight, in words."""
        return "" if self.water is None else "the water pressure"

    @property
    def body_names(self) -> list[str]:
        """Names of the bodies, then of the supports."""
        return self.rigid.names

    @property
    def size(self) -> float:
        """Greatest extent of the structure [m]."""
        return float(np.ptp(np.concatenate(self.assembly.outlines), axis=0).max())

    def bodies(self, values: JointValues | None = None) -> dem.Bodies:
        """Bodies and laws for the core; contacts that form later take the median of the joints, without mortar and crushing."""
        v = values or self.values

        def law(k: float, shear: float, friction: float, cohesion: float = 0.0, tension: float = 0.0) -> Law:
            return Law(float(k), float(shear), float(friction), cohesion=float(cohesion), tension=float(tension), damping=v.beta)

        laws = [law(np.median(v.stiffness), np.median(v.shear_stiffness), np.median(v.friction))]
        numbers: dict[Law, int] = {}
        joints: dict[tuple[int, int], int] = {}
        for j, pair in enumerate(self.rigid.joints):
            if pair is None:
                continue
            one = law(v.stiffness[j], v.shear_stiffness[j], v.friction[j], v.cohesion[j], v.tension[j])
            one = replace(one, strength=self.strength)
            if one not in numbers:
                numbers[one] = len(laws)
                laws.append(one)
            joints[pair] = numbers[one]
        r = self.rigid
        return dem.Bodies(r.centroid, r.mass, r.inertia, r.parts, r.owner, r.outer, r.depth, laws, joints, self.ties.core, load=self.load)

    def drawn(self) -> dem_run.DrawnContacts:
        """The joints between two bodies, for their forces and places."""
        one, on = self.assembly, self.between
        ends = [np.stack([one.p[j], one.q[j]]) for j in on]
        return dem_run.DrawnContacts(np.array([self.rigid.joints[j] for j in on]), ends, one.normal[on])

    @property
    def between(self) -> list[int]:
        """Numbers of the joints between two bodies, in which groups of blocks have none."""
        return [j for j, pair in enumerate(self.rigid.joints) if pair is not None]


class Falls(Refused):
    """A block falls under the constant loads."""


class Restless(Refused):
    """The structure does not come to rest under the constant loads."""


def checked(run: Found, model: Model | SolidModel, keep: tuple[str, ...] = ("end", "collapse", "rest", "left")) -> Found:
    """The run where it ended in one of the ways of `keep`; Refused says what stopped it and which block, Falls where it
    fell before it was shaken, Cancelled where it was interrupted before."""
    if run.interrupted and not len(run.time):
        raise Cancelled(status_code("cancelled"), "interrupted before the motion began")
    if run.interrupted or run.reason in keep:
        return run
    names = [model.body_names[k] for k in run.blamed]
    first, loads = names[0] if names else "a block", loads_at_rest(model.other_loads)
    wedged = (
        (
            f". In {run.effort.open_steps} of these steps the solver did not find the impulses at the rigid "
            "contacts: blocks that touch on several sides jam under high friction. Use "
            'solver = "compliant", or a smaller coefficient of friction'
        )
        if run.effort.steps and run.effort.open_steps
        else ""
    )
    raise {"unsettled": Falls, "restless": Restless}.get(run.reason, Refused)(
        {
            "step": f"the time step exceeds the critical time step of {run.critical_step:.3g} s: give a smaller `time_step`",
            "overlap": f"{' and '.join(names)} overlap at the start: correct the geometry",
            "unsettled": f"the structure does not stand under {loads}: {first} falls",
            "restless": f"the structure does not come to rest under {loads} in {run.settling_steps} steps ({first} moves most), so "
            f"discrete elements do not show whether the structure stands{wedged}",
            "blow-up": f"the error of the energy balance is too large: the run was stopped at step {run.steps} ({run.stop_time:.4g} s), "
            f"and {first} is the fastest block. Try a smaller time step",
        }.get(run.reason, f"stopped: {run.reason} ({first})")
    )


def warnings(model: Model, options: DemTable, values: JointValues | None = None) -> list[str]:
    """What is doubtful about the damping (thesis 7.2.1, 7.4.2), what of the building is left out, and by how much blocks are
    not as drawn."""
    found = [*passive_left_out(model.assembly.earth), *adjusted(model)]
    if model.water is not None:
        found.append(STILL_WATER)
    if options.rigid:
        return found + doubts_of_rigid_mortar(model.values)
    found += doubts_of_springs(values or model.values)
    if model.strength:
        found.append(
            f"{RECOVERY}. Contacts that form later, and joints whose overlap is below 4 % of the size of the smallest block, do not crush"
        )
    if options.mass_damping > 0.0:
        found.append(
            "mass-proportional damping acts like viscous air around a rocking block. This has no physical "
            "meaning and is unsafe: give mass_damping = 0"
        )
    return found


def warnings_of_solids(model: SolidModel, *, springs: bool) -> list[str]:
    """What is doubtful about the joints of blocks in space."""
    found = doubts_of_springs(model.values, "contact") if springs else doubts_of_rigid_mortar(model.values, "contact")
    if model.water is not None:
        found.append(STILL_WATER)
    return [*found, f"{RECOVERY}. Contacts that form later, and edges that cross, do not crush"] if model.strength else found


def adjusted(model: Model) -> list[str]:
    """By how much blocks are not as drawn [mm]."""
    rigid, tolerance, found = model.rigid, model.assembly.tolerance, []
    if rigid.moved > 1e-6 * model.size:
        found.append(
            f"the program moved faces of blocks by up to {1000.0 * rigid.moved:.2g} mm, so that they meet at "
            f"their joints (`contact_tolerance` {1000.0 * tolerance:g} mm)"
        )
    if rigid.cut > 0.0:
        why = f"contact_tolerance {1e3 * tolerance:g} mm" if tolerance else "arcs are drawn by chords"
        found.append(f"the program removed overlaps of blocks of up to {1000.0 * rigid.cut:.2g} mm ({why})")
    return found


def doubts_of_springs(values: ContactValues, joint: str = "joint") -> list[str]:
    """Warnings that impacts are damped too little, and that mortar bears more in bending than an elastic joint. joint: its name."""
    ratio, found = values.ratios(), _doubts_of_tension(values, joint)
    if ratio["rotation"] < impact_rules.LEAST_AT_ROTATION or ratio["edge"] < impact_rules.LEAST_AT_EDGE:
        found.append(
            f"the damping is low: {100 * ratio['rotation']:.3g} % of critical at rotational impact and {100 * ratio['edge']:.3g} "
            "% at edge impact. At least 10 % and 25 % are advised; with less damping, blocks may bounce and move sideways"
        )
    return found


def doubts_of_rigid_mortar(values: ContactValues, joint: str = "joint") -> list[str]:
    """The warning that rigid contacts find mortar at its strongest. joint: its name."""
    if not max(np.nanmax(values.tension, initial=0.0), np.nanmax(values.cohesion, initial=0.0)) > 0.0:
        return []
    return [
        *_doubts_of_tension(values, joint),
        "with rigid contacts, as in limit analysis, mortar holds if an equilibrium within its strength exists. If several joints, "
        "or both ends of a joint, share a force, brittle mortar may fail earlier: compare with springs",
    ]


def _doubts_of_tension(values: ContactValues, joint: str) -> list[str]:
    if not np.nanmax(values.tension, initial=0.0) > 0.0:
        return []
    found = [
        "the tensile strength of mortar acts at the ends or corners of a joint. The joint therefore carries up to three times the "
        "bending moment of an elastic joint"
    ]
    less = np.flatnonzero(values.tension * values.friction > values.cohesion * (1.0 + 1e-9))
    if len(less):
        most = values.cohesion[less] / values.friction[less]
        j = int((values.tension[less] - most).argmax())
        those = f"one {joint} carries" if len(less) == 1 else f"{len(less)} {joint}s carry"
        found.append(
            f"{those} less tension than the deck gives, because Coulomb's law allows at most cohesion / friction: "
            f"{most[j] / 1000.0:.3g} kPa instead of {values.tension[less][j] / 1000.0:.3g} kPa"
        )
    return found


def unconverged(effort: dem_run.Effort) -> list[str]:
    """The warning that rigid contacts, or on springs the pressure of faces that crush, did not converge in some steps."""
    if not effort.open_steps:
        return []
    if not effort.steps:
        return [f"the pressure of crushing faces did not converge {effort.open_steps} times. Try a smaller `time_step`"]
    return [
        (
            f"the contacts did not converge in {effort.open_steps} of {effort.steps} steps. The greatest error, at {effort.worst:.4g} "
            f"s, is {effort.residual:.2g} of the velocity that gravity adds in one step. Try a smaller `time_step`"
        )
    ]


def settle_time(model: Model | SolidModel) -> float:
    """Long enough for the structure to come to rest or down after a pulse [s]."""
    return 15.0 * float(np.sqrt(model.size / GRAVITY))
