"""The rules that say why strategies differ: each with numbers that show it, and with each of them taken away, when it is silent."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from extrados.analyses.assess.facts import HEADLINES, Facts
from extrados.analyses.assess.reasons import RULES, explained
from extrados.decks.reader import make_deck
from extrados.model.structures.plan import Plan
from extrados.motions import pulses
from extrados.results.assess import StrategyVerdict
from extrados.results.codes import Check, CodeChecks, LocalMechanism, WallMechanism
from extrados.results.dem import DemRun
from extrados.results.frame import FramePush, FramePushover
from extrados.results.limit import Fracture, NonDilatant, Tilt
from extrados.results.model import Array, Result
from extrados.results.rocking import Assessment, Rocking
from extrados.results.shell import Pushover
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building

COLUMN = {"kind": "column", "width": 1.2, "height": 6.0, "drums": 3}
PANEL = {"kind": "panel", "width": 4.8, "height": 3.2, "thickness": 0.4, "unit_length": 0.8, "unit_height": 0.4}
PEAK = 0.4


def building(**tables: dict) -> Building:
    return make_deck({"structure": COLUMN, **tables, "analysis": [{"kind": "tilt"}]}).building


def row(strategy: str, outcome: str, **more: object) -> StrategyVerdict:
    keys = {
        "label": strategy,
        "part": None,
        "status": "ok",
        "reason": "",
        "axis": "acceleration",
        "unit": "g",
        "capacity": None,
        "demand": None,
        "margin": None,
        "margin_at_least": None,
        "margin_below": None,
        "parameters": "",
        "assumes": "",
        "statement": "",
        "violated": [],
    }
    return StrategyVerdict(strategy=strategy, outcome=outcome, bound=None, **(keys | more))


# Results with no more than what a rule reads: one that reads more fails at once.


def rocking(outcome: str = "recovery", ratio: float = 0.3, arrays: dict | None = None, **more: object) -> Result:
    keys = {"outcome": outcome, "peak_rotation_ratio": ratio, "outcomes_by_rule": [], "decided_by_last_digits": False}
    return Result("rocking", results=Rocking.model_construct(**(keys | more)), arrays=arrays or {})


def dem(outcome: str = "recovery", moved: float = 0.1, slip: float = 0.0, **more: object) -> Result:
    keys = {
        "outcome": outcome,
        "peak_displacement_m": moved,
        "collapse_displacement_m": 1.0,
        "peak_slip_m": slip,
        "decided_by_last_digits": False,
        "perturbation_growth": 10.0,
        "perturbed_outcome": outcome,
    }
    return Result("dem", results=DemRun.model_construct(**(keys | more)))


def tilt(right: float, left: float | None = None, fracture: Fracture | None = None, dilating: list[int] | None = None) -> Result:
    sliding = (
        {}
        if dilating is None
        else {
            "dilating_joints": dilating,
            "dilating_joints_opposite": dilating,
            "collapse_acceleration_non_associated_g": right,
            "collapse_acceleration_non_associated_opposite_g": right,
            "non_dilatant": NonDilatant.model_construct(associated_g=right),
            "non_dilatant_opposite": NonDilatant.model_construct(associated_g=right),
        }
    )
    keys = {
        "collapse_acceleration_g": right,
        "collapse_acceleration_opposite_g": right if left is None else left,
        "fracture": fracture,
        **sliding,
    }
    return Result("tilt", results=Tilt.model_construct(**keys))


def checked(capacity: float, demand: float | None = 0.3, multiplier: float | None = None, part: float = 1.0, **more: Check) -> Result:
    checks = {"NTC linear (at the ground)": check(capacity, demand), **more}
    factors = {"behaviour_factor": 2.43, "confidence_factor": 1.35}
    if multiplier is None:
        return Result("code-checks", results=CodeChecks.model_construct(checks=checks, **factors))
    turning = LocalMechanism.model_construct(checks=checks, multiplier=multiplier, participating_part=part, **factors)
    return Result("local-mechanism", results=turning)


def check(capacity: float, demand: float | None, unit: str = "g", code: str = "NTC 2018") -> Check:
    verdict = "" if demand is None else "holds" if capacity >= demand else "fails"
    alternative = "SLV" if code == "NTC 2018" else ""
    return Check(
        capacity=capacity,
        demand=demand,
        unit=unit,
        quantity="",
        verdict=verdict,
        source="",
        note="",
        code=code,
        limit_state="SLV" if alternative else "",
        scope="",
        reason="",
        alternative=alternative,
    )


def walls(multiplier: float) -> Result:
    """Of the codes: one wall that turns by itself."""
    one = WallMechanism.model_construct(wall="back", storey=1, multiplier=multiplier)
    checks = {"NTC linear (at the ground)": check(0.1, 0.3)}
    return Result("local-mechanism", results=LocalMechanism.model_construct(checks=checks, multiplier=multiplier, walls=[one]))


def framed(peak: float) -> Result:
    """Of a frame: one push along x by its masses."""
    one = FramePush.model_construct(direction_deg=0.0, pattern="uniform", eccentricity=0.0, peak_base_shear_N=peak)
    return Result("frame-pushover", results=FramePushover.model_construct(runs=[one]))


def shells(load: float) -> Result:
    """Of shells: a push along x past its peak."""
    return Result("pushover", results=Pushover.model_construct(greatest_load_N=load, peak_load_N=load, walls=[]))


def house(across: float) -> Building:
    """Two walls of 4 m and 0.4 m along x, two of another thickness along y."""
    corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]
    sides = [{"name": str(k), "start": corners[k], "end": corners[(k + 1) % 4], "thickness": (0.4, across)[k % 2]} for k in range(4)]
    return Building(Plan(kind="building", storeys=[3.0], walls=sides))


def criterion(verdict: str) -> Result:
    impulse = {"amplitude_g": 0.3, "period_s": 0.5, "goodness_of_fit": 0.6}
    sine = type("Impulse", (), impulse)()
    return Result("assessment", results=Assessment.model_construct(verdict=verdict, primary_impulse=sine))


def facts(rows: list[StrategyVerdict], results: dict[str, Result] | None = None, **more: object) -> Facts:
    keys = {"building": building(), "motion": pulses.sine_pulse(PEAK * GRAVITY, 1.2), "peak_g": PEAK, "apart": 1.5}
    return Facts(rows={r.strategy: r for r in rows}, results=results or {}, **(keys | more))


def having(f: Facts, **changed: Result | None) -> Facts:
    """The same with other results of strategies; None: without."""
    results = {**f.results, **changed}
    return replace(f, results={name: r for name, r in results.items() if r is not None})


def probed(f: Facts, **changed: Result | None) -> Facts:
    probes = {**f.probes, **{name.replace("_", "-"): r for name, r in changed.items()}}
    return replace(f, probes={name: r for name, r in probes.items() if r is not None})


def rated(f: Facts, *rows: StrategyVerdict) -> Facts:
    return replace(f, rows={**f.rows, **{r.strategy: r for r in rows}})


def by_rule(*outcomes: str) -> list:
    made = zip(("thesis", "inelastic"), (0.9, 0.6), outcomes, strict=True)
    return [type("Outcome", (), {"rule": rule, "restitution": c, "outcome": outcome})() for rule, c, outcome in made]


# Each scenario shows its rule; each of its spoils takes one number away.

FALLS, STANDS = row("tilt", "collapses", capacity=0.2, demand=PEAK, margin=0.5), row("rocking", "stands")
DYNAMIC = [row("rocking", "stands"), row("dem", "collapses")]


def outside(share: float, far: float = 0.3) -> dict:
    """A thrust line that lies outside the stones in a share of a hundred states."""
    position = np.full((100, 4), 0.5)
    position[: round(100 * share), 1] = 1.0 + far
    return {"thrust_position": Array(position, ("time", "joint"), "")}


Spoil = Callable[[Facts], Facts]
SCENARIOS: dict[str, tuple[str, Callable[[], Facts], dict[str, Spoil]]] = {
    "a push too short": (
        "static-peak",
        lambda: facts([FALLS, STANDS], {"rocking": rocking()}, needed_s=lambda a: 0.5),
        {
            "the excursion is long enough": lambda f: replace(f, needed_s=lambda a: 0.39),
            "statics says no less": lambda f: rated(f, row("tilt", "stands", capacity=0.5, margin=1.25)),
            "its capacity is not known": lambda f: rated(f, row("tilt", "collapses", margin=0.5)),
        },
    ),
    "no passage long enough for what it holds": (
        "static-peak",
        lambda: facts([FALLS, STANDS], {"rocking": rocking()}, needed_s=lambda a: 0.39 if a > 0.35 else 0.6),
        {
            "its mean needs no longer": lambda f: replace(f, needed_s=lambda a: 0.39),
            "its mean is not known to bring it down": lambda f: replace(f, needed_s=lambda a: 0.39 if a > 0.35 else None),
        },
    ),
    "stones that hardly move in that time": (
        "static-peak",
        lambda: facts([FALLS, row("dem", "stands")], {"dem": dem(moved=0.1)}),
        {
            "they nearly fell": lambda f: having(f, dem=dem(moved=0.6)),
            "they fell": lambda f: having(f, dem=dem("collapse", 0.1)),
            "the motion never passes the capacity": lambda f: replace(f, motion=pulses.sine_pulse(0.1 * GRAVITY, 1.2)),
            "rocking knows a needed time": lambda f: having(f, rocking=rocking()),
        },
    ),
    "a cracked buttress": (
        "crack",
        lambda: facts([FALLS, STANDS], {"tilt": tilt(0.5, fracture=Fracture(collapse_acceleration_g=0.2))}),
        {
            "it was not asked to crack": lambda f: having(f, tilt=tilt(0.5)),
            "it would fall in one piece too": lambda f: having(f, tilt=tilt(0.35, fracture=Fracture(collapse_acceleration_g=0.2))),
            "the crack takes nothing": lambda f: having(f, tilt=tilt(0.5, fracture=Fracture(collapse_acceleration_g=0.5))),
            "limit analysis is the one that stands": lambda f: rated(f, row("tilt", "stands"), row("rocking", "collapses")),
        },
    ),
    "ties that others leave out": (
        "left-out",
        lambda: facts(
            [STANDS, row("dem", "collapses")],
            {"rocking": rocking(ratio=0.1)},
            bare={"dem": ("[[ties]]",)},
            probes={"without-restraints": rocking("collapse", 2.0)},
        ),
        {
            "none is left out": lambda f: replace(f, bare={}),
            "without them it turns no farther": lambda f: probed(f, without_restraints=rocking(ratio=0.11)),
            "nobody tried it without": lambda f: probed(f, without_restraints=None),
            "it was tried without more than they leave out": lambda f: replace(
                f, bare={**f.bare, "sla": ("[[ties]]", "[supports] abutting_wall")}
            ),
        },
    ),
    "ties of statics": (
        "left-out",
        lambda: facts(
            [row("tilt", "stands", capacity=0.5, margin=1.25), row("sla", "collapses", capacity=0.3, margin=0.75)],
            bare={"sla": ("[[ties]]",)},
            probes={"tilt-without": tilt(0.31)},
        ),
        {
            "without them it says otherwise than the elements": lambda f: probed(f, tilt_without=tilt(0.42)),
            "a wall lets only the other sense count": lambda f: replace(
                probed(f, tilt_without=tilt(0.42, 0.31)),
                building=building(structure={"kind": "block", "width": 1.0, "height": 5.0}, supports={"abutting_wall": "left"}),
            ),
            "the elements know them": lambda f: replace(f, bare={}),
        },
    ),
    "impact rules": (
        "impact-rule",
        lambda: facts(DYNAMIC, {"rocking": rocking(outcomes_by_rule=by_rule("collapse", "recovery"))}),
        {
            "all rules stand": lambda f: having(f, rocking=rocking(outcomes_by_rule=by_rule("recovery", "recovery"))),
            "all rules fall": lambda f: having(f, rocking=rocking(outcomes_by_rule=by_rule("collapse", "collapse"))),
            "rocking differs from statics alone": lambda f: replace(f, rows={r.strategy: r for r in (FALLS, STANDS)}),
        },
    ),
    "last digits of rocking": (
        "last-digits",
        lambda: facts(DYNAMIC, {"rocking": rocking(decided_by_last_digits=True)}),
        {"they do not decide": lambda f: having(f, rocking=rocking())},
    ),
    "last digits of elements": (
        "last-digits",
        lambda: facts([STANDS, row("dem", "open")], {"dem": dem(decided_by_last_digits=True, perturbed_outcome="collapse")}),
        {
            "the perturbed motion ends alike": lambda f: having(f, dem=dem()),
            "elements say as the others do": lambda f: rated(f, row("dem", "stands")),
        },
    ),
    "an assumption that does not hold": (
        "violated",
        lambda: facts([FALLS, row("rocking", "open", violated=["Friction is too low."])]),
        {
            "all hold": lambda f: rated(f, row("rocking", "open")),
            "both are open": lambda f: rated(f, row("tilt", "open")),
            "it is decided all the same": lambda f: rated(f, row("rocking", "stands", violated=["Friction is too low."])),
        },
    ),
    "one sine for the whole motion": (
        "sine-for-record",
        lambda: facts(
            [row("assessment", "stands"), row("rocking", "collapses")],
            {"assessment": criterion("stands"), "rocking": rocking("collapse", 2.0)},
            probes={"sine": rocking(ratio=0.2)},
        ),
        {
            "under the sine it falls, against the criterion": lambda f: probed(f, sine=rocking("collapse", 2.0)),
            "the motion turns it no farther than the sine": lambda f: probed(
                having(f, rocking=rocking(ratio=0.21)), sine=rocking(ratio=0.2)
            ),
            "nobody tried the sine": lambda f: probed(f, sine=None),
        },
    ),
    "stones that slide": (
        "sliding",
        lambda: facts(DYNAMIC, {"rocking": rocking(), "dem": dem("collapse", 1.0, slip=0.1)}, probes={"no-sliding": dem(moved=0.1)}),
        {
            "they hardly slid": lambda f: having(f, dem=dem("collapse", 1.0, slip=0.005)),
            "without sliding they end alike": lambda f: probed(f, no_sliding=dem("collapse", 0.9)),
            "nobody tried without": lambda f: probed(f, no_sliding=None),
            "the run is one draw of many": lambda f: having(f, dem=dem("collapse", 1.0, slip=0.1, decided_by_last_digits=True)),
        },
    ),
    "sliding that statics counts as collapse": (
        "sliding",
        lambda: facts([FALLS, row("dem", "stands")], {"tilt": tilt(0.2, dilating=[0]), "dem": dem(moved=0.014, slip=0.014)}),
        {
            "no pressed joint slides": lambda f: having(f, tilt=tilt(0.2)),
            "the blocks rock rather than slide": lambda f: having(f, dem=dem(moved=0.1, slip=0.014)),
            "they collapse": lambda f: having(rated(f, row("dem", "open")), dem=dem("collapse", 0.014, slip=0.014)),
            "the run is one draw of many": lambda f: having(f, dem=dem(moved=0.014, slip=0.014, decided_by_last_digits=True)),
        },
    ),
    "stones apart": (
        "drums",
        lambda: facts(DYNAMIC, {"rocking": rocking(), "dem": dem("collapse", 1.0)}, probes={"monolith": dem(moved=0.1)}),
        {
            "as one body they fall, and rocking stands": lambda f: probed(f, monolith=dem("collapse", 1.0)),
            "apart they do as one body does": lambda f: having(probed(f, monolith=dem("collapse", 1.0)), rocking=rocking("collapse", 2.0)),
            "nobody tried one body": lambda f: probed(f, monolith=None),
            "the run is one draw of many": lambda f: having(f, dem=dem("collapse", 1.0, slip=0.1, decided_by_last_digits=True)),
        },
    ),
    "hinges elsewhere": (
        "hinges-elsewhere",
        lambda: facts(DYNAMIC, {"rocking": rocking(arrays=outside(0.2)), "dem": dem("collapse")}),
        {
            "the thrust line leaves them rarely": lambda f: having(f, rocking=rocking(arrays=outside(0.05))),
            "by nothing": lambda f: having(f, rocking=rocking(arrays=outside(0.2, far=0.005))),
            "it is not known": lambda f: having(f, rocking=rocking()),
        },
    ),
    "a wall of elements that cannot slide": (
        "membrane-without-sliding",
        lambda: facts(
            [FALLS, row("sla", "stands", capacity=0.55, margin=1.4)],
            {"tilt": tilt(0.2)},
            building=building(structure=PANEL),
            probes={"tilt-no-sliding": tilt(0.6)},
        ),
        {
            "sliding takes nothing": lambda f: probed(f, tilt_no_sliding=tilt(0.205)),
            "the elements are nearer to what slides": lambda f: probed(f, tilt_no_sliding=tilt(2.0)),
            "the elements are the stones": lambda f: replace(f, building=building()),
        },
    ),
    "elements that bear tension": (
        "tension",
        lambda: facts(
            [FALLS, row("sla", "stands", capacity=0.55, margin=1.4)],
            {"tilt": tilt(0.2)},
            building=building(structure=PANEL, material={"tensile_strength": 1e5, "fracture_energy": 10.0}),
        ),
        {
            "they bear none": lambda f: replace(f, building=building(structure=PANEL)),
            "they bear less than the stones": lambda f: having(f, tilt=tilt(0.6)),
        },
    ),
    "mortar": (
        "mortar",
        lambda: facts(
            [STANDS, row("dem", "stands", margin_at_least=3.0), FALLS], building=building(joints={"tension": 1e5, "cohesion": 1e5})
        ),
        {
            "joints are dry": lambda f: replace(f, building=building()),
            "the elements bear less": lambda f: rated(f, row("dem", "collapses"), row("tilt", "stands", margin=1.25)),
        },
    ),
    "factors of codes": (
        "code-factors",
        lambda: facts([FALLS, row("code-checks", "stands", margin=1.2)], {"tilt": tilt(0.2), "code-checks": checked(0.36)}),
        {
            "they cancel": lambda f: having(f, **{"code-checks": checked(0.205)}),
            "the code asks nothing": lambda f: having(f, **{"code-checks": checked(0.36, None)}),
            "both agree": lambda f: rated(f, row("code-checks", "collapses", margin=0.55)),
            "the code turns another mechanism": lambda f: having(f, **{"code-checks": checked(0.45, multiplier=0.25)}),
            "its capacity is not what its factors give": lambda f: having(f, **{"code-checks": checked(1.8)}),
            "its e* is not that of its capacity": lambda f: having(f, **{"code-checks": checked(0.36, multiplier=0.2, part=0.4)}),
        },
    ),
    "a displacement that the code allows": (
        "code-check",
        lambda: facts(
            [FALLS, row("code-checks", "stands", margin=4.0)],
            {"tilt": tilt(0.2), "code-checks": checked(0.24, nonlinear=check(0.8, 0.2, "m"))},
        ),
        {
            "the linear check says the same": lambda f: having(f, **{"code-checks": checked(1.0, nonlinear=check(0.8, 0.2, "m"))}),
            "it has no demand": lambda f: having(f, **{"code-checks": checked(0.24, None, nonlinear=check(0.8, 0.2, "m"))}),
            "the linear check governs": lambda f: having(f, **{"code-checks": checked(0.24, nonlinear=check(0.8, 2.0, "m"))}),
            "both agree": lambda f: rated(f, row("code-checks", "collapses", margin=0.5)),
            "the multiplier turns no verdict": lambda f: having(f, **{"code-checks": checked(0.32, nonlinear=check(0.8, 0.2, "m"))}),
        },
    ),
    "a code that allows less than another": (
        "code-check",
        lambda: facts(
            [STANDS, row("code-checks", "collapses", margin=0.4)], {"code-checks": checked(0.36, asce=check(0.12, 0.3, "g", "ASCE 43"))}
        ),
        {
            "the other says the same": lambda f: having(f, **{"code-checks": checked(0.14, asce=check(0.12, 0.3, "g", "ASCE 43"))}),
            "there is no other": lambda f: having(f, **{"code-checks": checked(0.36, None, asce=check(0.12, 0.3, "g", "ASCE 43"))}),
        },
    ),
    "the spectrum of the site": (
        "code-spectrum",
        lambda: facts(
            [row("rocking", "stands", margin=1.5), row("code-checks", "collapses", margin=0.5)],
            {"code-checks": checked(0.15)},
            probes={"codes-motion": checked(0.15, 0.1)},
        ),
        {
            "the codes check the motion": lambda f: replace(f, probes={}),
            "the motion is hardly weaker": lambda f: probed(f, codes_motion=checked(0.15, 0.2)),
            "the motion gives this check no demand": lambda f: probed(f, codes_motion=checked(0.15, None)),
            "another limit state fails": lambda f: having(
                f, **{"code-checks": checked(0.15, other=check(0.12, 0.2).model_copy(update={"limit_state": "SLD"}))}
            ),
            "both agree": lambda f: rated(f, row("code-checks", "stands", margin=1.2)),
        },
    ),
    "the peak of the motion": (
        "code-spectrum",
        lambda: facts(
            [row("sla", "stands", margin=1.25, demand=PEAK), row("code-checks", "collapses", margin=0.5)],
            {"code-checks": checked(0.15)},
            probes={"codes-motion": checked(0.15, 0.1)},
        ),
        {
            "statics applies the site too": lambda f: rated(f, row("sla", "stands", margin=1.25, demand=2.0 * PEAK)),
            "statics compares a displacement": lambda f: rated(f, row("sla", "stands", margin=1.25, demand=PEAK, unit="m")),
        },
    ),
    "margins that the spectrum sets apart": (
        "code-spectrum",
        lambda: facts(
            [row("rocking", "stands", margin=4.0), row("code-checks", "stands", margin=1.1)],
            {"code-checks": checked(0.33)},
            probes={"codes-motion": checked(0.33, 0.1)},
        ),
        {
            "they remain apart": lambda f: probed(f, codes_motion=checked(0.33, 0.2)),
            "they are apart the other way": lambda f: probed(f, codes_motion=checked(0.33, 0.01)),
        },
    ),
    "a wall that the codes tear off": (
        "torn-off",
        lambda: facts(
            [row("code-checks", "collapses", margin=0.3), row("push-x", "stands", capacity=0.6, margin=1.5)], {"code-checks": walls(0.05)}
        ),
        {
            "it bears more by itself than the whole": lambda f: having(f, **{"code-checks": walls(0.7)}),
            "no wall was taken apart": lambda f: having(f, **{"code-checks": checked(0.1)}),
            "the codes bear more": lambda f: rated(
                f, row("code-checks", "stands", margin=2.0), row("push-x", "collapses", capacity=0.2, margin=0.5)
            ),
            "how far the push came is not known": lambda f: rated(f, row("push-x", "stands")),
        },
    ),
    "less masonry along one axis": (
        "weaker-direction",
        lambda: facts([row("push-x", "stands", margin=2.5), row("push-y", "collapses", margin=0.8)], building=house(0.2)),
        {
            "more of it along that axis": lambda f: replace(f, building=house(0.6)),
            "it is no plan": lambda f: replace(f, building=building()),
        },
    ),
    "a frame that carries less than the shells": (
        "frame-and-shells",
        lambda: facts(
            [row("frame", "collapses", margin=0.8), row("push-x", "stands", margin=1.6)], {"frame": framed(100e3), "push-x": shells(130e3)}
        ),
        {
            "they differ by less than 15 %": lambda f: having(f, **{"push-x": shells(114e3)}),
            "the shells are not pushed": lambda f: replace(f, results={"frame": framed(100e3)}),
        },
    ),
    "chance": (
        "chance",
        lambda: facts([STANDS, row("probability", "open", demand=0.4, capacity=0.05, parameters="64 buildings (coefficients)")]),
        {
            "all fall": lambda f: rated(f, row("probability", "collapses", demand=0.99)),
            "none falls": lambda f: rated(f, row("probability", "stands", demand=0.01), row("rocking", "collapses")),
            "it differs from statics alone": lambda f: replace(f, rows={r.strategy: r for r in (FALLS, f.rows["probability"])}),
        },
    ),
}


def said(f: Facts) -> set[str]:
    return {one.rule for one in explained(f)[0]}


@pytest.mark.parametrize("name", SCENARIOS)
def test_a_rule_speaks_where_its_numbers_show_it(name: str) -> None:
    rule, make, _ = SCENARIOS[name]
    found, _ = explained(make())
    (one,) = [r for r in found if r.rule == rule]
    assert one.headline == HEADLINES[rule] and one.text and one.explains
    pairs = make().pairs()
    assert all(tuple(p) in pairs for p in one.explains), "of pairs that do not agree"


@pytest.mark.parametrize(("name", "spoil"), [(name, spoil) for name, (_, _, spoils) in SCENARIOS.items() for spoil in spoils])
def test_it_is_silent_where_one_of_them_is_missing(name: str, spoil: str) -> None:
    rule, make, spoils = SCENARIOS[name]
    assert rule not in said(spoils[spoil](make()))


def test_every_rule_has_its_scenario() -> None:
    assert {rule for rule, _, _ in SCENARIOS.values()} == set(HEADLINES)
    spoken = {name: [r for r in RULES if r(make(), make().pairs())] for name, (_, make, _) in SCENARIOS.items()}
    assert {rule for rules in spoken.values() for rule in rules} == set(RULES), "each function speaks in one at least"


def test_the_codes_are_held_against_the_sense_that_no_wall_stops() -> None:
    """The factor told is that between the two numbers told."""
    held = building(structure={"kind": "block", "width": 1.0, "height": 5.0}, supports={"abutting_wall": "left"})
    rows = [row("tilt", "collapses", capacity=0.2, margin=0.5), row("code-checks", "stands", margin=1.2)]
    found, _ = explained(facts(rows, {"tilt": tilt(0.2, 0.07), "code-checks": checked(0.36)}, building=held))
    (one,) = found
    assert one.numbers["static_capacity"] == 0.2 and one.numbers["factor"] == pytest.approx(1.8)
    assert "by statics, 0.2 g, multiplied by 1.8" in one.text


def test_elements_that_slide_explain_the_stones_of_statics_and_of_the_mesh_alike() -> None:
    rows = [row(n, "collapses", capacity=0.2, margin=0.5) for n in ("tilt", "sla")] + [row("dem", "stands")]
    f = facts(rows, {"dem": dem(slip=0.3)}, probes={"no-sliding": dem(moved=1e-6)})
    (slides,) = (r for r in explained(f)[0] if r.rule == "sliding")
    assert slides.explains == [["tilt", "dem"], ["sla", "dem"]]


def test_a_pair_without_a_reason_is_reported_as_unexplained() -> None:
    f = facts([FALLS, STANDS], {"rocking": rocking()}, needed_s=lambda a: 0.1)
    assert explained(f) == ([], [("tilt", "rocking")])
