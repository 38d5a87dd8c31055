"""Point clouds of walls and vaults: fitted faces, and the capacity of the blocks that given courses cut."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.limit.programme import LimitAnalysis
from extrados.limit.solids import Programme, SolidLimit
from extrados.model.errors import BadGeometry
from extrados.model.geometry.clouds import fit_barrel, fit_wall, parse_cloud
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.structures.arch import make_arch
from extrados.model.structures.scan import Scan
from extrados.schema.contained import Unreadable

FAR = np.array([431250.0, 5062480.0, 310.0])
NOISE = 5e-3


def turned(points: np.ndarray, degrees: float, where: np.ndarray) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return points @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]) + where


def wall_cloud(seed: int, *, faces: tuple[float, ...] = (0.0, 0.4), opening: bool = False, count: int = 20_000) -> np.ndarray:
    """A wall of 4 m by 3 m and .4 m thickness that leans by 1 in 100 towards +y, with noise and one stray point in fifty."""
    rng = np.random.default_rng(seed)
    x, z = rng.uniform(0.0, 4.0, count), rng.uniform(0.0, 3.0, count)
    y = rng.choice(np.array(faces), count) + 0.01 * z + rng.normal(0.0, NOISE, count)
    stray = rng.random(count) < 0.02
    y[stray] += rng.uniform(-1.0, 1.0, stray.sum())
    points = np.column_stack([x, y, z])
    return points[~((x > 1.0) & (x < 2.0) & (z > 1.0) & (z < 2.0))] if opening else points


def barrel_cloud(seed: int, radii: tuple[float, ...] = (4.0, 4.5), count: int = 20_000) -> np.ndarray:
    """A barrel about the axis y, of 120 degrees, 5 m long."""
    rng = np.random.default_rng(seed)
    angle, y = np.radians(rng.uniform(30.0, 150.0, count)), rng.uniform(0.0, 5.0, count)
    r = rng.choice(np.array(radii), count) + rng.normal(0.0, NOISE, count)
    return np.column_stack([r * np.cos(angle), y, r * np.sin(angle)])


def push(solids: SolidAssembly, degrees: float) -> float:
    found = SolidLimit(solids, 0.7).push(degrees)
    assert isinstance(found, Programme)
    return found.gamma


@pytest.mark.parametrize(("seed", "degrees"), [(1, 0.0), (2, 37.0), (3, 151.0)])
def test_a_wall_out_of_its_plane(seed: int, degrees: float) -> None:
    """It overturns at (thickness / 2 -+ lean) over half the height: moments about an edge of the sole."""
    points = turned(wall_cloud(seed), degrees, FAR)
    fit = fit_wall(points)
    thickness = float((fit.front - fit.back) @ [1.0, 0.0, 0.0])
    assert thickness == pytest.approx(0.4, abs=1e-3) and max(f.rms for f in fit.fits) == pytest.approx(NOISE, rel=0.1)
    assert sum(f.dropped for f in fit.fits) == pytest.approx(0.02 * len(points), rel=0.3)
    solids = Scan(shape="wall", courses=6, block_length=1.0).solids(points, 2000.0, "wall.ply")
    assert len(solids.mass) == 3 * 4 + 3 * 5
    lean = 0.01 * 1.5
    for way, arm in ((degrees + 90.0, 0.2 - lean), (degrees - 90.0, 0.2 + lean)):
        assert push(solids, way) == pytest.approx(arm / 1.5, rel=0.01)
    assert "points are within" in solids.notes[0] and "mm of the fitted surface (root" in solids.notes[0] and solids.remarks == ()


def test_beds_are_where_they_are_given() -> None:
    solids = Scan(shape="wall", beds=[0.5, 1.5]).solids(wall_cloud(4), 2000.0, "wall.ply")
    assert len(solids.mass) == 3 and solids.mass[1] == pytest.approx(2000.0 * 4.0 * 0.4 * 1.0, rel=0.01)
    with pytest.raises(ValueError, match="increasing"):
        Scan(shape="wall", beds=[1.5, 0.5])


def test_one_face_needs_a_thickness_and_openings_are_mentioned() -> None:
    one = wall_cloud(5, faces=(0.0,))
    with pytest.raises(BadGeometry, match="If the points show one face only, give `thickness`"):
        Scan(shape="wall", courses=3).solids(one, 2000.0, "wall.ply")
    made = Scan(shape="wall", courses=3, thickness=0.4).solids(one, 2000.0, "wall.ply")
    assert made.measures["thickness_m"] == pytest.approx(0.4)
    open_wall = Scan(shape="wall", courses=3).solids(wall_cloud(6, opening=True), 2000.0, "wall.ply")
    assert "% of the wall. Openings are not modelled" in open_wall.remarks[0]


@pytest.mark.parametrize(("seed", "degrees", "length"), [(1, 0.0, None), (2, 63.0, 1.0)])
def test_a_barrel_has_the_capacity_of_its_section(seed: int, degrees: float, length: float | None) -> None:
    points = turned(barrel_cloud(seed), degrees, FAR)
    fit = fit_barrel(points)
    assert fit.inner[2] == pytest.approx(4.0, abs=2e-3) and fit.outer[2] == pytest.approx(4.5, abs=2e-3)
    assert np.degrees(np.ptp(fit.angle)) == pytest.approx(120.0, abs=0.3)
    solids = Scan(shape="barrel", courses=12, block_length=length).solids(points, 2000.0, "vault.las")
    true = LimitAnalysis(make_arch(4.25, 0.5, 120.0, 12), 0.7).collapse()[0].gamma
    assert push(solids, degrees) == pytest.approx(true, rel=0.01)


def test_an_intrados_alone() -> None:
    points = barrel_cloud(7, (4.0,))
    with pytest.raises(BadGeometry, match="If the points show one face only, give `thickness`"):
        fit_barrel(points)
    made = Scan(shape="barrel", courses=12, thickness=0.5, axis=90.0).solids(points, 2000.0, "vault.las")
    true = LimitAnalysis(make_arch(4.25, 0.5, 120.0, 12), 0.7).collapse()[0].gamma
    assert push(made, 0.0) == pytest.approx(true, rel=0.01)


def test_two_faces_with_a_thickness_are_told_apart() -> None:
    """The words name the surplus key, not one that the deck already has."""
    for shape, points in (("wall", wall_cloud(9, count=5000)), ("barrel", barrel_cloud(9, count=5000))):
        with pytest.raises(BadGeometry, match="If the points show both faces, remove `thickness`"):
            Scan(shape=shape, courses=3, thickness=0.45).solids(points, 2000.0, "scan.ply")


def test_points_of_another_shape_are_refused_or_doubted() -> None:
    """Semi-ellipse and sloping barrel have no circle across a horizontal axis; a bulge is stated with its misfit."""
    rng = np.random.default_rng(10)
    angle, y, r = np.radians(rng.uniform(0.0, 180.0, 5000)), rng.uniform(0.0, 5.0, 5000), rng.choice([0.0, 0.5], 5000)
    ellipse = np.column_stack([(4.0 + r) * np.cos(angle), y, (2.5 + r) * np.sin(angle)])
    c, s = np.cos(np.radians(8.0)), np.sin(np.radians(8.0))
    sloping = barrel_cloud(10, count=5000) @ np.array([[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]])
    for points in (ellipse, sloping):
        with pytest.raises(BadGeometry, match="Otherwise the points do not form a circular barrel with a horizontal axis"):
            Scan(shape="barrel", courses=12).solids(points, 2000.0, "vault.las")
    wall = wall_cloud(11, count=5000)
    wall[:, 1] += 0.1 * np.sin(np.pi * wall[:, 2] / 3.0)
    (remark,) = Scan(shape="wall", courses=3).solids(wall, 2000.0, "wall.ply").remarks
    assert (
        "mm (95th percentile) from the fitted" in remark and "more than a tenth of the thickness of 4" in remark and "uncertain" in remark
    )


@pytest.mark.parametrize(("shape", "height"), [("wall", 0.06), ("barrel", 0.07)])
def test_a_bulge_over_a_tenth_of_a_face_counts_in_its_misfit(shape: str, height: float) -> None:
    """Its points leave the plane or the circle in one region: they do not shape the face, and they are not stray points."""
    points = wall_cloud(14) if shape == "wall" else barrel_cloud(14)
    clean = Scan(shape=shape, courses=3).solids(points, 2000.0, "scan.ply")
    along, across, width = (points[:, 0], points[:, 2], 0.3 * 4.0) if shape == "wall" else (points[:, 1], points[:, 0], 0.35 * 5.0)
    patch = (np.abs(along - 2.5) < 0.5 * width) & (np.abs(across - (2.0 if shape == "wall" else 0.5)) < (0.5 if shape == "wall" else 1.0))
    if shape == "wall":
        patch &= points[:, 1] > 0.2 + 0.01 * points[:, 2]
        points[patch, 1] += height
    else:
        radius = np.hypot(points[:, 0], points[:, 2])
        patch &= radius < 4.25
        points[patch] *= np.where(np.arange(3) == 1, 1.0, (1.0 - height / radius[patch])[:, None])
    assert 0.08 < patch.sum() / (0.5 * len(points)) < 0.15
    bulged = Scan(shape=shape, courses=3).solids(points, 2000.0, "scan.ply")
    assert clean.remarks == () and bulged.measures == pytest.approx(clean.measures, rel=2e-3, abs=2e-2)
    (remark,) = bulged.remarks
    stated = float(remark.split("up to ")[1].split(" mm")[0])
    assert stated == pytest.approx(1e3 * height, abs=3e3 * NOISE) and "more than a tenth of the thickness" in remark


def test_a_bulge_at_the_top_does_not_shorten_a_wall() -> None:
    points = wall_cloud(15)
    points[points[:, 2] > 2.7, 1] += 0.06
    made = Scan(shape="wall", courses=3).solids(points, 2000.0, "scan.ply")
    assert made.measures["height_m"] == pytest.approx(3.0, abs=0.02) and "uncertain" in made.remarks[0]


def test_stray_points_far_away_change_nothing() -> None:
    far = np.array([[40.0, 0.0, 0.0], [0.0, 0.0, 30.0]])
    wall, barrel = wall_cloud(12), barrel_cloud(12)
    for shape, points in (("wall", wall), ("barrel", barrel)):
        clean, strayed = (Scan(shape=shape, courses=3).solids(p, 2000.0, "scan.ply") for p in (points, np.vstack([points, far])))
        assert strayed.remarks == clean.remarks == ()
        assert strayed.measures == pytest.approx(clean.measures, rel=2e-3, abs=1e-2)


@pytest.mark.parametrize(("shape", "length"), [("wall", 1e-3), ("barrel", 1e-9), ("wall", 1e-12)])
def test_blocks_are_counted_before_they_are_made(shape: str, length: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("extrados.model.geometry.solids.scanned.hull", None)
    with pytest.raises(BadGeometry, match=r"about .* blocks, and at most 20000 are allowed. Increase `block_length`"):
        points = wall_cloud(13, count=2000) if shape == "wall" else barrel_cloud(13, count=2000)
        Scan(shape=shape, courses=10, block_length=length).solids(points, 2000.0, "scan.ply")


@pytest.mark.parametrize("sort", ["ply", "xyz", "las"])
def test_a_deck_of_a_point_cloud(tmp_path: Path, sort: str) -> None:
    points = wall_cloud(8, count=4000)
    path = tmp_path / f"wall.{sort}"
    if sort == "las":
        laspy = pytest.importorskip("laspy")
        cloud = laspy.create()
        cloud.header.scales = [1e-4] * 3
        cloud.x, cloud.y, cloud.z = points.T
        cloud.write(path)
    else:
        path.write_bytes(pytest.importorskip("trimesh").PointCloud(points).export(file_type=sort) if sort == "ply" else _xyz(points))
    tables: dict[str, Any] = {
        "structure": {"kind": "blocks", "file": path.name, "scan": {"shape": "wall", "courses": 3}},
        "analysis": {"kind": "tilt", "direction": 90.0, "rose": 4, "face_law": False, "block_size": False},
    }
    found = run_analyses(Context(make_deck(tables, tmp_path), threads=1))[0]
    assert found["collapse_acceleration_g"] == pytest.approx((0.2 - 0.015) / 1.5, rel=0.015)
    assert any("back face: " in w and "points were not used" in w for w in found.warnings)


def _xyz(points: np.ndarray) -> bytes:
    return "\n".join(f"{x:.5f} {y:.5f} {z:.5f}" for x, y, z in points.tolist()).encode()


@pytest.mark.parametrize(
    "text", ["X Y Z R\n1.5 2.5 3.5 9\n4 5 6 9\n", "1.5;2.5;3.5\n4;5;6\n", "1.5,2.5,3.5\n4,5,6\n", "//pts\n2\n1.5 2.5 3.5\n4 5 6\n"]
)
def test_lines_of_usual_exports_are_read(text: str) -> None:
    assert parse_cloud(text.encode(), ".xyz")["points"].tolist() == [[1.5, 2.5, 3.5], [4.0, 5.0, 6.0]]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("Scan, v. 2\n1,234;5,678;9,012\n", "no three numbers x, y and z with a decimal point"),
        ("1,5 2,5 3,5\n", "no three numbers x, y and z with a decimal point"),
        ("X Y Z\n1 2 3\n4 5\n", "three numbers x, y and z in each line below line 2"),
        ("1 2 3\n4 nan 6\n", "no points with three finite coordinates"),
    ],
)
def test_other_lines_are_refused_in_words(text: str, said: str) -> None:
    with pytest.raises(Unreadable, match=said):
        parse_cloud(text.encode(), ".xyz")
