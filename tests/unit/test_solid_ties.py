"""Ties, chains, hoops and loads on blocks in space: closed forms, and a cone programme of the forces assembled apart."""

from dataclasses import replace
from typing import Any

import clarabel
import numpy as np
import pytest
from scipy import sparse
from test_noisy_solids import corner

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import DeckError, make_deck
from extrados.limit.certificate import certify_solids
from extrados.limit.least_load import LeastLoad, rigid_motion
from extrados.limit.load_path import LoadPath
from extrados.limit.solids import Falls, Programme, SolidLimit
from extrados.model.geometry.solids.assembly import SolidAssembly, Stone, assemble
from extrados.model.geometry.solids.polyhedra import box
from extrados.model.geometry.solids.strands import Strand, hoop_at, solid_at
from extrados.model.structures.dome import make_dome
from extrados.results.model import Result
from extrados.schema.constants import GRAVITY

DENSITY = 2000.0
GROUND = -1


def block(x: float = 0.0, height: float = 2.0) -> Stone:
    return Stone(f"block at {x:g}", [box((x, 0.0, 0.0), (x + 1.0, 1.0, height))], DENSITY)


def straight(first: list[float], last: list[float], blocks: tuple[int, int], low: float, high: float) -> Strand:
    return Strand(0, np.array([first, last], dtype=float), ((blocks[0],), (blocks[1],)), False, low, high)


def pushed(limit: SolidLimit, direction: float = 0.0) -> Programme:
    found = limit.push(direction)
    assert isinstance(found, Programme)
    return found


@pytest.mark.parametrize(("low", "high", "there", "back"), [(0.0, 1.0, 1, 0), (-1.0, 0.0, 0, 1), (-1.0, 1.0, 1, 1)])
def test_a_block_held_at_a_height(low: float, high: float, there: int, back: int) -> None:
    """A block of 1 x 2 m overturns at b / h plus the moment of the tie, strut or spring over that of a push of one g."""
    solids = assemble([block()])
    weight = float(solids.mass[0]) * GRAVITY
    force = 0.1 * weight
    tie = straight([0.5, 0.5, 1.5], [-3.0, 0.5, 1.5], (0, GROUND), low * force, high * force)
    limit = SolidLimit(solids, None, [tie])
    more = force * 1.5 / weight
    found = pushed(limit)
    assert found.gamma == pytest.approx(0.5 + there * more, abs=1e-9)
    assert found.tension[0] == pytest.approx(there * force, abs=1e-6 * force)
    assert pushed(limit, 180.0).gamma == pytest.approx(0.5 + back * more, abs=1e-9)


def test_a_chain_over_a_block() -> None:
    """A chain of one tension from one block over a second to the ground: each slides by its own resultant."""
    solids = assemble([block(0.0, 0.2), block(3.0, 0.2)])
    weight, mu = float(solids.mass[0]) * GRAVITY, 0.6
    force = 0.05 * weight
    points = np.array([[0.5, 0.5, 0.1], [3.5, 0.5, 0.1], [4.5, 0.5, -0.9]])
    chain = Strand(0, points, ((0,), (1,), (GROUND,)), False, 0.0, force)
    down = np.sqrt(0.5)
    second = mu * (1.0 + down * force / weight) - (1.0 - down) * force / weight
    found = pushed(SolidLimit(solids, mu, [chain]), 180.0)
    assert found.gamma == pytest.approx(min(mu + force / weight, second), abs=1e-9)


@pytest.mark.parametrize("sways", [False, True])
def test_a_load_on_top(sways: bool) -> None:
    """A load on the middle of the top adds to the righting moment, and to the overturning one if it sways."""
    found = tilt(
        {"kind": "column", "section": "round", "sides": 4, "width": 1.0, "height": 2.0, "drums": 1},
        direction=0.0,
        rose=4,
        load=[{"x": 0.0, "y": 0.0, "force": "20 kN", "sways": sways}],
    ).results
    bare = tilt({"kind": "column", "section": "round", "sides": 4, "width": 1.0, "height": 2.0, "drums": 1}, direction=0.0, rose=4).results
    weight, load = bare.weight_N, 20e3
    overturns = weight * 1.0 + (load * 2.0 if sways else 0.0)
    assert found.collapse_acceleration_g == pytest.approx(bare.collapse_acceleration_g * (weight + load) / overturns, abs=1e-8)


