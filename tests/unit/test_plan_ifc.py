"""Decks from IFC models: walls by their solids, openings, storeys; what cannot be read. Models are written here as text."""

import numpy as np
import pytest

from extrados.bridges.plan_ifc import deck_of_ifc
from extrados.decks.reader import DeckError, read_text

pytest.importorskip("ifcopenshell", reason="ifcopenshell is not installed: pip install extrados[ifc]")


class Model:
    """An IFC file of millimetres: storeys at 0 and 3 m."""

    def __init__(self, prefix=".MILLI."):
        self.rows: list[str] = []
        self.unit = self.put(f"IFCSIUNIT(*,.LENGTHUNIT.,{prefix},.METRE.)")
        units = self.put(f"IFCUNITASSIGNMENT((#{self.unit}))")
        self.context = self.put(f"IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#{self.axes((0, 0, 0))},$)")
        self.put(f"IFCPROJECT('0project00000000000000',$,'p',$,$,$,$,(#{self.context}),#{units})")
        for k, z in enumerate((0.0, 3000.0)):
            self.put(f"IFCBUILDINGSTOREY('0storey000000000000{k:03}',$,'s{k}',$,$,#{self.place((0, 0, z))},$,$,.ELEMENT.,{z!r})")

    def put(self, text):
        self.rows.append(text)
        return len(self.rows)

    def point(self, values):
        return self.put(f"IFCCARTESIANPOINT(({','.join(repr(float(v)) for v in values)}))")

    def way(self, values):
        return self.put(f"IFCDIRECTION(({','.join(repr(float(v)) for v in values)}))")

    def axes(self, at, x=(1, 0, 0), z=(0, 0, 1)):
        return self.put(f"IFCAXIS2PLACEMENT3D(#{self.point(at)},#{self.way(z)},#{self.way(x)})")

    def place(self, at, x=(1, 0, 0), within="$"):
        return self.put(f"IFCLOCALPLACEMENT({within},#{self.axes(at, x)})")

    def body(self, corners, depth, at=(0, 0, 0), x=(1, 0, 0), z=(0, 0, 1)):
        points = ",".join(f"#{self.point(p)}" for p in [*corners, corners[0]])
        profile = self.put(f"IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$,#{self.put(f'IFCPOLYLINE(({points}))')})")
        solid = self.put(f"IFCEXTRUDEDAREASOLID(#{profile},#{self.axes(at, x, z)},#{self.way((0, 0, 1))},{float(depth)!r})")
        shape = self.put(f"IFCSHAPEREPRESENTATION(#{self.context},'Body','SweptSolid',(#{solid}))")
        return self.put(f"IFCPRODUCTDEFINITIONSHAPE($,$,(#{shape}))")

    def wall(self, start, way, length, thickness, foot=0.0, height=3000.0, openings=()):
        """A wall whose reference line is its outer face; openings: s from, to, z from, to above its foot."""
        place = self.place((*start, foot), (*way, 0.0))
        body = self.body([(0, 0), (length, 0), (length, thickness), (0, thickness)], height)
        n = len(self.rows)
        wall = self.put(f"IFCWALLSTANDARDCASE('0wall0000000000000{n:04}',$,'w{n}',$,$,#{place},#{body},$,$)")
        for a, b, low, high in openings:
            hole = self.body(
                [(0, 0), (b - a, 0), (b - a, high - low), (0, high - low)], 3 * thickness, (a, -thickness, low), (1, 0, 0), (0, 1, 0)
            )
            # its profile stands upright: z of the solid is across the wall, so that y of the profile runs down
            at = self.put(f"IFCLOCALPLACEMENT(#{place},#{self.axes((0, 0, high - low))})")
            n = len(self.rows)
            opening = self.put(f"IFCOPENINGELEMENT('0hole0000000000000{n:04}',$,$,$,$,#{at},#{hole},$,$)")
            self.put(f"IFCRELVOIDSELEMENT('0void0000000000000{n:04}',$,$,$,#{wall},#{opening})")
        return wall

    def save(self, folder):
        head = "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\nFILE_SCHEMA(('IFC4'));\nENDSEC;\nDATA;\n"
        path = folder / "house.ifc"
        path.write_text(head + "".join(f"#{k}={row};\n" for k, row in enumerate(self.rows, 1)) + "ENDSEC;\nEND-ISO-10303-21;\n")
        return path


def house(prefix=".MILLI.", unit=1.0):
    """Outer walls of 10 by 6 m, 0.4 m thick, on two storeys, the upper ones 0.3 m; a window and a door in the front."""
    model = Model(prefix)
    for foot, t, openings in ((0.0, 400.0, [(2000, 3200, 900, 2300), (6000, 7000, 0, 2100)]), (3000.0, 300.0, [(2000, 3200, 900, 2200)])):
        inner = 6000 - 2 * t
        model.wall((0, 0), (1, 0), 10000, t, foot, 3000.0, openings)
        model.wall((10000, t), (0, 1), inner, t, foot)
        model.wall((10000, 6000), (-1, 0), 10000, t, foot)
        model.wall((0, 6000 - t), (0, -1), inner, t, foot)
    return model


