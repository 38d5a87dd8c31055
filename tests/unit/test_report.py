"""The report: one source, as HTML and on paper; what it says stands in the stored results."""

import itertools
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import extrados
from extrados.decks.reader import DeckError, make_deck, read_deck
from extrados.model.dimensions import dimensions
from extrados.results import validity
from extrados.results.store import StoreError
from extrados.results.verdict import SHARES
from extrados.show import html, typeset
from extrados.show.building import heading
from extrados.show.document import Code, Document, Heading, Table, Words
from extrados.show.elevation import seen_from_right
from extrados.show.language import Language
from extrados.show.report import write_report
from extrados.show.sources import clause_of
from extrados.show.telling import _flowing
from extrados.show.template import read_template

CASES = Path(__file__).parents[2] / "cases"
ARCH = {"kind": "arch", "radius": 2.0, "thickness": 0.4, "embrace": 180.0, "voussoirs": 12}


def test_dimensions_are_span_and_rise_not_the_outer_box() -> None:
    deck = make_deck({"structure": ARCH, "analysis": {"kind": "tilt"}})
    found = {d.name: d.length for d in dimensions(deck.building.blocks())}
    assert found == pytest.approx({"clear span": 3.6, "rise": 1.8, "thickness at the crown": 0.4})
    vault = make_deck({"structure": {"kind": "vault", "preset": "dejong-a"}, "analysis": {"kind": "tilt"}})
    found = {d.name: d.length for d in dimensions(vault.building.blocks())}
    assert found["width of the left buttress"] == pytest.approx(17.0 / 3.0)
    assert found["clear span"] == pytest.approx(2.0 * 9.25 * np.sin(np.radians(60.0)))
    column = make_deck({"structure": {"kind": "column", "width": 1.2, "top_width": 0.8, "height": 6.0}, "analysis": {"kind": "tilt"}})
    assert {d.name: d.length for d in dimensions(column.building.blocks())} == pytest.approx({"width": 1.2, "height": 6.0})


def surveyed(span: float, rise: float, thick: float, voussoirs: int, courses: int, drop: float, noise: float, on_skewbacks: bool) -> dict:
    """A segmental arch on two piers of courses, each stone measured for itself."""
    half = 0.5 * span
    radius = (half**2 + rise**2) / (2.0 * rise)
    turn = np.linspace(-1.0, 1.0, voussoirs + 1) * np.arctan2(half, radius - rise)
    toward = np.column_stack([np.sin(turn), np.cos(turn)])
    low, high = (r * toward + (0.0, rise - radius) for r in (radius, radius + thick))
    stones = [np.array([low[k], low[k + 1], high[k + 1], high[k]]) for k in range(voussoirs)]
    for side, k in ((-1.0, 0), (1.0, -1)):
        back = side * (half + 1.6)
        if on_skewbacks:
            stones.append(np.array([low[k], high[k], [back, high[k][1]], [back, low[k][1]]]))
        level = np.linspace(low[k][1], low[k][1] - drop, courses + 1)
        reach = back if on_skewbacks else high[k][0]
        stones += [np.array([[low[k][0], a], [reach, a], [reach, b], [low[k][0], b]]) for a, b in itertools.pairwise(level)]
    rng = np.random.default_rng(3)
    points = [stone + rng.uniform(-noise, noise, stone.shape) for stone in stones]
    return {"kind": "blocks", "block": [{"points": p.tolist()} for p in points], "contact_tolerance": max(1e-4, 4.0 * noise)}


@pytest.mark.parametrize(
    ("span", "rise", "voussoirs", "noise", "on_skewbacks"),
    [
        (8.0, 2.90, 24, 0.0, True),
        (8.0, 2.90, 24, 0.001, True),
        (8.0, 4.0, 40, 0.0, False),
        (8.0, 4.0, 40, 0.001, False),
        (8.0, 1.0, 30, 0.001, True),
    ],
)
def test_the_rise_of_a_survey_begins_at_the_springings(span: float, rise: float, voussoirs: int, noise: float, on_skewbacks: bool) -> None:
    """Below the arch stand piers of 5 m: the rise was once measured from the foundation."""
    table = surveyed(span, rise, 0.6, voussoirs, 8, 5.0, noise, on_skewbacks)
    found = {d.name: d.length for d in dimensions(make_deck({"structure": table, "analysis": {"kind": "tilt"}}).building.blocks())}
    assert (found["clear span"], found["rise"], found["thickness at the crown"]) == pytest.approx((span, rise, 0.6), abs=4.0 * noise + 1e-9)


