"""Whether the response to a motion is chaotic: how far histories part under a motion that no instrument tells from it."""

from collections.abc import Sequence

import numpy as np

#: A motion scaled by 1 plus and minus this is the same motion to every instrument.
NUDGE = 1e-6
#: Growth of a perturbation beyond which a run is chaotic: one of a millionth parts histories by a hundredth of the critical
#: rotation. In 192 runs of six blocks under five records and three sines 16 grow so much (tests/unit/test_conditions.py)
CHAOTIC = 1e4
#: No instrument tells motions apart that differ by so little: half a decade after the other, for windows of outcomes among
#: others are as narrow as that
NUDGES = (NUDGE, 3.2e-6, 1e-5, 3.2e-5, 1e-4)


#: Step of the histories whose growth is measured over the time unit of the structure, whatever the step of output; and their times at most
SPACING, MOST_TIMES = 0.02, 20000


def growth_step(time_unit: float, end_time: float) -> float:
    """Step [s] of the histories of `growth` until `end_time` [s]; time_unit: of the structure [s]."""
    return max(SPACING * time_unit, end_time / MOST_TIMES)


def growth(runs: Sequence[np.ndarray], until: int | None = None) -> float:
    """Greatest separation of perturbed runs from the first one at equal times, over the perturbation.

    runs: of each the histories (times) or (times, components) as shares of the limit: rotations over the critical one to their
    side, displacements over the one that counts as collapse. The first is under the motion, the others under the motion times
    1 plus or minus NUDGE. Only the time until the first of them passes its limit counts, or the first `until` times: beyond it every
    difference grows. A
    smooth response is about 1 to 1e3, a chaotic one grows exponentially with its impacts up to 1e6, where histories have
    nothing in common.
    """
    length = min(len(run) for run in runs)
    share = np.stack([run[:length].reshape(length, -1) for run in runs])
    beyond = (np.abs(share) > 1.0).any(axis=(0, 2)) if until is None else np.arange(length) >= until
    if beyond.any():
        share = share[:, : int(beyond.argmax())]
    return float(np.abs(share[1:] - share[0]).max(initial=0.0)) / NUDGE


def over_critical(rotation: np.ndarray, critical: tuple[float, float]) -> np.ndarray:
    """Rotations [rad] as shares of the critical ones to +x and to -x [rad]."""
    return rotation / np.where(rotation >= 0.0, *critical)


def perturbed() -> list[float]:
    """Factors on the motion: 1 plus and minus each of NUDGES, those of NUDGE first."""
    return [1.0 + sign * nudge for nudge in NUDGES for sign in (-1.0, 1.0)]


def turning(outcome: str, others: Sequence[str]) -> float:
    """Least of NUDGES under which collapse turns into recovery or back, of the outcomes under `perturbed` motions; 0 where none does."""
    return next((NUDGES[i // 2] for i, other in enumerate(others) if (other == "collapse") != (outcome == "collapse")), 0.0)


def violated_by_chaos(
    found: float, turns: float, parts: str = "the rotation", limit: str = "the critical one", advice: str = "use fragility"
) -> list[str]:
    """The violated condition of a chaotic run, from the growth of a perturbation and the least one that changes its outcome; empty if
    the response is smooth. parts: differing quantity, as a share of its `limit`."""
    if found <= CHAOTIC and turns <= 0.0:
        return []
    if found <= CHAOTIC and turns > NUDGE:
        return [
            (
                f"The response is sensitive to perturbations of {turns:.1g}: if the motion is scaled by 1 plus or minus this "
                f"value, the outcome changes. One run is only one sample: {advice}."
            )
        ]
    return [
        (
            "The response is chaotic (sensitive to perturbations of 1e-6). If the motion is scaled by 1 plus or minus "
            f"{NUDGE:g}, the outcome changes, or {parts} differs by up to {100.0 * min(1.0, found * NUDGE):.2g} % of {limit}. "
            f"One run is only one sample: {advice}."
        )
    ]
