"""Load paths of elastic joints as results: one a ratio of joint stiffness, each with its certificate."""

from collections.abc import Callable

from extrados.limit.certificate import Certificate
from extrados.limit.errors import NoAnswer
from extrados.limit.load_path import PATIENT, QUICK, RATIOS
from extrados.results.limit import LoadPath


def follow_paths(follow: Callable[[float, int], tuple[float, Certificate]], *, patient: bool) -> list[LoadPath]:
    """The load paths of one push; follow(ratio, effort): collapse acceleration along the push [g] and its certificate.

    Without patience the effort is small, and no path is followed after one that was given up.
    """
    rows: list[LoadPath] = []
    for ratio in RATIOS:
        try:
            if not patient and rows and rows[-1].collapse_acceleration_g is None:
                raise NoAnswer("not calculated, because the previous load path stopped without a result")
            gamma, proof = follow(ratio, PATIENT if patient else QUICK)
        except NoAnswer as error:
            rows.append(
                LoadPath(
                    shear_stiffness_ratio=ratio,
                    collapse_acceleration_g=None,
                    certified=False,
                    zero_gap_g=None,
                    equilibrium_residual=None,
                    friction_residual=None,
                    overlap_residual=None,
                    reason=str(error),
                )
            )
            continue
        rows.append(
            LoadPath(
                shear_stiffness_ratio=ratio,
                collapse_acceleration_g=gamma,
                certified=proof.holds(gamma),
                zero_gap_g=proof.zero_gap,
                equilibrium_residual=proof.equilibrium,
                friction_residual=max(proof.friction, proof.tension),
                overlap_residual=proof.closing,
            )
        )
    return rows


def doubt(paths: list[LoadPath], way: str) -> str | None:
    """A warning where some of the load paths of a push are not certified."""
    wrong = [f"{p.shear_stiffness_ratio:g}" for p in paths if not p.certified]
    if not wrong:
        return None
    text = f"The load path {way} is not certified with the joint stiffness ratio {' and '.join(wrong)}"
    if len(wrong) == len(paths):
        return f"{text}. No design value is given; only the upper bound is available"
    return f"{text}. The design value is the lowest of the remaining load paths"
