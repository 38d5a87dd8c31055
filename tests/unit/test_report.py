"""The report: one source, as HTML and on paper; what it says stands in the stored results."""

import itertools
import re
from pathlib import Path

import numpy as np
import pytest

import extrados
from extrados.decks.reader import DeckError, make_deck
from extrados.model.dimensions import dimensions
from extrados.results import validity
from extrados.results.store import StoreError
from extrados.show import html, typeset
from extrados.show.document import Code, Document, Heading, Table, Words
from extrados.show.report import write_report
from extrados.show.telling import _flowing

ARCH = {"kind": "arch", "radius": 2.0, "thickness": 0.4, "embrace": 180.0, "voussoirs": 12}


def test_dimensions_are_span_and_rise_not_the_outer_box() -> None:
    deck = make_deck({"structure": ARCH, "analysis": {"kind": "tilt"}})
    found = {d.name: d.length for d in dimensions(deck.building.blocks())}
    assert found == pytest.approx({"clear span": 3.6, "rise": 1.8, "thickness at the crown": 0.4})
    vault = make_deck({"structure": {"kind": "vault", "preset": "dejong-a"}, "analysis": {"kind": "tilt"}})
    found = {d.name: d.length for d in dimensions(vault.building.blocks())}
    assert found["width of the left buttress"] == pytest.approx(17.0 / 3.0)
    assert found["clear span"] == pytest.approx(2.0 * 9.25 * np.sin(np.radians(60.0)))
    column = make_deck({"structure": {"kind": "column", "width": 1.2, "top_width": 0.8, "height": 6.0}, "analysis": {"kind": "tilt"}})  # fmt: skip
    assert {d.name: d.length for d in dimensions(column.building.blocks())} == pytest.approx(
        {"width": 1.2, "height": 6.0}
    )


def surveyed(
    span: float, rise: float, thick: float, voussoirs: int, courses: int, drop: float, noise: float, on_skewbacks: bool
) -> dict:
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
        stones += [
            np.array([[low[k][0], a], [reach, a], [reach, b], [low[k][0], b]]) for a, b in itertools.pairwise(level)
        ]
    rng = np.random.default_rng(3)
    points = [stone + rng.uniform(-noise, noise, stone.shape) for stone in stones]
    return {
        "kind": "blocks",
        "block": [{"points": p.tolist()} for p in points],
        "contact_tolerance": max(1e-4, 4.0 * noise),
    }


@pytest.mark.parametrize(
    ("span", "rise", "voussoirs", "noise", "on_skewbacks"),
    [(8.0, 2.90, 24, 0.0, True), (8.0, 2.90, 24, 0.001, True), (8.0, 4.0, 40, 0.0, False), (8.0, 4.0, 40, 0.001, False), (8.0, 1.0, 30, 0.001, True)],
)  # fmt: skip
def test_the_rise_of_a_survey_begins_at_the_springings(
    span: float, rise: float, voussoirs: int, noise: float, on_skewbacks: bool
) -> None:
    """Below the arch stand piers of 5 m: the rise was once measured from the foundation."""
    table = surveyed(span, rise, 0.6, voussoirs, 8, 5.0, noise, on_skewbacks)
    found = {d.name: d.length for d in dimensions(make_deck({"structure": table, "analysis": {"kind": "tilt"}}).building.blocks())}  # fmt: skip
    assert (found["clear span"], found["rise"], found["thickness at the crown"]) == pytest.approx(
        (span, rise, 0.6), abs=4.0 * noise + 1e-9
    )


@pytest.mark.parametrize("shape", ["segmental", "elliptical", "three-centred", "parabolic"])
def test_each_span_of_a_viaduct_has_its_own_rise(shape: str) -> None:
    span = {"shape": shape, "span": 8.0, "rise": 2.5, "thickness": 0.6, "springing_thickness": 0.8}
    table = {"kind": "bridge", "spans": [span, span], "piers": [{"width": 2.4, "height": 6.0, "courses": 4}]}
    found = {d.name: d.length for d in dimensions(make_deck({"structure": table, "analysis": {"kind": "tilt"}}).building.blocks())}  # fmt: skip
    assert [found[f"{what} of span {k}"] for k in (1, 2) for what in ("clear span", "rise")] == pytest.approx(
        [8.0, 2.5] * 2
    )
    assert not any("pier" in name for name in found)


