"""Free polygons: contacts, complaints, JSON and DXF."""

import itertools
import json
from pathlib import Path

import numpy as np
import pytest

import extrados
from extrados.limit.interior import RESIDUAL, CollapseProblem
from extrados.limit.loads import Loads, tilt_loads
from extrados.limit.programme import Immovable, LimitAnalysis
from extrados.model.files import LARGEST_FILE, read
from extrados.model.geometry import dxf
from extrados.model.geometry.assembly import GROUND
from extrados.model.geometry.builder import BadGeometry
from extrados.model.geometry.contacts import Overlap, find_contacts
from extrados.model.geometry.drawing import Drawing, read_json
from extrados.model.geometry.inspection import inspect
from extrados.model.geometry.polygons import below, crossing_edges, crossings, cut, inside, properties, reach, signed_area
from extrados.model.structures.arch import make_arch
from extrados.model.structures.blocks import Polygon, assemble, make_blocks
from extrados.model.structures.brickwork import Bond, make_brickwork

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def square(name: str, x: float, y: float, w: float = 1.0, h: float = 1.0) -> Polygon:
    return Polygon(name, SQUARE * [w, h] + [x, y])


def read_dxf(path: Path, *options, **more) -> Drawing:
    return dxf.read_dxf(read(path, LARGEST_FILE), *options, **more)


def made(drawing: Drawing, tolerance: float = 1e-4, **options):
    """The assembly of a drawing as the structure makes it."""
    return assemble(inspect(drawing, None, tolerance, **options), 2000.0, 1.0)


def trapezoids() -> tuple[list[Polygon], np.ndarray]:
    """Oppenheim's arch with straight-sided voussoirs, and its springings as ground."""
    a = make_arch(10.0, 1.5, 157.5, 7)
    blocks = [Polygon(f"stone {i}", np.array([a.p[i], a.q[i], a.q[i + 1], a.p[i + 1]])) for i in range(7)]
    return blocks, np.array([[*a.p[0], *a.q[0]], [*a.q[7], *a.p[7]]])


def wall(rows: int, columns: int) -> list[Polygon]:
    """Running bond of half-metre stones."""
    blocks = []
    for r in range(rows):
        edges = [0.5 * c for c in range(columns + 1)]
        if r % 2:
            edges = [0.0, *(0.25 + 0.5 * c for c in range(columns)), 0.5 * columns]
        blocks += [square(f"{r}/{c}", x0, 0.25 * r, x1 - x0, 0.25) for c, (x0, x1) in enumerate(itertools.pairwise(edges))]
    return blocks


def test_polygon_properties() -> None:
    area, centre, polar = properties(SQUARE * [2.0, 3.0] + [5.0, -4.0])
    assert area == pytest.approx(6.0) and centre == pytest.approx([6.0, -2.5])
    assert polar == pytest.approx(6.0 * (2.0**2 + 3.0**2) / 12.0)
    assert signed_area(SQUARE[::-1]) == -1.0
    half = cut(SQUARE, np.array([0.0, 0.25]), np.array([0.0, 1.0]))
    assert properties(half)[0] == pytest.approx(0.75)
    bent = np.array([[0.0, 0.0], [2.0, 0.5], [3.0, 3.0], [1.5, 1.0], [0.5, 2.0]])
    levels = np.array([-1.0, 0.3, 0.5, 0.9, 1.7, 4.0])
    for level, (area, first_x, first_y) in zip(levels, below(bent, levels), strict=True):
        part = cut(bent, np.array([0.0, level]), np.array([0.0, -1.0]))
        expected = properties(part)[:2] if len(part) else (0.0, np.zeros(2))
        assert area == pytest.approx(expected[0]) and (first_x, first_y) == pytest.approx(tuple(area * expected[1]))
    assert crossings(SQUARE, 0.5) == pytest.approx([0.0, 1.0])
    levels = np.array([-0.5, 0.25, 0.5, 2.0])
    found = reach(SQUARE, levels)
    for level, (low, high) in zip(levels.tolist(), found.tolist(), strict=True):
        met = crossings(SQUARE, level)
        assert (low, high) == ((np.inf, -np.inf) if not len(met) else pytest.approx((met[0], met[-1])))
    assert inside(SQUARE, np.array([[0.5, 0.5], [1.5, 0.5]])).tolist() == [True, False]
    assert crossing_edges(SQUARE[[0, 2, 1, 3]]) is not None and crossing_edges(SQUARE) is None


