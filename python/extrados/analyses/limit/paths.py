"""Load paths of elastic joints as results: one a ratio of joint stiffness, each with its certificate."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import count
from threading import Lock

from extrados.core.calls import interruptible
from extrados.limit.certificate import Certificate
from extrados.limit.errors import NoAnswer
from extrados.limit.load_path import PATIENT, QUICK, RATIOS
from extrados.results.limit import LoadPath

Follow = Callable[[float, int], tuple[float, Certificate]]  # ratio, effort: collapse acceleration along the push [g], certificate


def follow_paths(follow: Follow, *, patient: bool) -> list[LoadPath]:
    """The load paths of one push.

    Without patience the effort is small, and no path is followed after one that was given up.
    """
    rows: list[LoadPath] = []
    with interruptible():
        for ratio in RATIOS:
            if not patient and rows and rows[-1].collapse_acceleration_g is None:
                rows.append(_given_up(ratio, "not calculated, because the previous load path stopped without a result"))
            else:
                rows.append(_follow_one(follow, ratio, PATIENT if patient else QUICK))
    return rows


def follow_beside(pushes: Sequence[Follow], threads: int, progress: Callable[[int, int], None]) -> list[list[LoadPath]]:
    """The load paths of several pushes with patience, side by side; progress(paths that are done, all paths), by one thread at a time."""
    tasks, done, telling = [(follow, ratio) for follow in pushes for ratio in RATIOS], count(1), Lock()
    progress(0, len(tasks))

    def one(task: tuple[Follow, float]) -> LoadPath:
        row = _follow_one(*task, PATIENT)
        with telling:
            progress(next(done), len(tasks))
        return row

    with interruptible(), ThreadPoolExecutor(max(1, min(threads, len(tasks)))) as pool:
        rows = list(pool.map(one, tasks))
    return [rows[k : k + len(RATIOS)] for k in range(0, len(rows), len(RATIOS))]


def _follow_one(follow: Follow, ratio: float, effort: int) -> LoadPath:
    try:
        gamma, proof = follow(ratio, effort)
    except NoAnswer as error:
        return _given_up(ratio, str(error))
    return LoadPath(
        shear_stiffness_ratio=ratio,
        collapse_acceleration_g=gamma,
        certified=proof.holds(gamma),
        zero_gap_g=proof.zero_gap,
        equilibrium_residual=proof.equilibrium,
        friction_residual=max(proof.friction, proof.tension),
        overlap_residual=proof.closing,
    )


def _given_up(ratio: float, reason: str) -> LoadPath:
    return LoadPath(
        shear_stiffness_ratio=ratio,
        collapse_acceleration_g=None,
        certified=False,
        zero_gap_g=None,
        equilibrium_residual=None,
        friction_residual=None,
        overlap_residual=None,
        reason=reason,
    )


def doubt(paths: list[LoadPath], way: str) -> str | None:
    """A warning where some of the load paths of a push are not certified."""
    wrong = [f"{p.shear_stiffness_ratio:g}" for p in paths if not p.certified]
    if not wrong:
        return None
    text = f"The load path {way} is not certified with the joint stiffness ratio {' and '.join(wrong)}"
    if len(wrong) == len(paths):
        return f"{text}. No design value is given; only the upper bound is available"
    return f"{text}. The design value is the lowest of the remaining load paths"
