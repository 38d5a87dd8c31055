"""supports: what opens where supports give way; an arch whose right support moves, from rest until it falls."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.asked import movements_of, refuse_still
from extrados.analyses.limit.common import geometry_arrays, spoken_ties, state_arrays, tie_arrays, tie_rows, ties_of
from extrados.analyses.limit.tables import MovingSupports
from extrados.limit.answer import cannot_stand
from extrados.limit.loads import tilt_loads
from extrados.limit.places import place_of
from extrados.limit.programme import LimitAnalysis, NoEquilibrium
from extrados.limit.resistance import together
from extrados.limit.settlement import settle
from extrados.limit.supports import SupportState, support_movement
from extrados.model.errors import WHOLE, BadGeometry
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.chains import in_order, is_stack
from extrados.results import limit as out
from extrados.results.model import Array, Result, TableData
from extrados.schema.quantities import three_figures

OPENS = 1e-7  # of the greatest opening: joints that move by less do not
SMALL = 1e-3  # of the width: how far a support moves unless the deck says
APART = 1e-3  # of the size: supports that are nearer are one
LARGE = 0.05  # rad: beyond, motions of first order are coarse
FILM = 150  # movements of an animation
SHOWN = (0.0, 0.25, 0.5, 0.75, 1.0)  # of the movement at the fall


def _place(arch: Assembly, hinge: tuple[int, str]) -> str:
    """Where a hinge is, in words."""
    joint, side = hinge
    return place_of(arch, joint, (arch.p if side == "intrados" else arch.q)[joint])


def run(context: Context, options: MovingSupports) -> Result:
    """Joints that open; of an arch without ties the states on the way to its fall, how the thrust and the hinges change."""
    assembly = context.building.blocks()
    if context.building.initial.movements:
        return _any_structure(context, movements_of(context.building))
    refuse_still(context.building, options)
    try:
        arch = None if context.building.ties else in_order(assembly)
    except BadGeometry:
        arch = None
    if arch is None:
        return _any_structure(context, _right_support(assembly, options))
    upright = LimitAnalysis(arch)
    if not upright.stands():
        raise cannot_stand(upright)
    try:
        states = support_movement(arch, (options.spread, -options.settle), options.steps)
    except NoEquilibrium as error:
        raise Refused(f"the arch cannot follow the movement: {error}", WHOLE) from None
    movement = np.array([s.movement for s in states])
    force = np.array([s.force for s in states])
    ends = arch.p[[0, -1]]
    span = float(np.hypot(*(ends[1] - ends[0])))
    stages = [0, *[i for i in range(1, len(states)) if states[i].hinges != states[i - 1].hinges]]
    last = states[-1]
    touched = np.minimum(last.position, 1.0 - last.position) < 1e-5
    fourth = [int(k) for k in np.flatnonzero(touched) if k not in {h[0] for h in last.hinges}]
    result = Result("supports")
    r = out.MovingSupports(
        movement_at_fall_m=float(movement[-1]),
        movement_at_fall_over_span=float(movement[-1] / span),
        span_change_at_fall_ratio=float(movement[-1] * options.spread / np.hypot(options.spread, options.settle) / span),
        thrust_at_rest_N=float(force[0, 0]),
        thrust_at_fall_N=float(force[-1, 0]),
        hinges_at_rest=[out.JointHinge(joint=k, side=side) for k, side in states[0].hinges],
        hinges_at_fall=[out.JointHinge(joint=k, side=side) for k, side in last.hinges],
        joints_touched_at_fall=fourth,
        stages=[out.Stage(movement_m=movement[i], hinges=[_place(arch, hinge) for hinge in states[i].hinges]) for i in stages],
    )
    result.results = r
    result.arrays = geometry_arrays(arch) | _way_arrays(options, states)
    result.tables = {
        "supports": TableData(
            {
                "movement": movement,
                "horizontal": force[:, 0],
                "vertical": force[:, 1],
                "hinges": ["; ".join(f"{side} {k}" for k, side in s.hinges) for s in states],
            },
            {"movement": "m", "horizontal": "N", "vertical": "N"},
        )
    }
    way = "spreads" if options.spread > 0 and options.settle == 0 else "moves"
    result.answer = (
        f"The right support {way}: the arch follows on three hinges ({'; '.join(_place(arch, hinge) for hinge in states[0].hinges)}) "
        f"and collapses at {movement[-1]:.3g} m ({100 * movement[-1] / span:.2f} % of the span), after {len(stages) - 1} "
        f"change{'s' if len(stages) != 2 else ''} of hinges. Up to then the thrust changes from {three_figures(force[0, 0] / 1e3)} to "
        f"{three_figures(force[-1, 0] / 1e3)} kN."
    )
    return result


def _way_arrays(options: MovingSupports, states: list[SupportState]) -> dict[str, Array]:
    """The states on the way of the support to the collapse."""
    movement = np.array([s.movement for s in states])
    pose_axes, line_axes = ("block", "component"), ("joint", "axis")
    places, line = "places of the centroids, rotations", "thrust line, drawn through the displaced joints"

    def poses(index: Iterable[int], axis: str) -> Array:
        return Array(np.array([states[i].pose for i in index]), (axis, *pose_axes), "m, m, rad", places)

    def lines(index: Iterable[int], axis: str) -> Array:
        return Array(np.array([states[i].points for i in index]), (axis, *line_axes), "m", line)

    shown = [int(np.abs(movement - share * movement[-1]).argmin()) for share in SHOWN]
    arrays = {
        "movement": Array(movement, ("movement",), "m", "movement of the right support"),
        "force": Array(np.array([s.force for s in states]), ("movement", "axis"), "N", "force of the arch on the right support"),
        "energy": Array(
            np.array([s.energy for s in states]), ("movement",), "J", "increase of the potential energy from the initial position"
        ),
        "hinge": Array(np.array([[h[0] for h in s.hinges] for s in states]), ("movement", "hinge_number"), "", "joints that hinge"),
        "shown_movement": Array(movement[shown], ("shown",), "m", "movements drawn"),
        "shown_pose": poses(shown, "shown"),
        "shown_point": lines(shown, "shown"),
    }
    if options.animation == "none":
        return arrays
    film = np.unique(np.linspace(0, len(states) - 1, FILM).astype(int)).tolist()
    return arrays | {
        "film_movement": Array(movement[film], ("film",), "m", "movements in the animation"),
        "film_pose": poses(film, "film"),
        "film_line": lines(film, "film"),
    }


def _right_support(assembly: Assembly, options: MovingSupports) -> np.ndarray:
    """The movement (joints, 3) of the right support: the rightmost joints on the ground, up to the first gap in plan.

    Refused where there is one support only.
    """
    grounded = np.flatnonzero((assembly.a == GROUND) | (assembly.b == GROUND))
    ends = np.sort(np.stack([assembly.p[grounded, 0], assembly.q[grounded, 0]]), axis=0)
    order = np.argsort(-ends[1], kind="stable")
    apart = ends[0, order[:-1]] - ends[1, order[1:]] > APART * assembly.size
    if not apart.any():
        raise Refused(
            "the structure has only one support, so its movement moves the whole structure. Give "
            "[[initial.movements]] for the joints on the ground that move",
            ("analysis",),
        )
    right = grounded[order[: int(apart.argmax()) + 1]]
    width = float(np.ptp(np.concatenate(assembly.outlines)[:, 0]))
    along = np.array([options.spread, -options.settle])
    movement = np.zeros((len(assembly.a), 3))
    movement[right, :2] = along / np.hypot(*along) * (options.movement or SMALL * width)
    return movement


def _any_structure(context: Context, movement: np.ndarray) -> Result:
    """The joints that open under movements (joints, 3) of supports, all at once and small."""
    building = context.building
    assembly = building.blocks()
    loads = tilt_loads(assembly)
    loads = replace(loads, resistance=together(loads.resistance, ties_of(building, loads.scale)))
    limit = LimitAnalysis(assembly, building.friction(), loads=loads)
    if not limit.stands():
        raise cannot_stand(limit)
    try:
        found = settle(limit, movement)
    except NoEquilibrium as error:
        raise Refused(f"the {building.require_structure().word} cannot follow the movement: {error}", WHOLE) from None
    motion = found.motion
    wide = motion[:, :2].max(axis=1)
    moving = np.flatnonzero(np.abs(motion).max(axis=1) > OPENS * np.abs(motion).max())
    arched = {j for joints in assembly.chains.values() if not is_stack(assembly, joints) for j in joints}
    sides: dict[bool, tuple[out.OpenSide, out.OpenSide]] = {True: ("intrados", "extrados"), False: ("first end", "second end")}
    result = Result("supports")
    opened = [
        out.JointOpening(
            joint=j,
            name=assembly.joint_names[j],
            opening_mm=1e3 * float(wide[j]),
            side=sides[j in arched][int(motion[j, 1] > motion[j, 0])],
            slip_mm=1e3 * float(motion[j, 2]),
        )
        for j in moving[np.argsort(-wide[moving], kind="stable")].tolist()
    ]
    force = found.state.force(assembly)
    result.results = out.MovingSupports(
        openings=opened,
        work_J=found.work,
        work_gap_J=found.gap,
        reactions=[
            out.Reaction(joint=j, name=assembly.joint_names[j], horizontal_N=sign * force[j, 0], vertical_N=sign * force[j, 1])
            for j, sign in enumerate(np.where(assembly.b == GROUND, 1.0, -1.0).tolist())
            if GROUND in (assembly.a[j], assembly.b[j])
        ],
        **tie_rows(building, loads, found.state),
    )
    result.arrays = {
        **geometry_arrays(assembly),
        **tie_arrays(building, loads, {"settled": found.state}),
        **state_arrays(assembly, "settled", found.state, "under moving supports"),
        "settled_pose": Array(found.pose, ("block", "component"), "m, m, rad", "places of the centroids, rotations"),
        "settled_opening": Array(
            motion,
            ("joint", "component"),
            "m",
            "opening of each joint at its first end (intrados of an arch) and second end (extrados), and slip",
        ),
        "support_movement": Array(movement, ("joint", "component"), "m, m, rad", "movements of the supports"),
    }
    result.tables = {
        "openings": TableData(
            {
                "joint": [o.name for o in opened],
                "opening": [o.opening_mm for o in opened],
                "side": [o.side for o in opened],
                "slip": [o.slip_mm for o in opened],
            },
            {"opening": "mm", "slip": "mm"},
        )
    }
    rotation = float(np.abs(found.pose[:, 2]).max())
    if rotation > LARGE:
        result.warnings.append(
            f"blocks rotate by up to {np.degrees(rotation):.1f} degrees, but the analysis assumes small movements: give smaller movements"
        )
    slid = [o.name for o in opened if abs(o.slip_mm) > 1e-3 * max(o.opening_mm, 1e-300)]
    if slid:
        result.warnings.append(
            "dilatant friction: a joint that slides also opens, by its friction times the slip. States without dilatancy, which may "
            'carry less, are not calculated. For joints that only open, give `friction = "no-sliding"`'
        )
    result.answer = _opened_in_words(building.require_structure().word, movement, opened, len(slid), found.work) + spoken_ties(
        result.of(out.MovingSupports).ties
    )
    return result


def _opened_in_words(word: str, movement: np.ndarray, opened: list[out.JointOpening], slid: int, work: float) -> str:
    """Joints that open under movements (joints, 3) of the supports; slid: number of joints that slide; work of the weight [J]."""
    wide_open = [o for o in opened if o.opening_mm > 1e-3 * abs(o.slip_mm)]
    shown = "; ".join(f"{o.name} by {o.opening_mm:.3g} mm" for o in wide_open[:6])
    most_moved = 1e3 * float(np.hypot(*movement[:, :2].T).max())
    given = f" by up to {most_moved:.3g} mm" if most_moved > 0.0 else ""
    return (
        f"Under the movements of its supports{given} {_counted(len(wide_open), 'joint')} of the {word} "
        f"{'opens' if len(wide_open) == 1 else 'open'}"
        + (f": {shown}" if shown else "")
        + (f" and {len(wide_open) - 6} more" if len(wide_open) > 6 else "")
        + (f"; {_counted(slid, 'joint')} {'slides' if slid == 1 else 'slide'}" if slid else "")
        + f". The weight does {three_figures(work)} J of work."
    )


def _counted(count: int, what: str) -> str:
    return f"{count or 'no'} {what}{'' if count == 1 else 's'}"