def test_straight_sided_voussoirs() -> None:
    """Trapezoids of the same joints weigh differently: .3736 in place of .3700."""
    blocks, ground = trapezoids()
    arch = make_blocks(blocks, ground)
    state, mechanism = LimitAnalysis(arch).collapse()
    assert state.gamma == pytest.approx(0.3736, abs=5.1e-5) and len(mechanism.hinges) == 4
    assert len(arch.a) == 8 and (arch.b == GROUND).sum() == 2
    # However the polygons are ordered and turned, the joints are the same.
    turned = [Polygon(b.name, np.roll(b.points[::-1], 1, axis=0)) for b in blocks[::-1]]
    again = make_blocks(turned, ground[::-1])
    assert LimitAnalysis(again).collapse()[0].gamma == pytest.approx(state.gamma, abs=1e-12)


def test_wall_tilts_as_one_or_slides() -> None:
    """Six courses of four stones: a column split off rocks alone; with little friction the wall slides at mu."""
    section = make_blocks(wall(6, 4), None)
    assert LimitAnalysis(section, 0.2).collapse()[0].gamma == pytest.approx(0.2, abs=1e-9)
    for form in ("reduced", "sparse"):
        state, mechanism = LimitAnalysis(section, 0.7, form=form).collapse()
        assert state.gamma == pytest.approx(LimitAnalysis(section, 0.7).collapse()[0].gamma, abs=1e-9)
        assert abs(state.gamma - mechanism.upper_bound) < 1e-9 and mechanism.defect < 1e-7
    assert state.gamma < 2.0 / 1.5  # the whole wall about its toe
    # As one stone it turns about its toe.
    one = make_blocks([square("wall", 0.0, 0.0, 2.0, 1.5)], None)
    assert LimitAnalysis(one).collapse()[0].gamma == pytest.approx(2.0 / 1.5)


@pytest.mark.parametrize("friction", [0.25, 0.5, 0.8])
def test_interior_point_method_on_a_wall(friction: float) -> None:
    """Against HiGHS on the reduced form: capacity, bounds both ways, laws of the joints, work of the mechanism."""
    section = make_blocks(wall(10, 6), None)
    exact, _ = LimitAnalysis(section, friction, form="reduced").collapse()
    system = LimitAnalysis(section, friction, form="sparse").system
    problem = CollapseProblem(system, np.full(len(section.a), friction), 1, dilates=True)
    inner, misfit = problem.state()
    assert misfit < 10.0 * RESIDUAL and inner.gamma == pytest.approx(exact.gamma, abs=5e-9)
    assert problem.residuals(inner.gamma, inner.corners, inner.share, inner.u).worst < 1e-6
    assert inner.n.min() > 0.0
    assert (np.abs(inner.s) <= friction * inner.n.sum(axis=1)).all()
    assert system.matrix @ np.append(inner.corners.ravel(), inner.gamma) == pytest.approx(system.right, abs=1e-9)
    # Openings dilate at least as much as they slide: the flow rule of the bound.
    motion = problem.motion(inner.u)
    assert (motion[:, :2].min(axis=1) >= friction * np.abs(motion[:, 2]) - 1e-9).all()
    for direction in (1, -1):
        state, mechanism = LimitAnalysis(section, friction, form="sparse").collapse(direction)
        assert abs(state.gamma - mechanism.upper_bound) < 1e-9 and mechanism.defect < 1e-9
        # A wall is its own mirror image but for the bond: the courses are symmetric here.
        assert state.gamma == pytest.approx(direction * exact.gamma, abs=5e-9)


def test_a_stone_in_a_vice_cannot_be_moved() -> None:
    """Held between two walls that are ground, it bears any sideways load: no capacity is made up."""
    ground = np.array([[0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 1.0, 1.0]])
    held = make_blocks([square("held", 0, 0)], ground)
    for form in ("reduced", "sparse"):
        with pytest.raises(Immovable, match="no load of this kind"):
            LimitAnalysis(held, form=form).collapse()


def test_what_friction_holds_by_force_at_will_cannot_be_moved() -> None:
    """Pressed between two walls that are ground, it bears any lift: the load is that of the bound, and not told."""
    ground = np.array([[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 1.0, 1.0]])
    held = make_blocks([square("held", 0, 0)], ground)
    loads = tilt_loads(held)
    lifted = Loads(loads.dead, -loads.dead)
    with pytest.raises(Immovable, match="no load of this kind"):
        LimitAnalysis(held, 0.1, loads=lifted, form="reduced").collapse()


