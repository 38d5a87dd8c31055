"""What each analysis takes for granted, and where its answer ends: said beside every result of its kind."""

#: Kind -> (what it takes for granted, where it ends)
LIMITS: dict[str, tuple[str, str]] = {
    "tilt": (
        "A constant acceleration pushes for ever; stones are rigid, joints bear no tension and slide by friction.",
        "It asks how hard, never how long. Stones that crack or crush, and supports that give way, are beyond it unless the deck "
        "says so.",
    ),
    "thrust": (
        "Equilibrium of rigid stones whose joints bear no tension, at a given constant acceleration.",
        "Any admissible line shows that it stands; which of them the building has nobody can tell.",
    ),
    "rocking": (
        "The building moves as one mechanism, that of limit analysis, without sliding; impacts lose energy by the rule of "
        "[joints] restitution.",
        "Hinges do not move along the building, blocks do not slide, bounce or crush: sliding and other hinges are checked along the "
        "motion. Where impact rules disagree, or the run is chaotic, use fragility.",
    ),
    "failure-domain": (
        "Single pulses on a mechanism at rest.",
        "The curve is the lowest failing amplitude; safe pockets above it are not to be relied on.",
    ),
    "assessment": (
        "The motion is its strongest single sines, each against the curve of sines that bring the mechanism down from rest.",
        "A criterion of first order for an intact structure on rigid supports: what comes before and after a sine is left out.",
    ),
    "fragility": (
        "Rocking of many buildings or motions that differ as nobody can know; the model is that of rocking.",
        "A share of runs, with the interval of its count: it holds for the scatter and the motions that were given.",
    ),
    "code-checks": (
        "Rules of codes with their own reductions of demand and capacity.",
        "Clauses marked `verify clause` were not read in the standard: compare them with its text before use.",
    ),
    "local-mechanism": (
        "A part of the building turns as rigid bodies about hinges, by the kinematic analysis of codes.",
        "The result holds for this mechanism; others may be weaker. A rule outside its scope does not apply, which its row says. Clauses "
        "marked `verify clause` were not read in the standard.",
    ),
    "sla": (
        "Elastic stones or walls whose joints or elements crack one after the other under a growing load, in the plane.",
        "Static: it asks how hard, not how long. What it bears depends on the strengths that the deck gives.",
    ),
    "pushover": (
        "Flat shells that crack event by event under horizontal forces that grow in one proportion; corners and floors hold as the "
        "deck says.",
        "Static: it asks how hard, not how long. A wall that is not bonded to those across it, or not anchored to the floors, may "
        "fall out of its plane first: check local mechanisms too.",
    ),
    "dem": (
        "Every stone moves by itself on springs that open, slide and damp; no mechanism is chosen before.",
        "The stiffness and damping of joints stand for what is not known; vary them before relying on one run.",
    ),
    "assess": (
        "Each strategy by its own analysis, with parameters by stated rules.",
        "Reasons tell what differs between models, not which of them is right. A result is no better than the geometry it was given.",
    ),
}  # fmt: skip
