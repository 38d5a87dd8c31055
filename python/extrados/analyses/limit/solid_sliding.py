"""Sliding without dilatancy of solids under one push: load paths, the least state found, their certificates."""

import numpy as np

from extrados.analyses.limit.paths import follow_paths
from extrados.limit.certificate import Certificate
from extrados.limit.contact_points import SlidingState
from extrados.limit.least_load import LeastLoad, rigid_motion
from extrados.limit.load_path import LoadPath
from extrados.limit.solids import Programme, SolidLimit
from extrados.results import solids as out
from extrados.results.limit import design_value

GUESS_CONTACTS = 60  # with more contacts states from random compressions take too long


def slide(
    limit: SolidLimit, direction: float, associated: float | None, starts: int, *, patient: bool = True
) -> tuple[out.SolidNonDilatant, Programme | None]:
    """What a push along a direction [deg] gives without dilatancy, and the least state; associated: its upper bound [g]."""
    points = limit.contact_points(direction)
    programmes = LeastLoad(points)
    ends: list[SlidingState] = []

    def follow(ratio: float, effort: int) -> tuple[float, Certificate]:
        end = rigid_motion(points, LoadPath(points, ratio, effort).follow())
        proof = limit.certify(direction, end)[1]
        if proof.holds(end.gamma):
            ends.append(end)
        return end.gamma, proof

    paths = follow_paths(follow, patient=patient)
    found = [*ends, *(programmes.descended(end) for end in ends)]
    if len(limit.assembly.a) <= GUESS_CONTACTS:
        found += [state for k in range(starts) if (state := programmes.guessed(np.random.default_rng(k))) is not None]
    certified = [one for one in (limit.certify(direction, state) for state in found) if one[1].holds(one[0].gamma)]
    starts_g = [state.gamma for state, _ in certified]
    least, proof = min(certified, key=lambda one: one[0].gamma, default=(None, None))
    row = out.SolidNonDilatant(
        direction_deg=direction,
        associated_g=associated,
        load_path_g=design_value(paths),
        load_paths=paths,
        least_g=None if least is None else least.gamma,
        starts_g=starts_g,
        spread_g=max(starts_g) - min(starts_g) if starts_g else None,
        zero_gap_g=None if proof is None else proof.zero_gap,
        equilibrium_residual=None if proof is None else proof.equilibrium,
        friction_residual=None if proof is None else max(proof.friction, proof.tension),
        overlap_residual=None if proof is None else proof.closing,
    )
    return row, least