@pytest.mark.parametrize("shape", ["segmental", "elliptical", "three-centred", "parabolic"])
def test_each_span_of_a_viaduct_has_its_own_rise(shape: str) -> None:
    span = {"shape": shape, "span": 8.0, "rise": 2.5, "thickness": 0.6, "springing_thickness": 0.8}
    table = {"kind": "bridge", "spans": [span, span], "piers": [{"width": 2.4, "height": 6.0, "courses": 4}]}
    found = {d.name: d.length for d in dimensions(make_deck({"structure": table, "analysis": {"kind": "tilt"}}).building.blocks())}
    assert [found[f"{what} of span {k}"] for k in (1, 2) for what in ("clear span", "rise")] == pytest.approx([8.0, 2.5] * 2)
    assert not any("pier" in name for name in found)


def test_the_drawing_is_to_scale_and_needs_no_result(tmp_path: Path) -> None:
    """A sheet of 170 mm, the width of the printed text; no analysis has stored the geometry."""
    arch = {"kind": "arch", "radius": 5.0, "thickness": 0.2, "embrace": 180.0, "voussoirs": 24, "depth": 2.0}
    run = extrados.run({"structure": arch, "joints": {"normal_stiffness": 1e9}, "analysis": {"kind": "dem-parameters"}})
    assert not any("outline" in there for there in run.arrays.values())
    run.write(tmp_path / "out")
    drawing = (tmp_path / "out" / "figures" / "building.svg").read_text()
    width = float(re.search(r'width="([\d.]+)pt"', drawing)[1])
    assert width / 72.0 * 25.4 == pytest.approx(170.0, abs=0.1)
    page = (tmp_path / "out" / "report.html").read_text()
    scale = int(re.search(r"at scale 1:(\d+)", page)[1])
    # the dimension line of the clear span, 9.8 m, is the longest level line in the colour of dimensions
    lines = re.findall(r'<path d="M ([\d.]+) ([\d.]+) \s*L ([\d.]+) ([\d.]+) \s*"[^>]*stroke: #1f4e79', drawing)
    longest = max(float(c) - float(a) for a, b, c, d in lines if b == d)
    assert longest / 72.0 * 25.4 == pytest.approx(9.8e3 / scale, rel=1e-3)


def test_the_side_shows_what_reaches_farthest() -> None:
    """A step in front of a tower hides its foot; the faces of an arch, seen from its side, are as high together as the arch."""
    tower, step = (np.array([[a, 0.0], [b, 0.0], [b, h], [a, h]]) for a, b, h in ((0.0, 1.0, 3.0), (1.0, 2.0, 1.0)))
    assert seen_from_right([tower, step]) == [(0.0, 1.0, 1), (1.0, 3.0, 0)]
    arch = make_deck({"structure": ARCH, "analysis": {"kind": "tilt"}}).building.blocks()
    levels = np.concatenate(arch.outlines)[:, 1]
    assert sum(high - low for low, high, _ in seen_from_right(arch.outlines)) == pytest.approx(np.ptp(levels), abs=1e-5)
    assert seen_from_right([]) == []


def test_the_front_of_a_bridge_is_to_scale(tmp_path: Path) -> None:
    """8.2 m between the ends of the ring: the dimension below the elevation has this length on paper."""
    span = {"shape": "segmental", "span": 8.0, "rise": 2.0, "thickness": 0.5}
    table = {"kind": "bridge", "spans": [span], "fill": {"cover": 0.4, "density": 1800.0}}
    deck = make_deck({"structure": table, "analysis": {"kind": "tilt"}})
    points = np.concatenate(deck.building.blocks().outlines)
    extrados.run(deck).write(tmp_path / "out")
    page = (tmp_path / "out" / "report.html").read_text()
    scale = int(re.search(r"levation at scale 1:(\d+)", page)[1])
    drawing = max((tmp_path / "out" / "figures").glob("building*.svg")).read_text()
    lines = re.findall(r'<path d="M ([\d.]+) ([\d.]+) \s*L ([\d.]+) ([\d.]+) \s*"[^>]*stroke: #1f4e79', drawing)
    longest = max(float(c) - float(a) for a, b, c, d in lines if b == d)
    assert longest / 72.0 * 25.4 == pytest.approx(1e3 * np.ptp(points[:, 0]) / scale, rel=1e-3)
    assert "The deck has no spandrel walls" in page


