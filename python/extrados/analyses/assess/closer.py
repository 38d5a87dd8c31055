"""Further runs where strategies differ, or a margin is thin: the cause of the difference, and the factor at which a verdict changes."""

import numpy as np

from extrados.analyses.assess import hazard, strategies
from extrados.analyses.assess.asking import scaled_margin
from extrados.analyses.assess.facts import SLID, Pair
from extrados.analyses.assess.reasons_of_statics import static_peak
from extrados.analyses.assess.strategies import Choice
from extrados.analyses.assess.work import ONE_RUN, Work, merge_keys
from extrados.analyses.codes.actions import fits
from extrados.model.structures.masonry import Column
from extrados.motions.tables import Compatible
from extrados.results.codes import Checked
from extrados.results.dem import DemRun
from extrados.results.rocking import Assessment
from extrados.results.statistics import OverLevels
from extrados.schema.code import ACTION

#: Factors on the hazard at which discrete elements are tried, from 1 up while they stand, down while they fall
UP, DOWN = (1.25, 1.5, 2.0, 3.0, 4.0), (0.8, 0.65, 0.5, 0.35, 0.25)
#: Keys of the demand that the motion replaces: of the codes' analysis, and of [code]
OF_SITE = ("spectrum", "collapse_spectrum", "peak_acceleration", "peak_velocity")
OF_CODE = {"return_periods", *(key for keys in ACTION.values() for key in keys)}
#: Factors between two of the first ones, where the margin of rocking is thin
FINE = 16


def _is_thin(work: Work, name: str) -> bool:
    """Whether the margin of a strategy may be near 1."""
    low, high = work.facts().interval(name)
    return high > 1.0 / work.options.thin and low < work.options.thin


def refine(work: Work) -> None:
    """Where strategies differ, or a margin is thin: what shows why, and how far the costly ones are from turning."""
    facts = work.facts()
    pairs = facts.pairs()
    thin = [n for n in facts.judged() if facts.interval(n) != (0.0, np.inf) and _is_thin(work, n)]
    if not pairs and not thin:
        return
    if "rocking" in thin and not work.many:
        _finer(work)
    _cheap_probes(work, pairs)
    static_peak(facts, pairs)  # calculates the shortest constant push before further runs use up the budget
    _elements(work, pairs)
    work.context.progress(3.0, 3.0, "assess")


def _codes_by_motion(work: Work) -> None:
    """The codes with the motion in place of the site, at the limit state of their governing check; not if they check the motion already,
    or a target spectrum that it matches."""
    found, deck = work.results.get("code-checks"), work.context.deck
    if found is None or not isinstance(r := found.results, Checked) or not (rows := r.governing()) or not (state := rows[0][2].limit_state):
        return
    keys, code = work.choices["code-checks"].keys, deck.code
    of_site = set(keys) & set(OF_SITE) or (code is not None and any(code.spectrum(one) is not None for one in code.states))
    if not of_site or (isinstance(deck.motion, Compatible) and fits(code, deck.motion)):
        return
    if deck.motion is not None and deck.motion.floor is not None and r.jurisdiction != "NTC":
        return  # the coefficients of height of these codes belong to the ground
    keys = {k: v for k, v in keys.items() if k not in OF_SITE} | {"motion_spectrum": True}
    table = {k: v for k, v in deck.data.get("code", {"jurisdiction": "NTC"}).items() if k not in OF_CODE} | {"limit_states": [state]}
    told = f"the spectrum of the motion instead of the spectrum of the site, at {state}"
    work.keep("codes-motion", work.probe("code-checks", told, found.kind, keys, changes={"code": table}))


def _finer(work: Work) -> None:
    """The margin of rocking closer, between the factors that enclose it."""
    row = work.rows["rocking"]
    low, high = row.margin_at_least, row.margin_below
    if low is None or high is None:
        return
    levels = [round(float(v), 5) for v in np.linspace(low, high, FINE + 2)]
    found = work.probe(
        "rocking",
        f"the motion at {FINE} scale factors between {low:g} and {high:g}",
        "fragility",
        {"intensity": "scale", "levels": levels, "bootstrap": 0},
        tell=False,
    )
    if found is not None and isinstance(found.results, OverLevels):
        lower, upper = scaled_margin(found.of(OverLevels))
        work.bracket("rocking", lower or low, upper or high)


