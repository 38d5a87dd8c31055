"""Rows of cases whose source is another programme: static equilibrium in three equations per block by SciPy's HiGHS, and a
primary impulse by a grid and SciPy's simplex. Both are written apart from the program."""

import tomllib
from itertools import product
from typing import Any

import numpy as np
import pytest
from expectations import Case, Row, changed, load_cases
from scipy import sparse
from scipy.optimize import linprog, minimize

from extrados.analyses.limit.common import loads_of
from extrados.decks.reader import make_deck
from extrados.limit.loads import Loads
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.motions.records import locate, read_record, record_motion
from extrados.schema.constants import GRAVITY

HERE = "(tests/verification/test_outside_programme.py)"
#: Deck keys of rows that a sweep or a variant of the case computes
VARIANTS = {
    "failure-curves.curves[1].uplift_acceleration_g": {"structure.thickness": 1.2},
    "failure-curves.curves[4].uplift_acceleration_g": {"structure.embrace": 170.0},
    "sweep.collapse_accelerations_g[7]": {"structure.height": 25.5},
    "sweep.collapse_accelerations_g[15]": {"structure.height": 400.0},
}


def rows_of(method: str) -> list[Any]:
    named = [(case, row) for case in load_cases() for row in case.rows if row.source.startswith(method) and row.source.endswith(HERE)]
    return [pytest.param(case, row, id=f"{case.name}-{row.quantity}-{len(row.change)}") for case, row in named]


def greatest_load_factor(a: Assembly, loads: Loads, friction: np.ndarray | None, sense: float) -> float:
    """The load factor at collapse: per joint forces at both ends along the normal and one along the joint, and the share of
    each passive pressure, in equilibrium with dead + factor x live on every block."""
    m, pushes, unit = len(a.a), loads.pushes, loads.scale
    rows = sparse.lil_matrix((3 * len(a.mass), 3 * m + pushes + 1))
    slide = sparse.lil_matrix((2 * m, 3 * m + pushes + 1))
    for j in range(m):
        along = (a.q[j] - a.p[j]) / np.hypot(*(a.q[j] - a.p[j]))
        for k, (force, at) in enumerate(((a.normal[j], a.p[j]), (a.normal[j], a.q[j]), (along, a.p[j]))):
            wrench = np.array([[force[0]], [force[1]], [at[0] * force[1] - at[1] * force[0]]])
            for block, sign in ((a.a[j], 1.0), (a.b[j], -1.0)):
                if block != GROUND:
                    rows[3 * block : 3 * block + 3, 3 * j + k] += sign * wrench
        if friction is not None and np.isfinite(friction[j]):
            slide[2 * j : 2 * j + 2, 3 * j : 3 * j + 2] = -friction[j]
            slide[2 * j : 2 * j + 2, 3 * j + 2] = np.array([[1.0], [-1.0]])
    if loads.resistance is not None:
        for i, (block, wrench) in enumerate(zip(loads.resistance.block, loads.resistance.wrench, strict=True)):
            rows[3 * block : 3 * block + 3, 3 * m + i] = wrench[:, None] / unit
    rows[:, -1] = loads.live.reshape(-1, 1) / unit
    cost = np.zeros(3 * m + pushes + 1)
    cost[-1] = -sense
    bounds = [(0, None), (0, None), (None, None)] * m + [(0, 1)] * pushes + [(None, None)]
    right = -loads.dead.ravel() / unit
    found = linprog(cost, slide.tocsr(), np.zeros(2 * m), rows.tocsr(), right, bounds, method="highs-ds")
    assert found.success, found.message
    return float(sense * found.x[-1])


@pytest.mark.parametrize(("case", "row"), rows_of("linear programme"))
def test_capacity_by_equilibrium_of_blocks(case: Case, row: Row) -> None:
    data = changed(tomllib.loads(case.deck.read_text(encoding="utf-8")), row.change)
    data = changed({**data, "analysis": {"kind": "tilt"}}, tuple(VARIANTS.get(row.quantity, {}).items()))
    data.pop("motion", None)
    deck = make_deck(data, case.deck.parent)
    building = deck.buildings[0]
    a, friction = building.blocks(), building.friction()
    each = None if friction is None else np.broadcast_to(np.asarray(friction, dtype=float), len(a.a))
    sense = -1.0 if "opposite" in row.quantity else 1.0
    found = greatest_load_factor(a, loads_of(a, deck.analyses[0], building), each, sense)
    found = float(np.degrees(np.arctan(found))) if "angle" in row.quantity else found
    assert found == pytest.approx(row.value, abs=max(row.allowed, 1e-9))


@pytest.fixture(scope="module")
def impulse() -> dict[str, float]:
    """The full sine that takes most from the squares of El Centro's acceleration."""
    time, a = record_motion(read_record(locate("extrados:el-centro-1940", None))).series()

    def amplitude(period: float, start: float) -> tuple[float, float]:
        inside = (time >= start) & (time <= start + period)
        sine = np.sin(2.0 * np.pi * (time[inside] - start) / period)
        share = float(a[inside] @ sine) / float(sine @ sine)
        return share, share * float(a[inside] @ sine)

    grid = product(np.arange(0.2, 2.0, 0.02), np.arange(0.0, 20.0, 0.04))
    best = max(grid, key=lambda place: amplitude(*place)[1])
    found = minimize(lambda place: -amplitude(*place)[1], best, method="Nelder-Mead", options={"xatol": 1e-6, "fatol": 1e-9})
    return {"period_s": found.x[0], "amplitude_g": abs(amplitude(*found.x)[0]) / GRAVITY}


@pytest.mark.parametrize(("case", "row"), rows_of("grid of periods"))
def test_primary_impulse_by_a_grid(case: Case, row: Row, impulse: dict[str, float]) -> None:
    assert impulse[row.quantity.rsplit(".", 1)[1]] == pytest.approx(row.value, abs=row.allowed)