def test_a_refused_wall_has_its_elevation(tmp_path: Path) -> None:
    """No stones and no result: the wall with its opening is drawn, cut through the opening."""
    wall = {"kind": "panel", "width": 3.0, "height": 3.0, "thickness": 0.3, "openings": [{"x": [1.0, 2.0], "y": [1.0, 2.1]}]}
    run = extrados.run({"structure": wall, "material": {"density": 1800.0}, "analysis": {"kind": "thrust"}})
    assert run.analyses[0]["status"] == "refused"
    run.write(tmp_path / "out")
    assert "The wall: elevation and cross-section at scale 1:" in (tmp_path / "out" / "report.html").read_text()
    assert (tmp_path / "out" / "figures" / "building.svg").exists()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("report") / "out"
    deck = {
        "title": 'An <arch> \\ "of" #stone',
        "project": "St Martin",
        "author": "A. Mason",
        "date": "2026-05-04",
        "structure": ARCH,
        "material": {"density": "2100 kg/m^3"},
        "analysis": {"kind": "tilt"},
    }
    extrados.run(deck).write(out)
    return out


def test_the_page_says_who_what_and_how_to_repeat(folder: Path) -> None:
    page = (folder / "report.html").read_text()
    for words in (
        "St Martin",
        "A. Mason",
        "2026-05-04",
        "Contents",
        "clear span",
        "3.60 m",
        ">density<",
        "2100 kg/m³",
        "Limits of validity",
        "To repeat it",
        "Figure 2. The building",
        "Next step.",
        validity.Tilt.limits[:40],
    ):
        assert words in page, words
    assert "An &lt;arch&gt;" in page and "<details" not in page, "what is folded vanishes in print"
    assert "analysis" in page and "http://" not in page.replace("http://www.w3.org", "")
    sums = re.findall(r"<th>results.h5</th><td[^>]*>([0-9a-f]{64})</td>", page)
    assert sums == [extrados.load(folder).summary["files"]["results.h5"]]


def _paper(folder: Path, name: str = "report.pdf") -> tuple[Any, str]:
    pypdf = pytest.importorskip("pypdf")
    reader = pypdf.PdfReader(folder / name)
    return reader, "\n".join(page.extract_text() for page in reader.pages)


def test_paper_is_accessible_and_its_source_sets_it_anew(folder: Path) -> None:
    typst = pytest.importorskip("typst")
    write_report(folder, printed=True)
    reader, text = _paper(folder)
    root = reader.trailer["/Root"]
    assert root["/MarkInfo"]["/Marked"] and root["/Lang"] == "en" and "/StructTreeRoot" in root
    assert "<pdfuaid:part>1</pdfuaid:part>" in root["/Metadata"].get_data().decode()
    assert [one["/Title"] for one in reader.outline if isinstance(one, dict)] and reader.metadata["/Title"].startswith("An <arch>")
    seen, waiting, alternatives = set(), [root["/StructTreeRoot"]], 0
    while waiting:  # every figure of the tree of tags has its alternative text
        one = waiting.pop().get_object()
        if not isinstance(one, dict) or id(one) in seen:
            continue
        seen.add(id(one))
        if one.get("/S") == "/Figure":
            assert one.get("/Alt")
            alternatives += 1
        kids = one.get("/K", [])
        waiting += [kid for kid in (kids if isinstance(kids, list) else [kids]) if not isinstance(kid, int)]
    assert alternatives >= 2
    for page in reader.pages:
        for font in (one.get_object() for one in page["/Resources"].get("/Font", {}).values()):
            held = font["/DescendantFonts"][0].get_object()["/FontDescriptor"].get_object()
            assert {"/FontFile2", "/FontFile3"} & set(held), "embedded"
    again = typst.compile(str(folder / "report.typ"), root=str(folder), format="pdf", ignore_system_fonts=True)
    assert again.startswith(b"%PDF") and "St Martin" in text


OFFICE = """language = "it"
office = "Studio Bianchi"
client = "Diocesi di Verona"
reviewer = "B. Rossi"
revision = "2"
signatures = ["Progettista", "Collaudatore"]
colour = "#7a1f1f"
sections = ["limits", "answer"]
[fields]
Protocollo = "117/2026"
"""