def test_the_drawing_is_to_scale_and_needs_no_result(tmp_path: Path) -> None:
    """A sheet of 170 mm, the width of the printed text; no analysis has stored the geometry."""
    arch = {"kind": "arch", "radius": 5.0, "thickness": 0.2, "embrace": 180.0, "voussoirs": 24, "depth": 2.0}
    run = extrados.run({"structure": arch, "joints": {"normal_stiffness": 1e9}, "analysis": {"kind": "dem-parameters"}})
    assert not any(run.arrays.values())
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


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("report") / "out"
    deck = {"title": "An <arch> \\ \"of\" #stone", "project": "St Martin", "author": "A. Mason", "date": "2026-05-04", "structure": ARCH,
            "material": {"density": "2100 kg/m^3"}, "analysis": {"kind": "tilt"}}  # fmt: skip
    extrados.run(deck).write(out)
    return out


def test_the_page_says_who_what_and_how_to_repeat(folder: Path) -> None:
    page = (folder / "report.html").read_text()
    for words in ("St Martin", "A. Mason", "2026-05-04", "Contents", "clear span", "3.6", "material.density", "2100", "kg/m^3",
                  "Limits of validity", "To repeat it", "Figure 2. The building", "Next step.", validity.Tilt.limits[:40]):  # fmt: skip
        assert words in page, words
    assert "An &lt;arch&gt;" in page and "<details" not in page, "what is folded vanishes in print"
    assert "analysis" in page and "http://" not in page.replace("http://www.w3.org", "")
    sums = re.findall(r"<th>results.h5</th><td>([0-9a-f]{64})</td>", page)
    assert sums == [extrados.load(folder).summary["files"]["results.h5"]]


def test_paper_holds_what_the_page_holds(folder: Path) -> None:
    pytest.importorskip("typst")
    write_report(folder, printed=True)
    content = (folder / "report.pdf").read_bytes()
    assert content.startswith(b"%PDF-") and re.search(rb"/MediaBox ?\[0 0 595\.2\d* 841\.8\d*\]", content), "A4"
    assert not list(folder.glob("report-2*"))


def test_numbers_are_not_broken_on_paper_and_long_keys_are() -> None:
    """A line may end after the marks of a key or a path; not within 0.213 g or 1/2."""
    soft = typeset._words(
        "0.213 g by structure.thickness_factor of cases/assess/x.toml, c_v 1.000, d_SLV, [C8.7.1.10] 1/2"
    )
    assert soft == (
        'text("0.213 g by structure.\u200bthickness_\u200bfactor of cases/\u200bassess/\u200bx.toml, c_v 1.000, d_SLV, '
        '[C8.7.1.10] 1/2")'
    )


def test_a_note_flows_as_one_paragraph() -> None:
    assert _flowing("one\ntwo  three\n\nfour") == "one two three\nfour"


def test_nothing_in_a_text_is_obeyed(tmp_path: Path) -> None:
    typst = pytest.importorskip("typst")
    words = 'a "quote" \\ #panic("no") $x$ *b* _c_ <d> @e // f'
    blocks = [Heading(words), Words(words, "answer"), Table(("h",), [(words,)]), Code(words)]
    document = Document(words, [("k", words)], blocks, words)
    assert typst.compile(typeset.markup(document, tmp_path).encode(), root=str(tmp_path), format="pdf").startswith(
        b"%PDF"
    )
    assert "<d>" not in html.page(document, tmp_path)


def test_without_the_typesetter_the_page_is_written_and_pdf_is_refused(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "typst", None)
    assert write_report(folder)[0].exists()
    with pytest.raises(StoreError, match="pip install typst"):
        write_report(folder, printed=True)


def test_project_author_and_date_are_words() -> None:
    with pytest.raises(DeckError, match="author: expected text"):
        make_deck({"author": 3, "structure": ARCH, "analysis": {"kind": "tilt"}})