def outside(solids: SolidAssembly, mu: float, direction: float, pulls: list[tuple[int, np.ndarray, np.ndarray]], most: float) -> float:
    """Greatest acceleration [g] with one tension of 0 to `most` [N], whose forces of one are `pulls` (block, place, force):
    the programme of the forces, assembled corner by corner, in N and m about the origin."""
    columns, rows, values, cones, right = [], [], [], [], []
    count = 3 * len(solids.corner)
    size = count + 2

    def wrench(column: int, on: int, place: np.ndarray, force: np.ndarray) -> None:
        if on != GROUND:
            rows.extend(range(6 * on, 6 * on + 6))
            columns.extend([column] * 6)
            values.extend([*force, *np.cross(place, force)])

    for k, (place, j) in enumerate(zip(solids.corner, solids.corner_joint.tolist(), strict=True)):
        n = solids.normal[j]
        first = np.cross(n, [0.3, 0.5, 0.81])
        first /= np.linalg.norm(first)
        for c, way in enumerate((n, first, np.cross(n, first))):
            wrench(3 * k + c, int(solids.a[j]), place, way)
            wrench(3 * k + c, int(solids.b[j]), place, -way)
    for on, place, force in pulls:
        wrench(count, on, place, force)
    turn = np.radians(direction)
    balance = np.zeros(6 * len(solids.mass))
    for k, (mass, place) in enumerate(zip(solids.mass, solids.centroid, strict=True)):
        down = np.array([0.0, 0.0, -mass * GRAVITY])
        wrench(count + 1, k, place, mass * GRAVITY * np.array([np.cos(turn), np.sin(turn), 0.0]))
        balance[6 * k : 6 * k + 6] = [*down, *np.cross(place, down)]
    scale = float(solids.mass.mean()) * GRAVITY
    unit = np.where(np.array(columns) == count + 1, 1.0 / scale, 1.0)
    equilibrium = sparse.csr_array((unit * np.array(values), (rows, columns)), shape=(len(balance), size))
    cone = sparse.eye_array(count, size, format="csr") * -1.0
    cone = sparse.diags_array(np.tile([mu, 1.0, 1.0], count // 3)) @ cone
    tie = sparse.csr_array(([-1.0, 1.0], ([0, 1], [count, count])), shape=(2, size))
    matrix = sparse.vstack([equilibrium, cone, tie]).tocsc()
    right = np.concatenate([-balance / scale, np.zeros(count), [0.0, most / scale]])
    cones = [clarabel.ZeroConeT(len(balance)), *[clarabel.SecondOrderConeT(3)] * (count // 3), clarabel.NonnegativeConeT(2)]
    cost = np.zeros(size)
    cost[-1] = -1.0
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-9
    found = clarabel.DefaultSolver(sparse.csc_array((size, size)), cost, matrix, right, cones, settings).solve()
    assert "Solved" in str(found.status)
    return float(found.x[-1])


@pytest.mark.parametrize("share", [0.01, 0.05])
def test_a_hoop_of_a_dome(share: float) -> None:
    """A hoop around the second ring, of which each block carries the pulls at its two outer corners: the programme of the forces
    gives the same, and the reference's dome without the keystone .543 and .642 g."""
    solids = make_dome(10.0, 1.0, 180.0, 12, 12)
    most = share * float(solids.mass.sum()) * GRAVITY
    height = float(solids.centroid[12, 2])
    point, blocks = hoop_at(solids, height, "hoop", ())
    assert len(point) == 12 and all(len(own) == 2 for own in blocks)
    found = pushed(SolidLimit(solids, 0.7, [Strand(0, point, blocks, True, 0.0, most)]))
    assert found.tension[0] == pytest.approx(most, rel=1e-6)
    pulls = []
    for k in range(12):
        here, after, before = point[k], point[(k + 1) % 12], point[k - 1]
        pull = (after - here) / np.linalg.norm(after - here) + (before - here) / np.linalg.norm(before - here)
        away = np.linalg.norm(solids.centroid[12:24] - here, axis=1)
        pulls += [(12 + int(i), here, 0.5 * pull) for i in np.argsort(away)[:2]]
    assert found.gamma == pytest.approx(outside(solids, 0.7, 0.0, pulls, most), abs=1e-6)
    assert found.gamma == pytest.approx({0.01: 0.543, 0.05: 0.642}[share], abs=0.005)


def test_a_thin_dome_stands_by_its_hoop() -> None:
    """t / R = .03 is below the least thickness: no forces without a hoop, equilibrium with one that is strong."""
    solids = make_dome(10.0, 0.3, 180.0, 12, 12)
    point, blocks = hoop_at(solids, float(solids.centroid[0, 2]), "hoop", ())
    for force, stands in ((0.0, False), (100e3, False), (200e3, True), (np.inf, True)):
        found = SolidLimit(solids, 0.7, [Strand(0, point, blocks, True, 0.0, force)]).push(0.0)
        assert isinstance(found, Programme if stands else Falls), force


def test_a_barrel_in_bond_by_the_programme_of_the_forces() -> None:
    """The barrel of cases/solid."""
    structure = {"kind": "arch", "radius": 5.0, "thickness": 0.8, "embrace": 157.5, "voussoirs": 14, "depth": 3.0, "stones_across": 3}
    solids = make_deck({"structure": structure, "analysis": {"kind": "tilt"}}).building.solids()
    assert pushed(SolidLimit(solids, 0.7)).gamma == pytest.approx(outside(solids, 0.7, 0.0, [], 0.0), abs=1e-6)


@pytest.mark.parametrize(("z", "words"), [(8.0, "Move the load"), (1.0, "move the load to one of them")])
def test_a_load_in_no_block_or_between_two_has_its_own_advice(z: float, words: str) -> None:
    """Not that of the end of a tie, whose block a key names."""
    deck = {
        "structure": {"kind": "column", "width": 1.0, "height": 2.0, "depth": 1.0, "drums": 2},
        "analysis": {"kind": "tilt", "direction": 0.0, "load": [{"x": 0.0, "y": 0.0, "z": z, "force": 1e3}]},
    }
    result = run_analyses(Context(make_deck(deck), threads=1))[0]
    assert result.status == "refused" and words in result.reason
    assert "load 1" in result.reason and "anchored" not in result.reason and "_stone" not in result.reason


def tied_corner(share: float) -> SolidLimit:
    """The corner of the reference with an anchor against the push along +y, which yields at a share of the weight."""
    solids = assemble(corner())
    point = [1.6, 0.2, 0.875]
    on = solid_at(solids, np.array(point), None, "anchor", (), "start")
    most = share * float(solids.mass.sum()) * GRAVITY
    return SolidLimit(solids, 0.65, [straight(point, [1.6, -1.0, 0.875], (on, GROUND), 0.0, most)])


@pytest.mark.parametrize(("share", "gamma"), [(0.02, 0.4954), (0.05, 0.5503), (np.inf, 0.5566)])
def test_an_anchor_of_a_corner(share: float, gamma: float) -> None:
    """The reference's values, the programme of the forces, and the bounds of pyramids."""
    limit = tied_corner(share)
    found = pushed(limit, 90.0)
    assert found.gamma == pytest.approx(gamma, abs=2e-4)
    strand = limit.strands[0]
    pull = [(strand.blocks[0][0], strand.point[0], np.array([0.0, -1.0, 0.0]))]
    assert found.gamma == pytest.approx(outside(limit.assembly, 0.65, 90.0, pull, min(strand.high, 1e9)), abs=1e-6)
    low, high = limit.pyramids(90.0, 12)
    assert low < found.gamma < high


def test_a_tied_path_and_its_certificate() -> None:
    """The load path of a tied corner is certified from its geometry; a false tension is seen."""
    limit = tied_corner(0.02)
    points = limit.contact_points(90.0)
    state = rigid_motion(points, LoadPath(points, 0.5).follow())
    found, proof = limit.certify(90.0, state)
    assert proof.holds(found.gamma)
    assert 0.25 < found.gamma < pushed(limit, 90.0).gamma
    assert not limit.certify(90.0, replace(state, share=1.001 * state.share + 1e-3))[1].holds(found.gamma)
    lower = limit.certify(90.0, LeastLoad(points).descended(state))
    assert lower[1].holds(lower[0].gamma) and lower[0].gamma <= found.gamma + 1e-9
    dead, live = (np.zeros((len(limit.weight), 6)) for _ in range(2))
    motion = np.zeros_like(dead)
    motion[limit.strands[0].blocks[0][0], 1] = live[limit.strands[0].blocks[0][0], 1] = 1.0
    dead[0, 2] = 1.0
    taken = certify_solids(
        limit.assembly, limit.mu, dead, live, 0.0, np.zeros((len(limit.mu), 3)), np.empty((0, 2)), motion, limit.strands, np.zeros(1)
    )
    assert taken.zero_gap == pytest.approx(limit.strands[0].high)


def tilt(structure: dict[str, Any], ties: list[dict[str, Any]] = (), **keys: Any) -> Result:
    tables = {"structure": structure, "joints": {"friction": 0.7}, "ties": list(ties)}
    (result,) = run_analyses(Context(make_deck({**tables, "analysis": {"kind": "tilt", **keys}}), threads=1))
    return result


DOME = {"kind": "dome", "radius": 10.0, "thickness": 0.3, "rings": 8, "lunes": 8}


def test_a_deck_with_hoops() -> None:
    """A frictionless hoop has one force, a bonded one a force a segment, which carries at least as much."""
    hoop = {"start": [0.0, 0.0, 1.0], "hoop": True, "yield_force": "400 kN"}
    one = tilt(DOME, [hoop], rose=4, face_law=False)
    many = tilt(DOME, [{**hoop, "bonded": True}], rose=4, face_law=False)
    assert [t.name for t in one.results.ties] == ["tie 1"]
    assert [t.name for t in many.results.ties] == [f"tie 1, segment {k}" for k in range(1, 9)]
    assert many.results.collapse_acceleration_g > one.results.collapse_acceleration_g - 1e-9
    assert one.arrays["strand_segment"].data.shape == (8, 2, 3)
    assert "ie 1 " in one.answer


@pytest.mark.parametrize(
    ("tie", "told"),
    [
        ({"start": [9.0, 1.0], "ground": [12.0, 1.0]}, "for blocks in space"),
        ({"start": [0.0, 0.0, 0.0], "hoop": True}, "between two bed joints"),
        ({"start": [0.0, 0.0, 0.5], "ground": [0.0, 0.0, -1.0]}, "no block is at"),
        ({"start": [0.0, 0.0, 0.5], "hoop": True, "end": [0.0, 1.0, 0.5]}, "a closed hoop takes none of the keys"),
        ({"start": [0.0, 0.5], "hoop": True}, "where z is its height"),
        ({"start": [9.0, 0.0, 1.0], "ground": [12.0, 1.0]}, "the same number of coordinates"),
        ({"start": [9.0, 0.0, 1.0], "ground": [12.0, 1.0, 0.0], "bonded": True}, "is only for a hoop"),
    ],
)
def test_what_is_wrong_is_refused(tie: dict[str, Any], told: str) -> None:
    assert told in refusal(DOME, tie)


@pytest.mark.parametrize("tie", [{"ground": [-12.0, 0.0, 1.0]}, {"hoop": True}])
def test_a_tie_in_space_is_refused_in_the_plane(tie: dict[str, Any]) -> None:
    arch = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}
    assert "plane section" in refusal(arch, {"start": [-9.0, 0.0, 1.0], **tie})


def refusal(structure: dict[str, Any], tie: dict[str, Any]) -> str:
    """Why a deck or its tilt is refused."""
    try:
        found = tilt(structure, [tie])
    except DeckError as error:
        return str(error)
    assert found.status == "refused"
    return found.reason