def test_the_template_of_an_office_orders_and_chooses(folder: Path, tmp_path: Path) -> None:
    template = tmp_path / "report.toml"
    template.write_text(OFFICE)
    write_report(folder, printed=True, template=template)
    reader, text = _paper(folder)
    for words in ("Studio Bianchi", "Diocesi di Verona", "B. Rossi", "117/2026", "Progettista", "St Martin", "A. Mason"):
        assert "".join(words.split()) in "".join(text.split()), words  # older readers part words
    assert [one["/Title"] for one in reader.outline] == ["1 Limiti di validità", "2 Esito"], "the order and choice of the office"
    assert "#7a1f1f" in (folder / "report.html").read_text()
    write_report(folder, printed=True)


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ('logo = "../logo.png"', "logo.png"),
        ('logo = "/etc/passwd"', "inside the template's folder"),
        ('logo = "logo.svg"', "ends in"),
        ('logo = "text.png"', "is not a PNG"),
        ('logo = "large.png"', "at most 1 MB"),
        ('colour = "red); #panic()"', "colour"),
        ('sections = ["answer", "answer"]', "each section once"),
        ('sections = ["cover"]', "sections"),
        ("surprise = 1", "surprise"),
        ('language = "xx"', "language"),
        ("office = ", "TOML"),
        (f'office = "{"x" * 300}"', "office"),
    ],
)
def test_a_wrong_template_is_refused_in_words(tmp_path: Path, line: str, complaint: str) -> None:
    (tmp_path / "in").mkdir()
    (tmp_path / "logo.png").write_bytes(b"\x89PNG\r\n\x1a\n")
    (tmp_path / "in" / "text.png").write_text("no picture")
    (tmp_path / "in" / "large.png").write_bytes(b"\x89PNG\r\n\x1a\n" + bytes(1_100_000))
    (tmp_path / "in" / "report.toml").write_text(line)
    with pytest.raises(StoreError, match=complaint):
        read_template(tmp_path / "in" / "report.toml")


def test_quantities_are_those_of_engineers() -> None:
    english, italian = Language(), Language("it")
    values = [(2.8155e6, "N"), (8e6, "Pa"), (0.55, "m"), (2.9, "m"), (-1.7e-9, "g"), (0.21634, "g"), (2348.0, "kg/m^3"), (0.0, "N")]
    assert [english.quantity(*one) for one in values] == [
        "2820 kN",
        "8.00 MPa",
        "550 mm",
        "2.90 m",
        "−1.70 × 10⁻⁹ g",
        "0.216 g",
        "2350 kg/m³",
        "0 kN",
    ]
    assert italian.quantity(8.25e6, "Pa") == "8,25 MPa" and italian.quantity(2345.0, "kg/m^3", given=True) == "2345 kg/m³"
    assert english.quantity(9.9996, "m") == "10.0 m" and english.given(0.6) == "0.6" and italian.given(1.35) == "1,35"


def test_at_a_hinge_the_printed_stress_is_the_strength(tmp_path: Path) -> None:
    """With stone that crushes, the force at a hinge stands off the edge by N/(2 f depth): its mean stress is the strength f."""
    deck = {"structure": ARCH, "material": {"compressive_strength": "2 MPa"}, "analysis": {"kind": "tilt"}}
    extrados.run(deck).write(tmp_path / "out")
    page = (tmp_path / "out" / "report.html").read_text()
    table = page[page.index("mean stress") :]
    stresses = [float(x) for x in re.findall(r"<td>([\d.]+) MPa</td></tr>", table[: table.index("</table>")])]
    assert max(stresses) == pytest.approx(2.0, rel=0.02) and len([x for x in stresses if x > 1.9]) >= 4, "four hinges"


def test_paper_holds_what_the_page_holds(folder: Path) -> None:
    pytest.importorskip("typst")
    write_report(folder, printed=True)
    content = (folder / "report.pdf").read_bytes()
    assert content.startswith(b"%PDF-") and re.search(rb"/MediaBox ?\[0 0 595\.2\d* 841\.8\d*\]", content), "A4"
    assert not list(folder.glob("report-2*"))


