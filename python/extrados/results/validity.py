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
    "Blocks are rigid; joints carry no tension and slide by Coulomb friction. The horizontal acceleration is constant in time.",
    "Duration, impacts and recovery of an earthquake are not considered. Fracture and crushing of blocks and movements of supports are "
    "considered only if the deck gives them. If joints slide with associated friction, the capacity is an upper bound.",
)
Thrust = Validity(
    "The structure consists of rigid blocks whose joints carry no tension. It is in equilibrium under a given constant acceleration.",
    "One admissible thrust line proves that the structure can stand. The actual thrust line is "
    "indeterminate: it depends on settlements and on the history of construction.",
)
ThrustNetwork = Validity(
    "The weight is carried by compression along the branches of one form diagram in plan. The branches meet at nodes "
    "within the thickness of the masonry. Stone does not crush, and joints do not slide.",
    "A network within the masonry proves that the structure can stand if joints do not slide. Another form diagram may give a greater "
    "safety factor, less or greater thrust, and a greater horizontal load. Horizontal loads act at the nodes, not at the centroids of "
    "the blocks. Without a network nothing is proved.",
)
Sweep = Validity(
    "One key of the deck is varied, and limit analysis gives the capacity at each of its values. All other keys keep their values.",
    "Between two calculated values the capacity is not known. The limits of validity of limit analysis apply to each value.",
)
Survey = Validity(
    "Limit analysis gives the capacity of each section of the table separately.",
    "Sections do not support one another: arching along the building and transverse walls are not "
    "considered. The limits of validity of limit analysis apply to each section.",
)
Imperfections = Validity(
    "Limit analysis gives the capacity of random geometries. In each of them, every point of the "
    "survey is moved at random within the stated deviation.",
    "The band includes only the deviation of the survey. Errors common to all points, hidden voids and the scatter of materials are not "
    "included. The limits of validity of limit analysis apply to each geometry.",
)
MovingSupports = Validity(
    "Supports move slowly. Blocks are rigid; joints open or slide where equilibrium requires it.",
    "Elastic deformation, creep and inertia are not considered, so even the smallest movement opens "
    "joints. If blocks crush at their hinges, the movement at collapse is an upper bound.",
)
MovingLoad = Validity(
    "The structure consists of rigid blocks whose joints carry no tension. The load is static and acts in the plane of the section. "
    "Fill acts by its weight, by spreading the load and by its passive pressure, with the values of the deck.",
    "Collapse is considered. Damage in service is considered only if the deck gives a permissible limit state. Braking forces and "
    "dynamic effects beyond the stated factor are not considered. Skew, the strength of spandrel walls and the transverse spread of "
    "loads are not modelled. A ring without fill and backing does not represent a bridge.",
)
Rocking = Validity(
    "The structure moves as the single rigid-body mechanism that limit analysis gives, without "
    "sliding. Impacts lose energy by the impact rule of the deck.",
    "Hinges remain at the same joints; blocks do not slide, bounce or crush. During the motion, sliding and hinges at other joints are "
    "checked. If a check fails, the run continues from that state as discrete elements with rigid contacts, which can slide. If the "
    "impact rules give different outcomes, or if the response is chaotic, one run is only one sample: use the analysis `fragility`.",
)
FailureDomain = Validity(
    "A single pulse acts on the rigid-body mechanism at rest.",
    "The curve gives the lowest amplitude that causes collapse. Safe regions above the curve are not reliable. Earthquakes with several "
    "pulses may cause collapse at amplitudes below it. The curve depends on the impact rule.",
)
FailureCurves = Validity(
    "Single sines, or trains of sines, act on the rigid-body mechanisms at rest. Each motion is replaced by its primary impulse.",
    "The parts of a motion before and after its primary impulse are not considered. Safe regions above a curve are "
    "not reliable, and the curves depend on the impact rule.",
)
Assessment = Validity(
    "The motion is replaced by its strongest single sines. Each sine is compared with the failure curve of sines "
    "that act on the structure at rest.",
    "This is an approximate criterion for an intact structure on rigid supports. The parts of a motion before and "
    "after a sine are not considered.",
)
Fragility = Validity(
    "The rocking analysis is run for many motions, or for many buildings with random properties.",
    "The result is the share of runs that collapse, with the confidence interval due to the number of runs. The share refers to the "
    "given scatter and motions. The limits of validity of the rocking analysis apply.",
)
Resonance = Validity(
    "The ground acceleration does not exceed a given limit. It changes sign so that each half cycle "
    "adds as much energy as possible to the mechanism.",
    "No earthquake follows the rotation of a structure in this way. The result is an extreme case "
    "without a probability. The limits of validity of the rocking analysis apply.",
)
RockingSpectrum = Validity(
    "Rigid blocks of all sizes, or arches of one shape and all sizes, rock from rest without sliding under one motion.",
    "The spectrum is valid only for this motion and this impact rule. It cannot be derived from an elastic response spectrum.",
)
HarmonicMap = Validity(
    "A harmonic motion of constant amplitude acts for a fixed number of cycles on a mechanism at rest that does not slide.",
    "Neighbouring points of the map may have different outcomes, because the response is chaotic near overturning. "
    "An earthquake has fewer cycles at a single frequency.",
)
CodeChecks = Validity(
    "The analysis applies simplified rules of codes, with their own reductions of demand and capacity.",
    "Each rule is valid within the scope of its clause. Clauses marked 'verify clause' were not read "
    "in the standard: compare them with its text before use.",
)
LocalMechanism = Validity(
    "A part of the building rotates as rigid bodies about hinges. The analysis is the linear and nonlinear kinematic analysis of codes.",
    "The result holds for the stated mechanism; another mechanism may be weaker. The connections to transverse walls and floors are "
    "those given in the deck. A rule is not applied to an element outside its scope, and its row says so. Clauses marked 'verify "
    "clause' were not read in the standard.",
)
MotionStudy = Validity(
    "Velocity and displacement are integrated from rest. The spectra are those of linear oscillators without soil-structure interaction.",
    "The measures describe the motion at its station, not the demand on a building. Displacements and long periods depend on the "
    "baseline correction and the filter. The pulse classification is statistical and may fail for single records.",
)
ShakeTable = Validity(
    "A shaking table with limits of stroke, velocity (or flow) and force moves a rigid mass.",
    "Control errors, resonance of the oil column and the reaction of a specimen that rocks are not considered.",
)
Sla = Validity(
    "The masonry is elastic, and cracking of joints or elements is calculated one event at a time "
    "(sequentially linear analysis). The load increases in proportion and acts in the plane.",
    "The analysis is static: duration and inertia are not considered. The capacity depends on the strengths, the "
    "fracture energies and the mesh. Small displacements are assumed: use limit analysis for collapse by a mechanism.",
)
Pushover = Validity(
    "The walls are flat shells. Cracking is calculated one event at a time (sequentially linear analysis), under horizontal forces with "
    "a fixed distribution. Corners and floors connect the walls as given in the deck.",
    "The analysis is static: duration, cycles and inertia are not considered. Walls without bond to transverse walls, or without "
    "anchorage to floors, may overturn out of their plane first: check local mechanisms too.",
)
Dem = Validity(
    "Each block moves independently. Contacts open and slide. They lose energy by damping, or by rigid impacts.",
    "Stiffness, damping and rebound of joints are uncertain parameters: vary them. Blocks do not crack. If the "
    "response is chaotic, one run is only one sample. The water pressure is hydrostatic. Crushed joints recover when they close.",
)
DemDomain = Validity(
    "A single pulse acts on blocks that move independently, as in the discrete-element analysis. At "
    "each amplitude, increasing durations are tried.",
    "The curve gives the shortest tried duration that causes collapse. Safe regions beyond the curve are not reliable, and a duration "
    "between two tried ones may cause collapse. The limits of validity of the discrete-element analysis apply.",
)
DemFragility = Validity(
    "The motions of the set act on blocks that move independently, as in the discrete-element analysis. Each motion acts on a building "
    "with its own sampled values.",
    "The probability is that of the set of motions and of the given uncertainties. Runs whose blocks still move at the end have no "
    "outcome. The limits of validity of the discrete-element analysis apply.",
)
DemParameters = Validity(
    "Empirical rules give joint stiffness, impact frequency and damping. No motion is run.",
    "The values are starting values for discrete-element analyses, not properties of the building: vary them, and compare the outcomes.",
)
Strengthen = Validity(
    "A tie is rigid until it yields, and then carries its yield force. Limit analysis gives the size of a tie. For other interventions, "
    "the analysis of the target is repeated with increasing sizes. Materials and joints that are not changed keep their properties.",
    "The required force is a yield force. Stiffness, prestress and slack decide the movement at which this force acts. The checks of "
    "the anchorage limit the force that the tie can carry. The limits of validity of the analysis of the target apply.",
)
Assess = Validity(
    "Each strategy runs its own analysis, with parameters chosen by stated rules.",
    "The reasons explain how the models differ, not which model is right. No strategy is more accurate than the "
    "geometry and the properties in the deck.",
)
Modes = Validity(
    "Blocks are rigid. Springs along the joints represent the elasticity of blocks and joints. All joints are closed.",
    "The frequencies are those of small vibrations; joints that open reduce them. Soil and neighbouring walls act as rigid supports.",
)
FrameModes = Validity(
    "Piers and spandrels vibrate about the equilibrium under self-weight. Walls have no out-of-plane stiffness.",
    "Sections that are open under self-weight stay open. Out of their planes, the masses of walls follow the corners, with linear "
    "interpolation between two corners.",
)
FramePushover = Validity(
    "Walls are plane frames of piers and spandrels between rigid nodes. Sections carry no tension, and they crush. Piers slide or "
    "crack in shear. Beyond its drift limit, an element loses its lateral strength and keeps its vertical "
    "load. All nodes of a wall on one level have the same displacement along the wall.",
    "The frame model excludes out-of-plane failure of walls. If the deck gives a code, this failure is checked separately for each "
    "wall. Spandrels carry no "
    "normal force except that of ties and ring beams. At a corner, a wall lifts at most the weight on the effective width of its flange. "
    "Strengths and "
    "drift limits are those of codes, and tested walls differ from them by about 20 %. With irregular openings the division into piers "
    "is uncertain.",
)
FrameHistory = Validity(
    "The frame is that of the pushover; it moves under one horizontal component. Sections unload elastically towards the origin, and "
    "crushing is permanent. Sliding is plastic. Damping follows the stiffness of the last step.",
    "Vertical motion, out-of-plane failure of walls, and impacts when open joints close, are not considered.",
)
FrameFragility = Validity(
    "The frame is calculated for many motions, by response histories or by pushover with N2. Uncertain values are lognormal and apply "
    "to the whole building. Limit states follow from the strengths and drift limits of the piers.",
    "The uncertainty of the model and the scatter from wall to wall are not included. Out-of-plane failure of walls "
    "is not considered. N2 gives the mean demand of oscillators, not the demand of each motion.",
)
