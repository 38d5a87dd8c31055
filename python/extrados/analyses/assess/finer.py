"""Finer checks of two strategies that contradict each other without a reason: rigid contacts, half the step, perturbed motions."""

from typing import Any

from extrados.analyses.assess import hazard, strategies
from extrados.analyses.assess.budget import OutOfTime
from extrados.analyses.assess.reasons import explained
from extrados.analyses.assess.work import ONE_RUN, Work
from extrados.analyses.dem.tables import OF_SPRINGS

#: Factors on the motion in a finer check
PERTURBED = (0.999, 1.001)


def check_finer(work: Work) -> None:
    """Where two strategies contradict each other without a reason: rigid contacts, half the step, perturbed motions."""
    facts = work.facts()
    _, unexplained = explained(facts, lambda rule, error: None)  # `conclude` reports a rule that fails
    names = {n for p in unexplained if facts.relation(*p) == "disagree" for n in p}
    try:
        for name in (n for n in ("rocking", "dem") if n in names and n in work.results):
            _check_run(work, name)
    finally:
        _tell_finer(work, names)


def _tell_finer(work: Work, names: set[str]) -> None:
    """State which finer checks ran for strategies that contradict each other."""
    if names:
        ran = [f"{work.rows[n].label} with {', '.join(told)}" for n, told in work.finer.items()]
        work.finer_told = (
            f"Strategies that contradict each other were run again with finer settings: {' and '.join(ran)}."
            if ran
            else (
                "The results of these strategies contradict each other, and none was run again with finer settings: "
                f"{' and '.join(sorted(work.rows[n].label for n in names))}."
            )
        )


def _check_run(work: Work, name: str) -> None:
    """Run a dynamic strategy anew with finer settings; another outcome leaves its own open."""
    row, keys = work.rows[name], work.choices[name].keys
    runs: list[tuple[str, dict[str, Any], float]] = []
    if name == "dem":
        half = {"time_step": 0.5 * work.results[name]["time_step_s"]}
        runs.append(("rigid contacts", _rigid(keys) | ONE_RUN, 1.0))
        runs.append(("half the time step", keys | half | ONE_RUN, 1.0))
        keys = keys | ONE_RUN
    else:
        runs.append(("a tolerance of 1e-10", keys | {"tolerance": 1e-10}, 1.0))
    runs += [(f"the motion times {factor:g}", keys, factor) for factor in PERTURBED]
    other: list[str] = []
    for told, changed, factor in runs:
        model = work.one_motion().deck.require_motion()
        motion = None if factor == 1.0 else hazard.scaled(work.asker.motion, model, factor)
        if factor != 1.0 and motion is None:
            continue
        if work.asker.clock() >= work.asker.deadline:
            raise OutOfTime
        found = work.probe(name, told, work.choices[name].kind or strategies.of(name).kind, changed, motion)
        if found is None:
            continue
        work.finer.setdefault(name, []).append(f"{told} ({work.probes[-1].outcome})")
        if {work.probes[-1].outcome, row.outcome} == {"stands", "collapses"}:
            other.append(f"{told} ({work.probes[-1].outcome})")
    if other:
        text = f"A finer check gives another outcome: {', '.join(other)}."
        work.rows[name] = row.model_copy(
            update={"outcome": "open", "violated": [*row.violated, text], "statement": f"{row.statement} {text}"}
        )


def _rigid(keys: dict[str, Any]) -> dict[str, Any]:
    """Keys of a run of discrete elements on rigid contacts, which have no springs."""
    joints = {k: v for k, v in keys.get("joints", {}).items() if f"joints.{k}" not in OF_SPRINGS}
    kept = {k: v for k, v in keys.items() if k not in ("joints", "fraction", "mass_damping", "time_step")}
    return kept | ({"joints": joints} if joints else {}) | {"solver": "nonsmooth"}