def test_numbers_are_not_broken_on_paper_and_long_keys_are() -> None:
    """A line may end after the marks of a key or a path; not within 0.213 g or 1/2."""
    soft = typeset._words("0.213 g by structure.thickness_factor of cases/assess/x.toml, c_v 1.000, d_SLV, [C8.7.1.10] 1/2")
    assert soft == (
        'text("0.213\u00a0g by structure.\u200bthickness_\u200bfactor of cases/\u200bassess/\u200bx.toml, c_v 1.000, d_SLV, [C8.7.1.10] 1/2")'
    )


def test_a_short_paragraph_in_a_box_and_a_unit_are_kept_whole(tmp_path: Path) -> None:
    """A long paragraph may continue on the next page."""
    short, long = (
        typeset.markup(Document("t", [], [Words(text, "answer")], "t"), tmp_path) for text in ("density 2300 kg/m^3", "a" * 2000)
    )
    assert "kg/\u2060m" in short and ", false, (" in short and ", true, (" in long


def test_a_note_flows_as_one_paragraph() -> None:
    assert _flowing("one\ntwo  three\n\nfour") == "one two three\nfour"


def test_nothing_in_a_text_is_obeyed(tmp_path: Path) -> None:
    typst = pytest.importorskip("typst")
    words = 'a "quote" \\ #panic("no") $x$ *b* _c_ <d> @e // f'
    blocks = [Heading(words), Words(words, "answer"), Table(("h",), [(words,)]), Code(words)]
    document = Document(words, [("k", words)], blocks, words)
    assert typst.compile(typeset.markup(document, tmp_path).encode(), root=str(tmp_path), format="pdf").startswith(b"%PDF")
    assert "<d>" not in html.page(document, tmp_path)


def test_without_the_typesetter_the_page_is_written_and_pdf_is_refused(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "typst", None)
    assert write_report(folder)[0].exists()
    with pytest.raises(StoreError, match="pip install typst"):
        write_report(folder, printed=True)


def test_project_author_and_date_are_words() -> None:
    with pytest.raises(DeckError, match="author: expected text"):
        make_deck({"author": 3, "structure": ARCH, "analysis": {"kind": "tilt"}})


def test_a_surveyed_intrados_carries_what_the_curve_carries_that_it_was_measured_on() -> None:
    """Seventeen points of a segmental arch, by two ways of description: rise, mass and collapse load agree."""
    half, rise = 5.0, 2.9
    radius = (half**2 + rise**2) / (2.0 * rise)
    turn = np.linspace(-1.0, 1.0, 17) * np.arctan2(half, radius - rise)
    points = [[half + radius * np.sin(t), max(0.0, radius * np.cos(t) + rise - radius)] for t in turn]
    common = {"thickness": 0.6, "voussoirs": 30}
    over = {"fill": {"cover": 0.4, "passive": 0.5}, "backing": {"height": 1.0}, "surfacing": {"thickness": 0.1}, "depth": 4.0}
    analysis = {"kind": "moving-load", "train": "LM1", "count": 9}
    runs = [
        extrados.run(
            {"structure": {"kind": "bridge", "spans": [{**one, **common}], **over}, "joints": {"friction": 0.6}, "analysis": analysis}
        )
        for one in ({"span": 2.0 * half, "rise": rise}, {"shape": "surveyed", "intrados": points})
    ]
    drawn, measured = (run["moving-load"] for run in runs)
    assert measured.adequacy_factor == pytest.approx(drawn.adequacy_factor, rel=3e-3)
    sizes = {d["name"]: d["length_m"] for d in runs[1].summary["deck"]["dimensions"]}
    assert (sizes["clear span"], sizes["rise"]) == pytest.approx((2.0 * half, rise), abs=1e-3)


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        ({"intrados": [[0, 0], [2, 1], [1, 1], [4, 0]]}, "x must increase"),
        ({"intrados": [[0, 0], [1, 1], [3, 1], [4, 0.5]]}, "one level"),
        ({"span": 4.0}, "remove this key"),
        ({"shape": "segmental", "span": 4.0, "rise": 1.0}, "is only for shape"),
        ({"intrados": [[0, 0], [1, 1]]}, "intrados"),
        ({"intrados": [[0, 0], [1], [3, 1], [4, 0]]}, "points"),
    ],
)
def test_a_wrong_intrados_is_refused_in_words(change: dict, complaint: str) -> None:
    span = {"shape": "surveyed", "intrados": [[0.0, 0.0], [1.0, 1.0], [3.0, 1.0], [4.0, 0.0]], "thickness": 0.4, **change}
    with pytest.raises(DeckError, match=complaint):
        make_deck({"structure": {"kind": "bridge", "spans": [span]}, "analysis": {"kind": "tilt"}})