def test_stones_wedged_without_sliding_have_a_capacity() -> None:
    """Their forces on each other are at will and reach the bound; the load does not come from there."""
    section = make_brickwork(Bond(0.3, 0.1, "half"), 0.9, 0.5)
    for direction in (1, -1):
        state, mechanism = LimitAnalysis(section, form="reduced").collapse(direction)
        sparse, _ = LimitAnalysis(section, form="sparse").collapse(direction)
        assert abs(state.gamma - mechanism.upper_bound) < 1e-8
        assert state.gamma == pytest.approx(sparse.gamma, rel=1e-7)


def test_contacts_of_many_stones() -> None:
    blocks = wall(10, 8)
    found = find_contacts([b.points for b in blocks], np.array([[-1.0, 0.0, 9.0, 0.0]]), 1e-4)
    # Bed joints: 15 between two courses of 8 and 9; heads: 7 or 8 in a course; base: 8
    heads = 5 * 7 + 5 * 8
    beds = 9 * 16
    assert (found.b == GROUND).sum() == 8
    assert len(found.a) - 8 == heads + beds
    length = np.hypot(*(found.q - found.p).T)
    assert length.min() == pytest.approx(0.25)


@pytest.mark.parametrize(
    ("blocks", "words"),
    [
        ([square("low", 0, 0), square("high", 0, 0.9)], "'low' and 'high' overlap"),
        ([square("big", 0, 0, 3, 3), square("small", 1, 1, 0.5, 0.5)], "'big' and 'small' overlap by 1.5 m .* draw them again"),
        ([square("one", 0, 0), square("same", 0, 0)], "overlap"),
        ([square("base", 0, 0), square("afloat", 5, 5)], "no joints connect the ground with block 'afloat'"),
        ([square("base", 0, 0), square("gap", 0, 1.002)], "'base' and 'gap' are 2 mm apart"),
        ([square("base", 0, 0), Polygon("bow", SQUARE[[0, 2, 1, 3]])], "'bow': the outline crosses itself"),
        ([square("base", 0, 0), Polygon("line", np.array([[0, 1], [1, 1], [0.5, 1.0]]))], "'line'"),
        ([Polygon("two", SQUARE[:2])], "'two': 2 distinct vertices"),
        ([square("twin", 0, 0), square("twin", 1, 0)], "two blocks are called 'twin'"),
        ([square("base", 0, 0), square("corner", 1, 1)], "block 'corner'"),  # they touch at a point: no joint
        ([], "no blocks"),
    ],
)
def test_bad_blocks_are_named(blocks: list, words: str) -> None:
    with pytest.raises(BadGeometry, match=words):
        make_blocks(blocks, None)


def test_ground_out_of_reach() -> None:
    with pytest.raises(BadGeometry, match="no block touches the ground"):
        make_blocks([square("base", 0, 0)], np.array([[0.0, -1.0, 1.0, -1.0]]))


def test_json(tmp_path: Path) -> None:
    blocks, ground = trapezoids()
    data = {
        "unit": "mm",
        "blocks": [{"name": b.name, "points": (1e3 * b.points).tolist()} for b in blocks],
        "ground": (1e3 * ground).tolist(),
    }
    path = tmp_path / "arch.json"
    path.write_text(json.dumps(data))
    arch = made(read_json(read(path, LARGEST_FILE)))
    assert LimitAnalysis(arch).collapse()[0].gamma == pytest.approx(0.3736, abs=5.1e-5)
    for change, words in (
        ({"unit": "furlong"}, "unit 'furlong'"),
        ({"blocks": [{"name": "bad", "points": [[0, 0], [1]]}]}, "'bad': points"),
        ({"blocks": [{"points": [[0, 0], [1, 0], [1, 1]], "density": -5}]}, "density -5"),
        ({"blocks": [{"points": [[0, 0], [1, 0], [1, 1]], "density": 10**400}]}, f"density {10**39}..., expected"),
        ({"blocks": [], "unit": "m" * 400}, f"unit '{'m' * 39}...; expected"),
        ({"colour": "red"}, "unknown key 'colour'"),
        ({"ground": [[0, 0, 1]]}, "ground"),
    ):
        path.write_text(json.dumps({**data, **change}))
        with pytest.raises(BadGeometry, match=words):
            read_json(read(path, LARGEST_FILE))
    for text in ("[1, 2", "[]", '{"blocks": 5}', "[" * 100000):
        path.write_text(text)
        with pytest.raises(BadGeometry, match=r"arch\.json"):
            read_json(read(path, LARGEST_FILE))


