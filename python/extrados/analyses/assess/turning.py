"""Sensitivity of an assessment: values of the deck moved one by one, those of discrete elements among them, and where verdicts change."""

from collections.abc import Callable
from typing import Any

import numpy as np

from extrados.analyses.assess import sensitivity, strategies
from extrados.analyses.assess.budget import Interrupted, OutOfTime
from extrados.analyses.assess.work import Work, merge_keys
from extrados.analyses.batches import Unfinished
from extrados.results import assess as out
from extrados.results.dem import DemRun
from extrados.results.rocking import Rocking as RockingResults

#: Elements with joints so many times as stiff and as soft; a support that moves by this part of the size; halvings of the
#: interval in which elements turn
STIFFER, SPREAD = 4.0, 0.002
ELEMENT_HALVINGS = 3


def move_values(work: Work) -> None:
    """Margins with values of the deck moved one by one, as many as the budget allows."""
    if not strategies.of("tilt").applies(work.context.building):
        work.not_done.append(
            "sensitivity: limit analysis and rocking cannot analyse a building in plan; use the key `variants` of `pushover`"
        )
        return
    rocked = work.results.get("rocking")
    restitution = rocked.of(RockingResults).restitution if rocked is not None else None
    keys = sensitivity.varied(work.context.building, work.options.vary, restitution)
    data = {k: v for k, v in work.context.deck.data.items() if k not in ("analysis", "title", "note")}
    count = work.motions if work.many else None
    margins = sensitivity.Margins(
        work.context,
        data,
        strategies.LEVELS_OF_A_SET if work.many else strategies.LEVELS,
        count,
        work.options.acceptable_probability,
        work.peak,
        work.asker,
    )
    try:
        work.moved = margins.moved(keys)
    except Unfinished as stop:
        if stop.interrupted:
            raise Interrupted from None
        work.not_done.append(f"sensitivity: {stop}")
    if margins.stopped:
        if "dem" in work.results:
            work.not_done.append("joint stiffness and moving supports by discrete elements: stopped at the time limit")
        raise OutOfTime
    _move_elements(work)


def _move_elements(work: Work) -> None:
    """What only discrete elements know: stiffness of the joints, and a support that moves while it shakes."""
    if "dem" not in work.results:
        return
    choice, stones = work.choices["dem"], work.context.building.blocks()
    r = work.results["dem"].results
    if not isinstance(r, DemRun):
        return
    stiffness = choice.keys.get("joints", {}).get("normal_stiffness", r.joint_stiffness_max_Pa_per_m)
    _turn_elements(
        work,
        "joints.normal_stiffness",
        "Pa/m",
        stiffness,
        (stiffness / STIFFER, stiffness * STIFFER),
        lambda v: f"joints {v / stiffness:.3g} times as stiff",
        lambda v: {"joints": {"normal_stiffness": v}},
    )
    grounded = np.flatnonzero((stones.a < 0) | (stones.b < 0))
    if len(grounded) > 1:
        right = stones.joint_names[int(grounded[np.argmax(stones.middle[grounded, 0])])]
        spread = SPREAD * stones.size
        _turn_elements(
            work,
            "initial.movements.dx",
            "m",
            0.0,
            (-spread, spread),
            lambda v: f"the right support moves {'out' if v > 0.0 else 'in'} by {1e3 * abs(v):.3g} mm in the first second",
            lambda v: {"initial": {"movements": [{"joint": right, "dx": v}]}},
        )


def _turn_elements(
    work: Work,
    key: str,
    unit: str,
    base: float,
    ends: tuple[float, float],
    told: Callable[[float], str],
    keys: Callable[[float], dict[str, Any]],
) -> None:
    """Move one value of discrete elements down and up; between it and an end that turns them seek where they turn."""
    choice, r = work.choices["dem"], work.results["dem"].results
    assert isinstance(r, DemRun)

    def ask(value: float) -> DemRun | None:
        found = work.probe("dem", told(value), "dem", merge_keys(choice.keys, keys(value)))
        return found.results if found is not None and isinstance(found.results, DemRun) else None

    def share(one: DemRun | None) -> float | None:
        return None if one is None else one.peak_displacement_m / one.collapse_displacement_m

    low, high = ask(ends[0]), ask(ends[1])
    turns = None
    fell = r.outcome == "collapse"
    turned = [e for e, one in zip(ends, (low, high), strict=True) if one is not None and (one.outcome == "collapse") != fell]
    if turned and work.rows["dem"].outcome != "open":
        near, far = base, min(turned, key=lambda e: abs(e - base))
        for _ in range(ELEMENT_HALVINGS):
            middle = float(np.sqrt(near * far)) if near > 0.0 else 0.5 * (near + far)
            one = ask(middle)
            if one is None:
                break
            near, far = (near, middle) if (one.outcome == "collapse") != fell else (middle, far)
        turns = float(np.sqrt(near * far)) if near > 0.0 else 0.5 * (near + far)
    work.shaken.append(
        out.TurningValue(
            key=key,
            base=base,
            unit=unit,
            low=ends[0],
            high=ends[1],
            tilt_base=None,
            rocking_base=None,
            tilt_low=None,
            tilt_high=None,
            rocking_low=None,
            rocking_high=None,
            tilt_turns=None,
            rocking_turns=None,
            dem_base=share(r),
            dem_low=share(low),
            dem_high=share(high),
            dem_turns=turns,
        )
    )


def rows_of(work: Work) -> list[out.TurningValue]:
    """Rows of the tornado, the widest first, those of discrete elements after them."""

    def width(m: sensitivity.Moved) -> float:
        spans = [abs(np.log(b / a)) for a, b in zip(m.at_low, m.at_high, strict=True) if a and b]
        return max(spans, default=0.0)

    return [
        out.TurningValue(
            key=m.what.key,
            base=m.what.base,
            unit=m.what.unit,
            low=m.low,
            high=m.high,
            tilt_base=m.at_base[0],
            rocking_base=m.at_base[1],
            tilt_low=m.at_low[0],
            tilt_high=m.at_high[0],
            rocking_low=m.at_low[1],
            rocking_high=m.at_high[1],
            tilt_turns=m.turns[0],
            rocking_turns=m.turns[1],
            dem_base=None,
            dem_low=None,
            dem_high=None,
            dem_turns=None,
        )
        for m in sorted(work.moved, key=width, reverse=True)
    ] + work.shaken