@pytest.mark.parametrize(("name", "most"), [("limit/church", 15), pytest.param("limit/panel", 8, marks=pytest.mark.verify)])
def test_a_report_has_few_pages(tmp_path: Path, name: str, most: int) -> None:
    """A surveyed nave, and a garden wall; the annex holds the rest."""
    pytest.importorskip("typst")
    deck = read_deck(CASES / f"{name}.toml")
    quick = [one for one in deck.data["analysis"] if one["kind"] in ("tilt", "thrust", "moving-load")]
    extrados.run(make_deck({**deck.data, "analysis": quick}, deck.folder)).write(tmp_path / "out")
    write_report(tmp_path / "out", printed=True)
    assert len(_paper(tmp_path / "out")[0].pages) <= most
    assert len(_paper(tmp_path / "out", "annex.pdf")[0].pages) >= 1


def test_backing_over_the_haunches_does_not_shorten_the_span_of_a_surveyed_arch() -> None:
    """The drawn arch of 9.6 m and 2.9 m, whose crown has settled by 25 mm: backing touches its lowest voussoirs."""
    made = read_deck(CASES / "bridge/surveyed.toml").structure.assembly(2000.0, CASES / "bridge")
    found = {d.name: d.length for d in dimensions(made)}
    assert found == pytest.approx({"clear span": 9.6, "rise": 2.875, "thickness at the crown": 0.6, "total height": 4.046}, abs=3e-3)


def test_section_and_elevation_of_a_bridge_show_the_same_height() -> None:
    """Masonry up to the crown, and to the surface of the road over it, which the elevation shows."""
    table = {"kind": "bridge", "spans": [{"span": 6.0, "rise": 2.0, "thickness": 0.5}], "abutments": {"width": 1.5, "height": 1.5}}
    deck = make_deck({"structure": {**table, "fill": {"cover": 0.4}, "surfacing": {"thickness": 0.1}}, "analysis": {"kind": "tilt"}})
    made = deck.building.blocks()
    found = {d.name: d.length for d in dimensions(made)}
    assert found["total height"] == pytest.approx(made.earth.road - min(outline[:, 1].min() for outline in made.outlines))
    assert found["total height"] - found["height of the masonry"] == pytest.approx(0.5)


def test_a_bibliography_names_clauses_without_their_formulas() -> None:
    assert clause_of("NTC 2018, Circ. 7/2019 C8.7.1.2.1.8: d_SLV = 0.4 d_0; [C8.7.1.12]") == "NTC 2018, Circ. 7/2019 C8.7.1.2.1.8"
    assert clause_of("EN 1998-1 4.3.5: F_a; Table 4.4 (verify clause)") == "EN 1998-1 4.3.5 (verify clause)"
    assert clause_of("ASCE 41-13 11.3.3.3 Table 11-5 (verify clause)") == "ASCE 41-13 11.3.3.3 Table 11-5 (verify clause)"


def test_verdicts_of_shares_have_units_in_words() -> None:
    deck = {"structure": ARCH, "analysis": [{"kind": "thrust"}, {"kind": "moving-load", "train": "LM1", "width": 1.0}]}
    units = [one.verdict.unit for one in extrados.run(deck).results]
    assert units == ["of the joint", "times the train"] and set(units) <= set(SHARES)


def test_an_arch_is_not_carried_on_into_the_pier_and_the_next_arch() -> None:
    made = read_deck(CASES / "limit/church.toml").structure.assembly(2000.0, CASES / "limit")
    found = {d.name: d.length for d in dimensions(made)}
    assert found["clear span of chain 3"] == pytest.approx(7.2, abs=0.02)


def test_a_report_of_a_nameless_deck_is_called_after_its_folder() -> None:
    assert heading({"path": "bridges/leno/deck.toml"}) == "leno"
    assert heading({"path": "bridges/leno.toml"}) == "leno" and heading({"path": ""}) == "extrados run"
    assert heading({"path": "bridges/leno/deck.toml", "title": "The Leno bridge"}) == "The Leno bridge"
