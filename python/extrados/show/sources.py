"""The bibliography of a report: publications of the methods, and standards with the clauses that the analyses applied."""

import re
from collections.abc import Iterable, Sequence

THESIS = (
    "DeJong, M. J. (2009). Seismic assessment strategies for masonry structures. PhD dissertation, Massachusetts Institute of Technology"
)
HEYMAN = "Heyman, J. (1966). The stone skeleton. International Journal of Solids and Structures 2, 249-279."
LIVESLEY = "Livesley, R. K. (1978). Limit analysis of structures formed from rigid blocks. International Journal for Numerical Methods in Engineering 12, 1853-1871."
GILBERT = "Gilbert, M. and Melbourne, C. (1994). Rigid-block analysis of masonry structures. The Structural Engineer 72, 356-361."
HOUSNER = "Housner, G. W. (1963). The behavior of inverted pendulum structures during earthquakes. Bulletin of the Seismological Society of America 53, 403-417."
CUNDALL = "Cundall, P. A. (1971). A computer model for simulating progressive, large-scale movements in blocky rock systems. Symposium of the International Society for Rock Mechanics, Nancy."
MOREAU = "Moreau, J. J. (1988). Unilateral contact and dry friction in finite freedom dynamics. In Nonsmooth Mechanics and Applications, 1-82. Springer, Vienna."
ROTS = "Rots, J. G. (2001). Sequentially linear continuum model for concrete fracture. In Fracture Mechanics of Concrete Structures, 831-839. Balkema."
FAJFAR = "Fajfar, P. (2000). A nonlinear analysis method for performance-based seismic design. Earthquake Spectra 16, 573-592."
#: Publications of each kind of analysis
METHODS = {
    "tilt": (HEYMAN, LIVESLEY),
    "thrust": (HEYMAN,),
    "sweep": (HEYMAN, LIVESLEY),
    "survey": (HEYMAN, LIVESLEY),
    "imperfections": (LIVESLEY,),
    "supports": (HEYMAN, LIVESLEY),
    "moving-load": (LIVESLEY, GILBERT),
    "rocking": (HOUSNER, f"{THESIS}."),
    "failure-domain": (f"{THESIS}.",),
    "failure-curves": (f"{THESIS}.",),
    "assessment": (f"{THESIS}.",),
    "fragility": (HOUSNER,),
    "rocking-spectrum": (HOUSNER,),
    "harmonic-map": (HOUSNER,),
    "dem": (CUNDALL, MOREAU),
    "dem-domain": (CUNDALL,),
    "dem-fragility": (CUNDALL, MOREAU),
    "sla": (ROTS,),
    "pushover": (ROTS,),
    "frame-pushover": (FAJFAR,),
    "frame-fragility": (FAJFAR,),
}
#: Publications that a key of the deck names by author and year
NAMED = {"Gilbert and Melbourne 1994": GILBERT, "Housner 1963": HOUSNER, "Moreau 1988": MOREAU}
#: Clauses of EN 1991-2:2003 that give the trains of this program
TRAINS = {"LM1": "4.3.2", "LM71": "6.3.2", "SW/0": "6.3.3", "SW/2": "6.3.3"}
TRAFFIC = "EN 1991-2:2003. Eurocode 1: Actions on structures. Part 2: Traffic loads on bridges"
#: Other vehicles by the first letters of their names; of the UK annex and of the NATO agreement the text was not read
VEHICLES = {
    "SV": "UK National Annex to EN 1991-2 (verify clause).",
    "CS454": "CS 454. Assessment of highway bridges and structures. Design Manual for Roads and Bridges: 7.3.1, 7.3.2.",
    "MLC": "STANAG 2021. Military load classification of bridges, ferries, rafts and vehicles (verify Annex A).",
}
#: A value that is none of a publication
UNCERTAIN = re.compile(r"from memory|derived here")


def clause_of(source: str) -> str:
    """The clause of a rule without its formula; a clause that was not read stays marked."""
    clause, _, formula = source.partition(": ")
    return f"{clause} (verify clause)" if "verify clause" in formula else clause


def references(kinds: Iterable[str], sources: Iterable[str], trains: Sequence[str]) -> list[str]:
    """The bibliography: methods first, then the sources of values and rules, each once. Places in the dissertation have its full
    title; values without a certain source appear only in their table."""
    found = [one for kind in kinds for one in METHODS.get(kind, ())]
    clauses = sorted({TRAINS[train] for train in trains if train in TRAINS})
    if clauses:
        found.append(f"{TRAFFIC}: {', '.join(clauses)}.")
    found += [text for prefix, text in VEHICLES.items() if any(train.startswith(prefix) for train in trains)]
    places: list[str] = []
    for source in sources:
        for part in re.split(r"; ", source):
            if UNCERTAIN.search(part):
                continue
            if (place := re.fullmatch(r"thesis (.+)", part)) is not None:
                places.append(place[1])
            else:
                found.append(NAMED.get(part) or f"{part.rstrip('.')}.")
    if places:
        found = [one for one in found if not one.startswith(THESIS)]
        found.append(f"{THESIS}: {'; '.join(dict.fromkeys(places))}.")
    return list(dict.fromkeys(found))