ezdxf = pytest.importorskip("ezdxf")


def drawing(path: Path, units: int, extra=None) -> Path:
    blocks, ground = trapezoids()
    document = ezdxf.new(units=units)
    space = document.modelspace()
    scale = {4: 1e3, 6: 1.0, 0: 1e3}[units]
    for b in blocks:
        space.add_lwpolyline((scale * b.points).tolist(), close=True, dxfattribs={"layer": "STONE"})
    for x1, y1, x2, y2 in scale * ground:
        space.add_line((x1, y1), (x2, y2), dxfattribs={"layer": "ground"})
    if extra:
        extra(space)
    document.saveas(path)
    return path


def test_dxf(tmp_path: Path) -> None:
    path = drawing(tmp_path / "arch.dxf", 4)
    arch = made(read_dxf(path))
    assert LimitAnalysis(arch).collapse()[0].gamma == pytest.approx(0.3736, abs=5.1e-5)
    assert arch.block_names[0].startswith("STONE #")


def test_dxf_without_units_asks(tmp_path: Path) -> None:
    path = drawing(tmp_path / "arch.dxf", 0)
    with pytest.raises(BadGeometry, match=r"has no unit .*unit = \"mm\""):
        read_dxf(path)
    arch = made(read_dxf(path, "mm"))
    assert max(arch.p[:, 0].max(), arch.q[:, 0].max()) == pytest.approx(10.75 * np.sin(np.radians(78.75)), abs=1e-6)


def test_dxf_complaints_name_the_layer(tmp_path: Path) -> None:
    def mesh(space) -> None:
        space.add_3dface([(0, 0), (1, 0), (1, 1)], dxfattribs={"layer": "SOLIDS"})

    path = drawing(tmp_path / "arch.dxf", 6, mesh)
    with pytest.raises(BadGeometry, match=r"layer 'SOLIDS', 3DFACE #.* explode it"):
        read_dxf(path)
    assert len(read_dxf(path, layers=["STONE"]).blocks) == 7  # naming the layers leaves the others out
    with pytest.raises(BadGeometry, match="layer 'BRICK' does not exist"):
        read_dxf(path, layers=["BRICK"])


def test_curved_voussoirs_of_a_drawing(tmp_path: Path) -> None:
    """Polylines with bulges: ring sectors, so the capacity is that of sector voussoirs."""
    a = make_arch(10.0, 1.5, 157.5, 7)
    document = ezdxf.new(units=6)
    bulge = np.tan(np.radians(157.5 / 7) / 4)
    for i in range(7):
        p0, q0, q1, p1 = a.p[i], a.q[i], a.q[i + 1], a.p[i + 1]
        document.modelspace().add_lwpolyline([(*p0, 0.0), (*q0, -bulge), (*q1, 0.0), (*p1, bulge)], format="xyb", close=True)
    for j in (0, 7):
        document.modelspace().add_line(a.p[j], a.q[j], dxfattribs={"layer": "GROUND"})
    document.saveas(tmp_path / "sectors.dxf")
    arch = made(read_dxf(tmp_path / "sectors.dxf"))
    assert LimitAnalysis(arch).collapse()[0].gamma == pytest.approx(0.3700, abs=1e-4)


def test_not_a_drawing(tmp_path: Path) -> None:
    (tmp_path / "a.dxf").write_text("no drawing at all")
    with pytest.raises(BadGeometry, match=r"a\.dxf"):
        read_dxf(tmp_path / "a.dxf")
    with pytest.raises(BadGeometry, match=r"none\.dxf"):
        read("none.dxf", LARGEST_FILE, tmp_path)


def test_overlap_is_a_complaint_about_geometry() -> None:
    assert issubclass(Overlap, BadGeometry)


def test_a_long_row_of_stones_is_answered() -> None:
    """500 squares side by side slide together, each under its own friction: the joints between them are idle."""
    row = [{"name": f"s{i}", "points": [[i, 0], [i + 1, 0], [i + 1, 1], [i, 1]]} for i in range(500)]
    run = extrados.run({"structure": {"kind": "blocks", "block": row}, "joints": {"friction": 0.7}, "analysis": {"kind": "tilt"}})
    assert run["tilt"].collapse_acceleration_g == pytest.approx(0.7, abs=1e-8)
