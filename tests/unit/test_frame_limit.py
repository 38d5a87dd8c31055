"""Peaks of frame pushovers against limit analysis of the same frame: the static theorem as a linear programme.

Piers carry |M| <= N L/2 at both ends, spandrels and ring beams their hinges, links their strengths, floors any force. The
programme finds the greatest multiple of the forces in equilibrium; the elements, loads and strengths are those of the view, the
calculation shares nothing else with the pushover.
"""

import tomllib
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog

from extrados.analyses.frame.modes import modes_of, rest_of
from extrados.analyses.frame.pushover import pushes_of
from extrados.analyses.frame.tables import FramePushover
from extrados.decks.reader import make_deck
from extrados.views.frame.options import FrameOptions

RIGID = {"shear": "none", "second_order": False, "drift_flexure": 0.1, "spandrel_drift_flexure": 0.1, "spandrel_drift_tied": 0.1}
RIGID |= {"spandrel_drift_shear": 0.1, "stiffness": 1.0}


def rows_of(element, n):
    """Rows (3, n) of what N and the end moments do work on: shortening and chord rotations, to first order."""
    x0, z0, x1, z1 = element.offsets
    ends = np.zeros((6, n))
    for e, (x, z) in enumerate(((x0, z0), (x1, z1))):
        u, w, turn = element.freedoms[3 * e : 3 * e + 3]
        for row, parts in enumerate((((u, 1.0), (turn, -z)), ((w, 1.0), (turn, x)), ((turn, 1.0),))):
            for freedom, part in parts:
                if freedom >= 0:
                    ends[3 * e + row, freedom] += part
    along, across = (ends[[1, 4]], ends[[0, 3]]) if element.upright else (ends[[0, 3]], -ends[[1, 4]])
    chord = (across[1] - across[0]) / element.length
    return np.array([along[0] - along[1], ends[2] + chord, ends[5] + chord])


def limit_of(frame, forces, tension=0.0):
    """The greatest multiple of `forces` (n) beside the weight that is in equilibrium within the strengths. tension: strength of bed
    joints that acts on the whole section [Pa]."""
    n, columns, low, high, above = len(frame.weight), [], [], [], []
    for element in frame.elements:
        rows = rows_of(element, n)
        if element.pier:
            start, arm = len(columns), 0.5 * element.depth
            bond = tension * element.depth * element.thickness
            columns += list(rows)
            low += [-bond, -np.inf, -np.inf]
            high += [np.inf] * 3
            above += [(start, start + k, arm, sign, arm * bond) for k in (1, 2) for sign in (1.0, -1.0)]
        else:
            columns += list(rows[1:])
            low += [-element.moment] * 2
            high += [element.moment] * 2
    for link in frame.links:
        row = np.zeros(n)
        for freedom, part in zip(link.freedoms, link.parts, strict=True):
            if freedom >= 0:
                row[freedom] += part
        columns.append(row)
        low.append(-link.strengths[0])
        high.append(link.strengths[1])
    values, vectors = np.linalg.eigh(0.5 * (frame.linear + frame.linear.T))
    floors = vectors[:, values > 1e-9 * max(values.max(), 1.0)].T
    columns += list(floors)
    low += [-np.inf] * len(floors)
    high += [np.inf] * len(floors)
    equal = np.column_stack([*columns, -forces])
    less = np.zeros((len(above), equal.shape[1]))
    for k, (normal, moment, arm, sign, _) in enumerate(above):
        less[k, moment], less[k, normal] = sign, -arm
    cost = np.zeros(equal.shape[1])
    cost[-1] = -1.0
    bounds = [(a if a > -1e29 else None, b if b < 1e29 else None) for a, b in zip([*low, 0.0], [*high, np.inf], strict=True)]
    scale = 1.0 / np.abs(frame.weight).max()
    found = linprog(cost, less, [row[4] for row in above], equal * scale, frame.weight * scale, bounds, method="highs")
    assert found.status == 0, found.message
    return float(found.x[-1])


def rigid(name, floors=None, **more):
    """The frame of a case of stiff masonry that does not crush; floors: their modulus."""
    with open(f"cases/{name}.toml", "rb") as file:
        data = tomllib.load(file)
    data["material"] |= {"young": 2e10, "compressive_strength": 1e9}
    data["analysis"] = [{"kind": "frame-modes"}]
    for floor in data["structure"]["floors"] if floors else []:
        floor["young"] = floors
    return make_deck(data).building.frame(FrameOptions(**RIGID | more, cohesion=0.2e6, diagonal_strength=0.1e6))


@pytest.mark.parametrize(
    ("name", "flanges", "least"),
    [
        ("frame/two-rooms", "effective", 0.993),
        ("frame/two-rooms", "none", 0.993),
        ("frame/joined", "effective", 0.97),  # its ring beam remains elastic
        ("frame/farmhouse", "effective", 0.993),
        ("frame/gabled", "effective", 0.993),
        ("frame/nine-walls", "effective", 0.993),
    ],
)
def test_a_pushover_reaches_the_load_of_limit_analysis(name, flanges, least):
    """Within 0.7 %, in all directions and senses."""
    frame = rigid(name, flanges=flanges)
    options = FramePushover(kind="frame-pushover", patterns=["static"], eccentricities=[0.0])
    level = max(one.level for one in frame.masses)
    with frame.core() as core:
        modes = modes_of(frame, rest_of(frame, core).tangent, 6)
        for push in pushes_of(frame, options, modes, level):
            path = core.push(push.forces, push.control, 0.03 * float(frame.plan.levels[level]), 150, 0.5)
            limit = limit_of(frame, push.forces)
            assert least < path.multiple.max() / limit < 1.007, push.name


@pytest.mark.parametrize("floors", [None, 2e9])
def test_walls_that_floors_do_not_join_carry_what_each_of_them_does(floors):
    """Yi's building has diaphragms of 0.02 MPa: its walls move apart, and limit analysis without floors gives the load."""
    frame = rigid("building/yi", floors)
    options = FramePushover(kind="frame-pushover", directions=[0.0], patterns=["uniform"], eccentricities=[0.0], senses=["+"])
    with frame.core() as core:
        (push,) = pushes_of(frame, options, modes_of(frame, rest_of(frame, core).tangent, 6), 2)
        path = core.push(push.forces, push.control, 0.2, 200, 0.5)
    apart, joined = limit_of(replace(frame, linear=0.0 * frame.linear), push.forces), limit_of(frame, push.forces)
    assert joined > 1.05 * apart
    assert path.multiple.max() == pytest.approx(joined if floors else apart, rel=1e-2)
