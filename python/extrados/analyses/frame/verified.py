"""Verification by displacement of a frame of macro-elements: all pushes, and the sliding of its storeys."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from extrados.analyses.codes.capacity_curve import CapacityCurve
from extrados.analyses.codes.local_mechanism import run as run_local_mechanism
from extrados.analyses.codes.tables import LocalMechanism
from extrados.analyses.codes.verification import Push as Verified
from extrados.analyses.codes.verification import demands, unverified, verify
from extrados.analyses.context import Context
from extrados.analyses.frame.modes import Mode
from extrados.analyses.frame.tables import FramePushover
from extrados.analyses.sla.curve import envelope
from extrados.core.frame import Path
from extrados.results.codes import LocalMechanism as Found
from extrados.results.frame import FramePush, OutOfPlane
from extrados.results.frame import FramePushover as FramePushed
from extrados.results.model import Result
from extrados.results.verdict import SelfWeight
from extrados.results.verification import Verification
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building
from extrados.views.frame.frame import EquivalentFrame


class Push(Protocol):
    """What the verification takes of a push: its name, forces (n) of 1 N along its sense, the row (n) of the control displacement,
    the mode of greatest participating mass, and its direction on the plan."""

    @property
    def name(self) -> str: ...
    @property
    def forces(self) -> np.ndarray: ...
    @property
    def control(self) -> np.ndarray: ...
    @property
    def mode(self) -> Mode: ...
    @property
    def way(self) -> np.ndarray: ...


def verify_frame(
    context: Context,
    result: Result,
    frame: EquivalentFrame,
    tangent: np.ndarray,
    options: FramePushover,
    pushes: Sequence[Push],
    paths: Sequence[Path],
) -> Verification | None:
    """Displacement demand and capacity of all pushes. tangent: stiffness (n, n) under the weight [N/m]."""
    total = sum(one.mass for one in frame.masses)
    rows, violated, sliding = [], [], []
    for push, path, row in zip(pushes, paths, result.of(FramePushed).runs, strict=True):
        if not path.multiple.max() > 0.0:
            violated.append(unverified(push.name))
            continue
        if options.verification.shape == "mode":
            shape = push.mode.shape
        else:
            shape = np.linalg.solve(0.5 * (tangent + tangent.T), push.forces)
        curve = capacity_curve_of(frame, push, path, row, shape)
        rows.append(Verified(push.name, curve, total))
        limit, storey = sliding_limit(frame, context.building, push, options.frame.confidence_factor)
        if path.multiple.max() > limit:
            sliding.append((limit / float(path.multiple.max()), limit, storey, push.name, float(path.multiple.max())))
    if sliding:
        _, limit, storey, name, peak = min(sliding)
        violated.append(
            f"In {len(sliding)} of {len(pushes)} capacity curves the base shear exceeds the sliding limit of "
            f"a storey by Coulomb's law. The greatest excess is in {name}: storey {storey} slides at a base "
            f"shear of {limit / 1000.0:.3g} kN, but the curve reaches {peak / 1000.0:.3g} kN."
        )
    if options.out_of_plane and demands(context, options.verification):
        walls = out_of_plane(context, options, max(1.0 / push.mode.frequency for push in pushes))
        result.results = result.results.model_copy(update={"out_of_plane": walls})
        if walls.outcome in ("collapses", "cannot-stand"):
            violated.append(f"At least one wall does not satisfy the check for out-of-plane failure. {walls.statement}")
    return verify(context, result, options.verification, rows, violated, options.frame.confidence_factor)


def capacity_curve_of(frame: EquivalentFrame, push: Push, path: Path, row: FramePush, shape: np.ndarray) -> CapacityCurve:
    """The capacity curve of a push, with the limits of its piers. shape (n): displacements of the equivalent oscillator."""
    mass = frame.mass
    shape = shape / float(push.control @ shape)
    own, square = float(shape @ mass @ frame.unit(push.way)), float(shape @ mass @ shape)
    limits = {
        name: min(reached)
        for name, key in (("drift", "all_at_limit_m"), ("strength", "all_at_strength_m"), ("first", "first_at_limit_m"))
        if (reached := [s[key] for s in row.storeys if s[key] is not None])
    }
    d, p = envelope(path.control, path.multiple, float(path.control[0]))
    # one mass and one displacement that have the same sums of m phi and of m phi^2
    return CapacityCurve(d - d[0], p, np.array([own**2 / square]), np.array([square / own]), limits)


def out_of_plane(context: Context, options: FramePushover, period: float) -> OutOfPlane:
    """Every wall above the foot of each storey as a local mechanism (C8.7.1.2), with the floor spectrum of a period [s]."""
    given = options.verification
    checks = LocalMechanism(
        kind="local-mechanism", mechanism="building", spectrum=given.spectrum, motion_spectrum=given.motion_spectrum, building_period=period
    )
    found = run_local_mechanism(replace(context, warnings=[]), checks).results
    verdict = found.overall() if isinstance(found, Found) else None
    wall = f"Wall {found.walls[0].wall}, storey {found.walls[0].storey}: " if isinstance(found, Found) and found.walls else ""
    statement = f"{wall}{verdict.statement}" if verdict is not None else found.statement() if isinstance(found, SelfWeight) else ""
    return OutOfPlane(
        factor=None if verdict is None else verdict.ratio,
        outcome="not-applicable" if verdict is None else verdict.outcome,
        building_period_s=period,
        statement=statement,
    )


def sliding_limit(frame: EquivalentFrame, building: Building, push: Push, factor: float = 1.0) -> tuple[float, int]:
    """Least base shear [N] under which a storey slides on its base, friction times the weight above and cohesion times the area of
    the piers, and that storey; infinite where friction excludes sliding. factor: divides the cohesion."""
    friction, cohesion = building.joints.coefficient, building.joints.cohesion / factor
    if friction is None:
        return np.inf, 0
    unit = frame.unit(push.way)
    found = []
    for storey in range(1, len(frame.plan.storeys) + 1):
        above = [one.mass for one in frame.masses if one.level >= storey]
        weight = frame.total_weight if storey == 1 else GRAVITY * sum(above)
        area = sum((s.masonry[1] - s.masonry[0]) * s.thickness for s in frame.strips if s.kind == "pier" and s.storey == storey)
        share = sum(float(unit[n] * push.forces[n]) for (_, level), n in frame.along.items() if level >= storey)
        if share > 0.0:
            found.append(((friction * weight + cohesion * area) / share, storey))
    return min(found, default=(np.inf, 0))