def walls_in(text):
    deck = read_text(text.encode())
    return {tuple(np.round([*w.start, *w.end], 3)): w for w in deck.structure.walls}, deck


def test_walls_openings_and_storeys_are_those_of_the_model(tmp_path):
    found, deck = walls_in(deck_of_ifc(house().save(tmp_path)))
    assert deck.structure.storeys == pytest.approx([3.0, 3.0])
    front = next(w for k, w in found.items() if k[1] == k[3] == 0.2)
    assert (front.start, front.end) == (pytest.approx([0.2, 0.2]), pytest.approx([9.8, 0.2]))
    first = [o for o in front.openings if o.storey == 1]
    assert [(o.x, o.z) for o in first] == [
        (pytest.approx([1.8, 3.0]), pytest.approx([0.9, 2.3])),
        (pytest.approx([5.8, 6.8]), pytest.approx([0.0, 2.1])),
    ]
    above = [o for w in found.values() for o in w.openings if o.storey == 2]
    assert [(o.z, o.x[1] - o.x[0]) for o in above] == [(pytest.approx([0.9, 2.2]), pytest.approx(1.2))]
    assert sorted(found) == [(0.2, 0.2, 0.2, 5.8), (0.2, 0.2, 9.8, 0.2), (0.2, 5.8, 9.8, 5.8), (9.8, 0.2, 9.8, 5.8)]
    assert all(w.thicknesses == pytest.approx([0.4, 0.3]) for w in found.values())


def test_walls_that_are_no_straight_boxes_are_counted_and_left_out(tmp_path):
    """A quarter of a ring, by arcs and by chords, and an L; the straight wall is read."""
    model = Model()
    model.wall((0, 0), (1, 0), 5000, 300)
    turns = np.radians([0, 30, 60, 90])
    ring = [(r * np.cos(t), r * np.sin(t)) for r, way in ((3300.0, turns), (3000.0, turns[::-1])) for t in way]
    for corners in (ring, [(0, 0), (3000, 0), (3000, 300), (300, 300), (300, 3000), (0, 3000)]):
        place, body, n = model.place((9000, 0, 0)), model.body(corners, 3000), len(model.rows)
        model.put(f"IFCWALLSTANDARDCASE('0wall0000000000000{n:04}',$,'odd',$,$,#{place},#{body},$,$)")
    points = ",".join(f"({x!r},{y!r})" for x, y in ring[:3] + ring[4:7])
    listed = model.put(f"IFCCARTESIANPOINTLIST2D(({points}))")
    curve = model.put(
        f"IFCINDEXEDPOLYCURVE(#{listed},(IFCARCINDEX((1,2,3)),IFCLINEINDEX((3,4)),IFCARCINDEX((4,5,6)),IFCLINEINDEX((6,1))),$)"
    )
    profile = model.put(f"IFCARBITRARYCLOSEDPROFILEDEF(.AREA.,$,#{curve})")
    solid = model.put(f"IFCEXTRUDEDAREASOLID(#{profile},#{model.axes((0, 0, 0))},#{model.way((0, 0, 1))},3000.)")
    shape = model.put(f"IFCSHAPEREPRESENTATION(#{model.context},'Body','SweptSolid',(#{solid}))")
    body, place = model.put(f"IFCPRODUCTDEFINITIONSHAPE($,$,(#{shape}))"), model.place((20000, 0, 0))
    model.put(f"IFCWALLSTANDARDCASE('0wall00000000000round',$,'round',$,$,#{place},#{body},$,$)")
    text = deck_of_ifc(model.save(tmp_path))
    found, _ = walls_in(text)
    assert len(found) == 1 and "Not considered: 3 walls whose solids are not straight boxes" in text


def test_walls_above_each_other_are_one(tmp_path):
    model = Model()
    for foot in (0.0, 3000.0):
        model.wall((0, 0), (1, 0), 5000, 300, foot)
        model.wall((5000, 300), (0, 1), 4000, 300, foot)
    found, deck = walls_in(deck_of_ifc(model.save(tmp_path)))
    assert len(found) == 2 and all(w.thickness == pytest.approx(0.3) and w.storeys is None for w in found.values())
    assert deck.building.frame(deck.analyses[0].frame).piers == 4


def test_what_is_no_model_or_has_no_walls_is_refused(tmp_path):
    (tmp_path / "text.ifc").write_text("hello")
    with pytest.raises(DeckError, match=r"text\.ifc: "):
        deck_of_ifc(tmp_path / "text.ifc")
    with pytest.raises(DeckError, match="holds no IfcWall"):
        deck_of_ifc(Model().save(tmp_path))
