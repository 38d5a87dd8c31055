"""Other words for what decks and results call by one name: `extrados explain backfill` points to where a thing is found.

One table. Each line: words that people use, what they mean here, the deck keys and kinds ("kind.key") or results
("results.KIND.KEY") where the thing is found, and the page of docs/ that tells more. A test follows every pointer.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Synonym:
    """A line of the table: words of one meaning, what they mean here, where the thing is found, a page of docs/ or ""."""

    words: tuple[str, ...]
    about: str
    see: tuple[str, ...]
    page: str


def _line(words: str, about: str, see: str, page: str = "") -> Synonym:
    return Synonym(tuple(word.strip() for word in words.split(",")), about, tuple(see.split()), page)


SYNONYMS: tuple[Synonym, ...] = (
    # geometry
    _line(
        "backfill, infill, spandrel fill, fill, soil",
        "material over a vault: its weight, its spreading of loads and its passive pressure",
        "bridge.fill aisled-vault.fill_density bridge.backing",
        "bridges.md",
    ),
    _line(
        "span, clear span, opening width",
        "for a round arch, the span is 2 (radius - thickness / 2) sin(embrace / 2), reported as `clear_span_m`",
        "arch.radius arch.embrace pointed-arch.span spans.span results.tilt.clear_span_m",
        "limit.md",
    ),
    _line(
        "rise, sagitta, arch height",
        "height of the intrados at the crown above its springings",
        "elliptical-arch.rise spans.rise results.tilt.rise_m",
        "limit.md",
    ),
    _line(
        "mean radius, centreline radius, centre line, axis radius",
        "radii refer to the centre line, midway between intrados and extrados",
        "arch.radius dome.radius",
        "theory.md",
    ),
    _line(
        "intrados, soffit, extrados, inner radius, outer radius",
        "the inner and the outer face of an arch, at the radius minus and plus half the thickness",
        "arch.radius arch.thickness",
        "theory.md",
    ),
    _line(
        "embrace angle, opening angle, subtended angle, included angle",
        "the angle between the springing joints, in degrees",
        "arch.embrace",
        "theory.md",
    ),
    _line(
        "voussoir count, number of voussoirs, number of stones, keystone, key stone",
        "an arch has a keystone at its crown if the number of voussoirs is odd, otherwise a joint",
        "arch.voussoirs vault.voussoirs",
        "guide.md",
    ),
    _line(
        "springing, springer, impost, skewback",
        "the joints at the supports of an arch; these are rigid unless the supports settle",
        "bridge.spans.springing_thickness aisled-vault.springing cross-vault.springers supports",
        "limit.md",
    ),
    _line(
        "ring thickness, arch thickness, t/r, thickness ratio",
        "thickness of the ring, perpendicular to its axis; t/R is thickness / radius",
        "arch.thickness arch.thickness_factor",
        "guide.md",
    ),
    _line(
        "width, breadth, out of plane depth, vault length",
        "depth of a plane structure perpendicular to its plane; weights and forces refer to this depth",
        "arch.depth vault.depth",
        "theory.md",
    ),
    _line(
        "pier, column, pillar, shaft",
        "a part of a bridge or a church, or a free-standing structure of kind column",
        "bridge.piers aisled-vault.pier_width column code-checks",
        "rocking.md",
    ),
    _line(
        "abutment, buttress, counterfort, pinnacle",
        "mass of masonry that resists the thrust of an arch",
        "bridge.abutments vault.buttress_width aisled-vault.buttress_width tilt.fracture",
        "limit.md",
    ),
    _line("flying buttress, flyer", "an arch that carries thrust from the nave to a buttress", "aisled-vault.flyer", "limit.md"),
    _line(
        "church, basilica, cathedral, nave, aisle",
        "a nave with aisles and buttresses, or a surveyed section of a church",
        "aisled-vault blocks",
        "limit.md",
    ),
    _line("groin vault, cross vault, rib vault, cupola", "vaults in space", "cross-vault dome", "solids.md"),
    _line(
        "brick, brick wall, masonry unit, running bond, bond",
        "a wall built of units, modelled as blocks or as finite elements",
        "brickwork wall panel.unit_length",
        "sla.md",
    ),
    _line(
        "window, door, opening, void",
        "rectangular openings of walls, with lintels over them",
        "brickwork.openings panel.openings building.walls.openings",
        "buildings.md",
    ),
    _line(
        "house, storey, story, floor, diaphragm, slab, roof",
        "a building of walls and floors, given by its plan",
        "building building.floors pushover",
        "buildings.md",
    ),
    _line(
        "facade, gable, parapet, out-of-plane wall, overturning of a facade",
        "local mechanisms of walls, by the kinematic analysis of codes",
        "local-mechanism",
        "codes.md",
    ),
    _line(
        "statue, obelisk, monument, pedestal, furniture, equipment",
        "a rigid body that rocks, alone or on another body",
        "block stack",
        "rocking.md",
    ),
    _line(
        "slenderness, aspect ratio, alpha, frequency parameter, p",
        "slenderness alpha = atan(width / height); p = sqrt(3 g / (4 R)) for a rectangle",
        "block.width block.height rocking-spectrum.slenderness",
        "theory.md",
    ),
    _line(
        "drawing, cad, dxf, survey drawing, laser scan, photogrammetry",
        "blocks with outlines from a drawing or a survey",
        "blocks.file blocks.contact_tolerance",
        "surveys.md",
    ),
    # material, joints, supports
    _line(
        "mortar, dry joint, bed joint, head joint, interface",
        "joints are dry unless cohesion and tension are given; mortar has no thickness in the model",
        "joints.cohesion joints.tension joints.friction sla.mesh.joint_thickness",
        "sla.md",
    ),
    _line(
        "unit weight, specific weight, weight, self weight, dead load, gamma",
        "weights follow from the density, with g = 9.80665 m/s^2",
        "material.density results.tilt.weight_N",
        "theory.md",
    ),
    _line(
        "modulus, elastic modulus, e, young's modulus, stiffness",
        "stiffness of the material, or of the joints",
        "material.young joints.normal_stiffness joints.shear_stiffness",
        "sla.md",
    ),
    _line(
        "friction angle, phi, mu, coefficient of friction, sliding, slip",
        'friction is given as a coefficient, tan(phi); "no-sliding" is the assumption of Heyman',
        "joints.friction results.tilt.required_friction",
        "limit.md",
    ),
    _line(
        "dilatancy, associated flow, non-associated, flow rule",
        "whether joints that slide also open (dilatancy)",
        "tilt.friction_rule",
        "limit.md",
    ),
    _line(
        "strength, compressive strength, crushing, fc",
        "crushing: blocks by the strength of the material, joints by their own strength",
        "material.compressive_strength joints.compressive_strength",
        "limit.md",
    ),
    _line(
        "tensile strength, ft, cracking, fracture energy, gf",
        "strengths at which masonry cracks, and fracture energy of a crack",
        "material.tensile_strength material.fracture_energy",
        "sla.md",
    ),
    _line(
        "ratio of angular velocity after / before an impact, given by a rule or as a number",
        "ratio of the angular velocity after / before an impact, by a rule or as a number",
        "joints.restitution joints.energy_ratio",
        "theory.md",
    ),
    _line(
        "base sliding, sole, damp-proof course, flange, return wall, detached wall",
        "joints in buildings modelled with shell elements: bed joints that can slide, and corners at which a wall abuts on another",
        "building.beds building.corners joints results.pushover.joints",
        "buildings.md",
    ),
    _line(
        "tie rod, tie, anchor, chain, strut, rod, strengthening, retrofit",
        "ties between blocks or to the ground, with a yield force",
        "ties building.rods",
        "rocking-statistics.md",
    ),
    _line(
        "damper, viscous damping, damping ratio, rayleigh damping",
        "dampers between blocks; damping at the joints of discrete elements",
        "dampers joints.damping joints.damping_ratio",
        "dem.md",
    ),
    _line(
        "settlement, support displacement, spreading, foundation movement, subsidence",
        "settlement of supports, and the joints that open because of it",
        "supports.stiffness initial.movements supports",
        "limit.md",
    ),
    # loads and motions
    _line(
        "pga, peak ground acceleration, peak acceleration, ag",
        "reported for a motion; a record can be scaled to this value, and a set of motions to several values",
        "record.pga fragility.intensity results.motion.pga_g",
        "motion.md",
    ),
    _line(
        "pgv, peak ground velocity, peak velocity, pgd",
        "reported for a motion; a record can be scaled to this value",
        "record.pgv fragility.intensity results.motion.pgv_m_s",
        "motion.md",
    ),
    _line(
        "earthquake, accelerogram, ground motion, time history, seismogram, el centro, peer, at2",
        "recorded motions; the program recognises the format by the content of the file",
        "record suite generated",
        "motion.md",
    ),
    _line(
        "response spectrum, spectrum, sa, psa, spectral acceleration, design spectrum, uniform hazard spectrum",
        "spectrum of a motion, of a code, or the target of generated motions",
        "motion.periods compatible.code code-checks.spectrum record.sa",
        "motion.md",
    ),
    _line(
        "intensity, intensity measure, im, arias, cav, significant duration",
        "intensity measures of a motion, reported by `motion` and used as levels by `fragility`",
        "record.arias fragility.levels fragility.intensity motion",
        "motion.md",
    ),
    _line(
        "pulse, impulse, sine pulse, ricker, near fault",
        "single pulses, and the primary impulse of a record",
        "step-pulse sine-pulse pulse velocity-pulse motion.impulses",
        "motion.md",
    ),
    _line(
        "dt, sampling, time step, sampling rate",
        "time step of a record whose file gives none, or of discrete elements",
        "record.time_step dem.time_step",
        "motion.md",
    ),
    _line(
        "live load, vehicle, train, axle, lm71, point load, surcharge, traffic",
        "loads that cross a structure, or constant loads on it",
        "moving-load moving-load.train moving-load.axles thrust.load",
        "bridges.md",
    ),
    # questions and answers
    _line(
        "collapse load, collapse multiplier, load multiplier, lambda, capacity, lateral strength, collapse acceleration",
        "the least horizontal acceleration at which the structure becomes a mechanism",
        "tilt results.tilt.collapse_acceleration_g",
        "limit.md",
    ),
    _line(
        "hinge, plastic hinge, mechanism, four-hinge mechanism",
        "joints about which blocks rotate at collapse; results give number, name and location",
        "results.tilt.hinges hinges tilt",
        "limit.md",
    ),
    _line(
        "tilt test, tilting table, tilt angle",
        "a plane that is tilted until the structure collapses",
        "tilt dem.test results.tilt.tilt_angle_deg",
        "dem.md",
    ),
    _line(
        "thrust line, line of thrust, pressure line, minimum thrust",
        "the line of the resultant forces through the blocks",
        "thrust rocking.thrust_line_times results.tilt.thrust_min_N",
        "limit.md",
    ),
    _line(
        "safety factor, geometric safety factor, factor of safety, margin, demand capacity ratio, dcr",
        "capacity divided by demand, in every verdict; the geometric safety factor says how much thinner the structure could be",
        "thrust results.tilt.geometric_safety_factor results.verdict",
        "limit.md",
    ),
    _line(
        "overturning, toppling, rocking, uplift",
        "rigid bodies and mechanisms that rock under a motion",
        "rocking failure-domain rocking-spectrum",
        "rocking.md",
    ),
    _line(
        "fragility curve, vulnerability, probability of collapse, ida, incremental dynamic analysis, monte carlo",
        "many motions at many intensities",
        "fragility fragility.levels",
        "rocking-statistics.md",
    ),
    _line(
        "hazard curve, return period, annual rate, mean annual frequency",
        "probability of collapse within a number of years, from a hazard curve",
        "fragility.hazard",
        "rocking-statistics.md",
    ),
    _line(
        "parameter study, parametric study, optimise, optimize, dimensioning",
        "one key is varied; from Python, `extrados.sweep` varies several keys",
        "sweep survey imperfections",
        "limit.md",
    ),
    _line(
        "push over, capacity curve, base shear, drift, load displacement curve",
        "pushover of a building of walls, or of one wall",
        "pushover sla results.pushover.base_shear_coefficient",
        "buildings.md",
    ),
    _line(
        "finite elements, fem, mesh, element size, smeared crack, snap back",
        "sequentially linear analysis: cracks form one event at a time, without iterations",
        "sla sla.mesh.size panel",
        "sla.md",
    ),
    _line(
        "discrete elements, distinct elements, udec, 3dec, rigid blocks, lmgc90, contact",
        "blocks that rock, hinge, slide and collapse",
        "dem dem.solver joints.normal_stiffness",
        "dem.md",
    ),
    _line(
        "code, eurocode, ec8, ntc, asce 41, nzsee, behaviour factor",
        "checks by the rules of codes, besides dynamic analysis",
        "code-checks local-mechanism compatible.code",
        "codes.md",
    ),
    _line("report, pdf, print, paper", "`extrados report DIR --pdf` writes the report on A4", "assess", "assess.md"),
    _line(
        "film, movie, video, animation, gif",
        "moving pictures of mechanisms, rocking and cracks",
        "tilt.animation rocking.animation",
        "guide.md",
    ),
    _line("paraview, vtk, vtu, export", "fields for ParaView, besides the results", "dem.vtk motion.export", "dem.md"),
    _line(
        "parallel, cores, threads, cluster, dask, slurm",
        "`extrados run --threads N`, or `--scheduler ADDRESS` for a dask cluster",
        "fragility.count",
        "cluster.md",
    ),
    _line(
        "seed, random, reproducible",
        "a seed determines the random numbers; results do not depend on the number of threads",
        "fragility.seed generated.seed imperfections.seed",
        "rocking-statistics.md",
    ),
)


def plainly(word: str) -> str:
    """A word as it is compared: lower case, no hyphens, singular."""
    parts = word.lower().replace("-", " ").replace("_", " ").split()
    return " ".join(p[:-1] if len(p) > 3 and p.endswith("s") and not p.endswith("ss") else p for p in parts)


def meanings(word: str) -> list[Synonym]:
    """The lines of the table that a word stands in."""
    asked = plainly(word)
    return [line for line in SYNONYMS if asked in map(plainly, line.words)]


def words() -> list[str]:
    """All words of the table."""
    return [word for line in SYNONYMS for word in line.words]
