"""Assumptions and limits of validity of each kind of analysis, printed beside every result of the kind."""

from typing import NamedTuple

from extrados import kinds


class Validity(NamedTuple):
    """What an analysis assumes, and where its answer no longer holds, in words; `kinds.ANALYSES` names that of each kind,
    called as its table."""

    assumes: str
    limits: str


def validity_of(kind: str) -> Validity | None:
    """The validity of a kind of analysis; None where this version has no such kind."""
    return kinds.load(kinds.ANALYSES[kind].validity) if kind in kinds.ANALYSES else None


Tilt = Validity(
    "Blocks are rigid; joints carry no tension and slide by Coulomb friction. The horizontal acceleration is sustained.",
    "Duration, impacts and recovery of an earthquake are not considered. Fracture and crushing of blocks and movements of "
    "supports are considered only where the deck states them. With associated friction and sliding the capacity is an upper bound.",
)
Thrust = Validity(
    "Rigid blocks whose joints carry no tension are in equilibrium under a given constant acceleration.",
    "One admissible thrust line proves that the structure stands. The actual thrust line is indeterminate: it depends on "
    "settlements and on the history of construction.",
)
Sweep = Validity(
    "Limit analysis gives the capacity at each value of one key; all other keys keep their values.",
    "Between two computed values the capacity is not known. The limits of tilt apply to each value.",
)
Survey = Validity(
    "Limit analysis gives the capacity of each section of the table by itself.",
    "Sections do not support one another: arching along the building and walls across it are not considered. The limits of tilt "
    "apply to each section.",
)
Imperfections = Validity(
    "Limit analysis gives the capacity of random geometries, each point within the stated deviation of the survey.",
    "The band covers the deviation of the survey alone. Errors that all points share, hidden voids and the scatter of materials "
    "are not in it. The limits of tilt apply to each geometry.",
)
MovingSupports = Validity(
    "Supports move slowly, blocks are rigid, and joints open or slide where equilibrium requires it.",
    "Elastic deformation, creep and inertia are not considered, so that the smallest movement opens joints. The movement at "
    "collapse is an upper bound where blocks crush at their hinges.",
)
MovingLoad = Validity(
    "Rigid blocks whose joints carry no tension resist a load that stands still, in the plane of the section. Fill acts by its "
    "weight, its spreading of loads and its passive pressure, as the deck states them.",
    "Collapse is considered, and damage in service only by a permissible limit state of the deck. Braking forces and dynamic "
    "effects beyond the stated factor are not. Skew, the strength of spandrel walls and spreading across the bridge are not modelled. A "
    "ring without fill and backing is no model of a bridge.",
)
Rocking = Validity(
    "The structure moves as one rigid-body mechanism, that of limit analysis, without sliding. Impacts lose energy by the rule of "
    "[joints] restitution.",
    "Hinges stay at their joints; blocks do not slide, bounce or crush. Sliding and hinges elsewhere are checked along the motion, and "
    "rigid contacts follow the blocks from the state in which a check fails (hand_over). "
    "Where the rules of impact differ, or the response is chaotic, one run is one sample: use fragility.",
)
FailureDomain = Validity(
    "A single pulse acts on the rigid-body mechanism at rest.",
    "The curve is the lowest amplitude that causes collapse. Safe regions above the curve are not reliable. Earthquakes with "
    "several pulses may cause collapse below it. The curves depend on the rule of impact.",
)
FailureCurves = Validity(
    "Single sines, or trains of sines, act on the rigid-body mechanisms at rest. Each motion is replaced by its primary impulse.",
    "The parts of a motion before and after its primary impulse are not considered. Safe regions above a curve are not reliable, "
    "and the curves depend on the rule of impact.",
)
Assessment = Validity(
    "The motion is replaced by its strongest single sines, each compared with the curve of sines that cause collapse from rest.",
    "This is a criterion of first order for an intact structure on rigid supports. The parts of a motion before and after a sine "
    "are not considered.",
)
Fragility = Validity(
    "Many motions, or many buildings with random properties, run by the model of rocking.",
    "The result is a share of runs with the confidence interval of its count. The share holds for the given scatter and motions "
    "and inherits the limits of rocking.",
)
Resonance = Validity(
    "The ground acceleration stays below a cap and switches its sign so that each half cycle feeds most energy to the mechanism.",
    "No earthquake follows the rotation of a structure: the result is an extreme and has no probability. The limits of rocking apply.",
)
RockingSpectrum = Validity(
    "Rigid blocks, or arches of one shape in all sizes, rock from rest without sliding under one motion.",
    "The spectrum holds for this motion and this rule of impact alone. It cannot be derived from an elastic response spectrum.",
)
HarmonicMap = Validity(
    "A harmonic motion of constant amplitude acts for a fixed number of cycles on a mechanism at rest that does not slide.",
    "Neighbouring points of the map may have different outcomes, because the response is chaotic near overturning. An earthquake "
    "has fewer cycles of one frequency.",
)
CodeChecks = Validity(
    "Simplified rules of codes with their own reductions of demand and capacity.",
    "Each rule holds within the scope of its clause. Clauses marked `verify clause` were not read in the standard: compare them "
    "with its text before use.",
)
LocalMechanism = Validity(
    "A part of the building rotates as rigid bodies about hinges: the linear and nonlinear kinematic analysis of codes.",
    "The result holds for the stated mechanism; another mechanism may be weaker. The connection to walls across and floors is "
    "that of the deck. A rule outside its scope does not apply, and its row states that. Clauses marked `verify clause` were not "
    "read in the standard.",
)
MotionStudy = Validity(
    "The acceleration is integrated from rest, and linear oscillators without interaction with the ground respond to it.",
    "Measures describe the motion at its station, not the demand on a building. Displacements and long periods depend on "
    "baseline and filter. The pulse classification is statistical and may fail for single records.",
)
ShakeTable = Validity(
    "A table with limits of stroke, flow or velocity, and force moves a rigid mass.",
    "Errors of control, resonance of the oil column and the reaction of a specimen that rocks are not considered.",
)
Sla = Validity(
    "Elastic masonry, whose joints or elements crack one event after the other, carries a load that grows in proportion, in the plane.",
    "The analysis is static: duration and inertia are not considered. The capacity depends on the strengths, the fracture energies "
    "and the mesh. Small displacements are assumed: collapse by a mechanism needs limit analysis.",
)
Pushover = Validity(
    "Flat shells crack event by event under horizontal forces in one fixed pattern. Corners and floors connect the walls as the deck "
    "states.",
    "The analysis is static: duration, cycles and inertia are not considered. Walls that are not bonded to the walls across, or not "
    "anchored to the floors, may overturn out of their plane first: check local mechanisms too.",
)
Dem = Validity(
    "Each block moves by itself. Contacts open, slide and lose energy by stiffness and damping, or by rigid impacts.",
    "Stiffness, damping and rebound of joints are uncertain parameters: vary them. Blocks do not crack. Where the response is "
    "chaotic, one run is one sample.",
)
DemDomain = Validity(
    "A single pulse acts on blocks that move each by itself, as in dem; durations are tried upwards at each amplitude.",
    "The curve is the shortest tried duration that causes collapse. Safe regions beyond it are not reliable, and a shorter "
    "duration between two tried ones may cause collapse. The limits of dem apply.",
)
DemParameters = Validity(
    "Rules of thumb give joint stiffness, impact frequency and damping; no run is made.",
    "The values are starting values for dem and no property of the building: vary them, and compare the outcomes.",
)
Strengthen = Validity(
    "A tie is rigid until it yields, then carries its yield force; it is sized by limit analysis, other interventions by repeated runs "
    "of the analysis that measures the target. Material and joints that are not changed keep their properties.",
    "The required force is a yield force: stiffness, prestress and slack decide at which movement it acts. The anchorage carries it only "
    "as far as its checks are made. The limits of the analysis that measures the target apply.",
)
Assess = Validity(
    "Each strategy has its own analysis, with parameters chosen by stated rules.",
    "The reasons state how the models differ, not which model is right. No strategy is better than the geometry and the "
    "properties of the deck.",
)
Modes = Validity(
    "Blocks are rigid; their elasticity and that of the joints lies in springs along the joints, which are all closed.",
    "Frequencies are those of small vibration: joints that open lower them. Soil and neighbouring walls are rigid supports.",
)
FrameModes = Validity(
    "Piers and spandrels vibrate about the equilibrium under the weight. Walls have no stiffness out of their planes.",
    "Sections that are open under the weight stay open. Masses of walls out of their planes move with the corners, linearly between them.",
)
FramePushover = Validity(
    "Walls are plane frames of piers and spandrels between rigid nodes. Sections carry no tension and crush; piers slide or crack in "
    "shear; beyond a drift limit an element loses its strength and keeps its vertical load. All nodes of a wall on a level have one "
    "displacement along it.",
    "Failure of walls out of their planes is not considered: use local-mechanism. Spandrels carry no normal force but that of ties and ring beams. A corner lifts the weight on the effective width of its flange. Strengths and drift limits "
    "are those of codes; tested walls scatter by a fifth about them. Irregular openings make the division into piers uncertain.",
)
FrameHistory = Validity(
    "The frame of frame-pushover moves under one horizontal component. Sections unload elastically towards the origin and keep their "
    "crushing; sliding is plastic. Damping follows the stiffness of the last step.",
    "Vertical motion, failure of walls out of their planes and impacts of opened joints are not considered.",
)
FrameFragility = Validity(
    "The frame of frame-history, or of frame-pushover with N2, under many motions. Uncertain values are lognormal and hold for the whole "
    "building; limit states follow from the strengths and drift limits of piers.",
    "The uncertainty of the model itself and the scatter from wall to wall are not included. Failure of walls out of their planes is not "
    "considered. N2 gives the mean demand of oscillators, not that of each motion.",
)
