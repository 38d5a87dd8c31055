"""Groups of elements, joints, bars and springs, as a model in the core takes them."""

import numpy as np
import numpy.typing as npt

from extrados import _core
from extrados.core.calls import indices, integers, real, real_each, stack_rows
from extrados.core.errors import check
from extrados.core.sla_laws import add_tables, beddings_of, softenings_of
from extrados.core.sla_parts import BEARS, ELEMENTS, THROUGH, Bars, Joints, Plane, ShellJoints, Shells, Springs


class BadElement(ValueError):
    """An element is inverted or has no area; its 0-based number."""

    def __init__(self, element: int, what: str):
        super().__init__(f"{what} {element + 1} is inverted or has no size")
        self.element = element


def body_force(kind: str, points: tuple[int, int], xy: npt.ArrayLike, connect: npt.ArrayLike, density: npt.ArrayLike) -> np.ndarray:
    """Consistent nodal forces (nodes, 2) [N] of a density (elements, 2): force per wall area [N/m^2].

    xy (nodes, 2) [m]; connect (elements, nodes of one), from 0.
    """
    place = real("xy", np.transpose(xy), (2, None))
    nodes = indices("connect", np.transpose(connect), place.shape[1], (ELEMENTS[kind], None))
    force, bad, status = _core.api_sla_model.body_force(
        ELEMENTS[kind], *points, place, nodes, real("density", np.transpose(density), (2, nodes.shape[1]))
    )
    if bad:
        raise BadElement(bad - 1, "element")
    check(status, "body force")
    return np.array(force.T)


def add_group(handle: int, xy: np.ndarray, freedoms: int, group: Plane | Joints | Bars | Springs) -> None:
    """Hand over the elements or springs of a group; xy (nodes, 2) or (nodes, 3) [m], freedoms of a node."""
    nodes = len(xy)
    if isinstance(group, Springs):
        _add_springs(handle, nodes, freedoms, group)
        return
    per = np.shape(group.connect)[1] if isinstance(group, Bars) else 4 if isinstance(group, Joints) else ELEMENTS[group.kind]
    connect = indices("connect", np.transpose(group.connect), nodes, (per, None))
    count = connect.shape[1]
    young = real_each("young", group.young, count)
    tables, ladder = add_tables(handle, count, group)
    if isinstance(group, Bars):
        gradient, length = group.strains(xy)
        bad, status = _core.api_sla_model.bars(
            handle,
            connect,
            real("gradient", np.transpose(gradient, (2, 1, 0)), (xy.shape[1], per, count)),
            stack_rows(real_each("area", group.area, count) * length, young),
            stack_rows(*tables, np.full(count, BEARS[group.bears], dtype=np.int32)),
        )
        what = "bar"
    elif isinstance(group, Joints):
        bad, status = _add_joints(handle, group, connect, tables)
        what = "joint element"
    else:
        axis = np.broadcast_to(np.asarray(group.axis, dtype=float), (count,))
        given = np.isfinite(axis)
        properties = stack_rows(
            real_each("thickness", group.thickness, count),
            young,
            real_each("nu", group.nu, count),
            real_each("lateral", group.lateral, count),
            np.where(given, axis, 0.0),
            real_each("confinement", group.confinement, count),
            *_bed_rows(group, count),
        )
        choices = stack_rows(tables[0], *ladder, tables[1], (1 + int(group.joint)) * given.astype(np.int32))
        if isinstance(group, Shells):
            bad, status = _core.api_shell.shells(
                handle,
                ELEMENTS[group.kind],
                integers("section", [THROUGH[group.through], group.layers, int(group.bends), int(group.selective)], 4),
                real("frames", np.transpose(group.frames, (1, 2, 0)), (3, 3, nodes)),
                integers("flat", np.asarray(group.flat).astype(int), nodes),
                connect,
                properties,
                choices,
            )
        else:
            bad, status = _core.api_sla_model.plane(
                handle, ELEMENTS[group.kind], integers("points", [*group.points, int(group.selective)], 3), connect, properties, choices
            )
        what = "element"
    if bad:
        raise BadElement(int(bad) - 1, what)
    check(status, f"{what}s")


def _add_joints(handle: int, group: Joints, connect: np.ndarray, tables: list[np.ndarray]) -> tuple[int, int]:
    count = connect.shape[1]
    friction = np.broadcast_to(np.asarray(group.friction, dtype=float), (count,))
    properties = stack_rows(
        *real("area", np.transpose(group.area), (2, count)),
        real_each("normal stiffness", group.normal_stiffness, count),
        real_each("shear stiffness", group.shear_stiffness, count),
        np.where(np.isnan(friction), -1.0, friction),
        real_each("small", group.small, count),
        *real("normal", np.transpose(group.normal), (2, count)),
    )
    dry = np.broadcast_to(np.asarray(group.dry, dtype=np.int32), (count,))
    choices, ripple = stack_rows(*tables, dry), float(group.ripple)
    if isinstance(group, ShellJoints):
        row = real("row", group.row.reshape(2 * count, 3, 24).transpose(2, 1, 0), (24, 3, 2 * count))
        return _core.api_sla_joints.joints_between_shells(handle, connect, properties, choices, ripple, row)
    return _core.api_sla_joints.joints(handle, connect, properties, choices, ripple)


def _add_springs(handle: int, nodes: int, freedoms: int, group: Springs) -> None:
    count = len(group.stiffness)
    ground = np.asarray(group.node) == -1  # the ground is the core's node 0
    node = indices("node of a spring", np.asarray(group.node).T + 1, nodes + 1, (2, count)) - np.int32(1)
    direction = np.where(ground, 0, np.asarray(group.direction))
    status = _core.api_sla_model.springs(
        handle, node, indices("direction of a spring", direction.T, freedoms, (2, count)), real("stiffness", group.stiffness, (count,))
    )
    check(status, "springs")


def _bed_rows(group: Plane, count: int) -> np.ndarray:
    """(8, elements) the components of the core's `bedding`: none where nothing cracks or crushes."""
    rows = np.zeros((8, count))
    rows[3] = 1.0
    for k, criterion in enumerate(group.hill or ()):
        if criterion is not None:
            rows[[0, 5, 6, 7], k] = criterion.angle, criterion.ratio, criterion.coupling, criterion.shear
    if group.bedding is None:
        return rows
    width = real_each("band", group.band, count) if group.reach is None else np.zeros(count)
    for k, (bed, law) in enumerate(zip(beddings_of(group, count), softenings_of(group.tension, count), strict=True)):
        if bed is not None and law is not None:
            rows[:5, k] = bed.angle, bed.strength, bed.energy, bed.shear, width[k]
    return rows