def _cheap_probes(work: Work, pairs: list[Pair]) -> None:
    names = {n for p in pairs for n in p}
    results = work.results
    if any("code-checks" in p for p in pairs):
        _codes_by_motion(work)
    if "assessment" in names and (impulse := results["assessment"].of(Assessment).primary_impulse) is not None:
        sine = {"kind": "sine-pulse", "amplitude": f"{impulse.amplitude_g!r} g", "period": impulse.period_s}
        work.keep("sine", work.probe("rocking", "the primary impulse alone, as a single sine", "rocking", {}, sine))
    if "sla" in names and "tilt" in results and not work.context.building.meshed_by_stones:
        keys = {"joints": {"friction": "no-sliding"}}
        work.keep("tilt-no-sliding", work.probe("tilt", "no joint slides", "tilt", keys))

    if "[[ties]]" in work.bare.get("sla", ()) and {"sla", "tilt"} <= set(results):
        work.keep(
            "tilt-without",
            work.probe(
                "tilt", "without the restraints that the finite-element analysis (sla) neglects", "tilt", {}, without=work.bare["sla"]
            ),
        )
    if work.bare and "rocking" in results and any(n in names for n in work.bare):
        every = tuple(sorted({w for there in work.bare.values() for w in there}))
        told = f"without {' and '.join(every)}"
        work.keep("without-restraints", work.probe("rocking", told, "rocking", {}, without=every))


def _elements(work: Work, pairs: list[Pair]) -> None:
    """Further runs of discrete elements, as many as the nominal budget still holds."""
    if "dem" not in work.results:
        return
    choice, building = work.choices["dem"], work.context.building
    each = max(choice.seconds, 1e-3)
    left = int(strategies.REFINING * work.options.for_strategies / each) - 1  # the perturbed run of the first
    names = {n for p in pairs for n in p}
    r = work.results["dem"].results
    if not isinstance(r, DemRun):
        return
    structure = building.structure
    if isinstance(structure, Column) and structure.height is not None and structure.drums > 1 and "dem" in names:
        changes = {"structure.drums": 1}
        work.keep("monolith", work.probe("dem", "one body instead of drums", "dem", choice.keys | ONE_RUN, None, changes))
    slid = r.peak_slip_m > SLID * float(building.blocks().length.min())
    if slid and "dem" in names and not any(t.friction is not None for t in building.joints.types):
        if left < 1:
            work.not_done.append("discrete elements without sliding")
        else:
            left -= 1
            keys = merge_keys(choice.keys, {"joints": {"friction": "no-sliding"}} | ONE_RUN)
            work.keep("no-sliding", work.probe("dem", "no joint slides", "dem", keys))
    if not r.decided_by_last_digits:
        _turning(work, left, choice)


def _turning(work: Work, left: int, choice: Choice) -> None:
    """The factors on the hazard between which discrete elements turn to fall."""
    motion, model = work.asker.motion, work.one_motion().deck.require_motion()
    stands = work.rows["dem"].outcome == "stands"
    low, high = (1.0, None) if stands else (None, 1.0)
    if work.rows["dem"].outcome == "open":
        low = high = None
    for factor in UP if stands else DOWN:
        table = hazard.scaled(motion, model, factor)
        if table is None:
            work.not_done.append(
                "discrete elements were not run at other scale factors, because the code spectrum of the motion "
                "cannot be scaled: this spectrum is not given by one acceleration"
            )
            break
        if left < 1:
            work.not_done.append(f"discrete elements at {factor:g} times the motion and at larger factors")
            break
        left -= 1
        found = work.probe("dem", f"the motion times {factor:g}", "dem", choice.keys | ONE_RUN, table)
        if found is None:
            break
        if found.results.require_verdict(work.asker.demand(work.peak)).outcome == "open":
            work.not_done.append(f"discrete elements at {factor:g} times the motion still move at the end of the run")
            break
        falls = found.of(DemRun).outcome == "collapse"
        low, high = (low, factor) if falls else (factor, high)
        if falls == stands:
            break
    work.bracket("dem", low, high)
