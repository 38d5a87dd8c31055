"""Wrong decks: every complaint with its line, all at once, and never a traceback."""

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from extrados.decks import explain, manual
from extrados.decks.positions import key_lines, line_of
from extrados.decks.reader import DeckError, make_deck, read_deck, read_text
from extrados.schema.quantities import parse

GOOD = """title = "t"
[structure]
kind = "arch"
radius = 10.0
thickness = "150 cm"
embrace = 157.5
voussoirs = 7
[motion]
kind = "step-pulse"
amplitude = "1.0 g"
duration = 0.20
[[analysis]]
kind = "tilt"
[[analysis]]
kind = "rocking"
"""


def complaints(text: str | bytes) -> list[str]:
    with pytest.raises(DeckError) as error:
        read_text(text if isinstance(text, bytes) else text.encode(), "deck.toml")
    return error.value.complaints


def test_good_deck() -> None:
    deck = read_text(GOOD.encode())
    assert deck.structure.thickness == pytest.approx(1.5, rel=1e-15)
    assert deck.motion.amplitude == pytest.approx(9.80665)
    assert [a.kind for a in deck.analyses] == ["tilt", "rocking"]


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("radius = 10.0", "radus = 10.0", 4, ["radus", "did you mean 'radius'"]),
        ("radius = 10.0", "radius = -10.0", 4, ["greater than or equal to 0.001 m"]),
        ('"150 cm"', '"0 cm"', 5, ["thickness", "greater than 0 m"]),
        ('"150 cm"', '"1,5 m"', 5, ["not a quantity", "decimal sign is a point"]),
        ('"150 cm"', '"1.5 s"', 5, ["'s' is not a unit of m"]),
        ('"150 cm"', '"1.5 parsnip"', 5, ["unknown unit 'parsnip'"]),
        ('"150 cm"', '"2*3 m"', 5, ["not a quantity"]),
        ('"150 cm"', '"9**9**9 m"', 5, ["not a quantity"]),
        ('"150 cm"', '"1 m**9**9**9"', 5, ["not a quantity"]),
        ('"150 cm"', '"nan m"', 5, ["not a quantity"]),
        ('"150 cm"', "nan", 5, ["finite"]),
        ('"150 cm"', "1e400", 5, ["finite"]),
        ('"150 cm"', "true", 5, ["expected a number in m"]),
        ('"150 cm"', "12.0", 5, ["not below the radius"]),
        ("voussoirs = 7", "voussoirs = 3", 7, ["greater than or equal to 4"]),
        ("voussoirs = 7", "voussoirs = 7.5", 7, ["voussoirs"]),
        ("embrace = 157.5", "embrace-x = 157.5", 6, ["unknown key", "did you mean 'embrace'"]),
        ("embrace = 157.5", "embrace = 157.5\nfloat = 1", 7, ["unknown key"]),
        ("voussoirs = 7", 'voussoirs = 7\n[joints]\nrestitution = "thess"', 9, ["'energy-safe' or 'inelastic', or", "number"]),
        ("voussoirs = 7", "voussoirs = 7\n[joints]\nrestitution = 1.2", 9, ["less than or equal to 1"]),
        ("voussoirs = 7", "voussoirs = 7\n[supports]\nrebound = 0.4", 9, ["rebound` requires `abutting_wall`"]),
        (
            "voussoirs = 7",
            "voussoirs = 7\n[[ties]]\nstart = [1.0, 2.0, 3.0]\nground = [0, 0]",
            9,
            ["expected the same number of coordinates for all points of a tie"],
        ),
        ("radius = 10.0", "radius = 1e308", 4, ["less than or equal to 10000 m"]),
        ("embrace = 157.5", "", 2, ["embrace is missing", "angle of embrace"]),
        ('amplitude = "1.0 g"', "amplitude = 1.0", 10, ["number without a unit", "g"]),
        ('kind = "step-pulse"', 'kind = "step-puls"', 9, ["did you mean 'step-pulse'"]),
        ('kind = "tilt"', 'kind = "tlit"', 13, ["did you mean 'tilt'"]),
        ('kind = "tilt"', "", 12, ["kind is missing"]),
        ("voussoirs = 7", "voussoirs = 7\nfriction = 0.5", 8, ["unknown key; it belongs in [joints]"]),
        ("[structure]", "[struture]", 2, ["struture", "did you mean 'structure'"]),
        ("duration = 0.20", "duration = 0,20", 11, ["decimal sign is a point"]),
        ("duration = 0.20", "duration = 0.20\nduration = 0.3", 12, ["duration"]),
    ],
)
def test_complaint(old: str, new: str, line: int, words: list[str]) -> None:
    found = complaints(GOOD.replace(old, new, 1))
    assert any(c.startswith(f"deck.toml:{line}:") and all(w in c for w in words) for c in found), found


#: A tie of `strengthen` and a span of a bridge whose keys contradict one another: rules of tables in lists
NESTED = {
    "`debonding_force` requires its source": (
        '[analysis]\nkind = "strengthen"\nacceleration = "0.3 g"\n[[analysis.ties]]\nstart = [0, 1]\nend = [1, 1]\n'
        'debonding_force = "10 kN" # here\n'
    ),
    "places` requires `start_to` or `far_to`": (
        '[analysis]\nkind = "strengthen"\nacceleration = "0.3 g"\n[[analysis.ties]]\nstart = [0, 1]\nend = [1, 1]\nplaces = 5 # here\n'
    ),
    "intrados belongs to shape": (
        '[structure]\nkind = "bridge"\n[[structure.spans]]\nshape = "segmental"\nspan = 2.0\nrise = 1.0\nthickness = 0.5\n'
        "intrados = [[0, 0], [0.5, 0.8], [1, 1], [2, 0]] # here\n"
    ),
}


@pytest.mark.parametrize("words", NESTED)
def test_a_rule_of_a_table_in_a_list_has_the_line_of_the_key_that_it_names(words: str) -> None:
    rows = NESTED[words].splitlines()
    line = 1 + next(k for k, row in enumerate(rows) if "# here" in row)
    found = complaints(NESTED[words])
    key = words.split()[0].strip("`")
    assert any(c.startswith(f"deck.toml:{line}:") and f".{key}: " in c for c in found), found


def test_columns_of_a_frame_do_not_overlap() -> None:
    frame = '[structure]\nkind = "frame"\nwidth = 0.5\nheight = 4\nspacing = 0.4\nlintel_height = 0.5\n[analysis]\nkind = "tilt"'
    (found,) = complaints(frame)
    assert found.startswith("deck.toml:5:") and "overlap" in found


def test_all_complaints_at_once() -> None:
    text = GOOD.replace("radius = 10.0", "radus = 1").replace('"1.0 g"', '"1 kg"').replace('"rocking"', '"rockin"')
    found = complaints(text)
    lines = {int(c.split(":")[1]) for c in found}
    assert {4, 10, 15} <= lines


def test_missing_motion_and_structure() -> None:
    assert any("requires a [motion]" in c for c in complaints(GOOD[: GOOD.index("[motion]")] + '[analysis]\nkind = "rocking"'))
    assert any("requires a [structure]" in c for c in complaints('[analysis]\nkind = "tilt"'))
    assert any("no [analysis]" in c for c in complaints('title = "x"'))


def test_hostile_files(tmp_path) -> None:
    assert "not UTF-8" in complaints(b"title = 'x'\n\xff\xfe\x00")[0]
    assert complaints(b"\x00\x01\x02")[0].startswith("deck.toml:1:")
    assert "nested too deeply" in complaints("x = " + "[" * 100000)[0]
    big = tmp_path / "big.toml"
    big.write_bytes(b"# " + b"x" * 5_000_000)
    for path, words in ((big, "5.0 MB"), (tmp_path, "is a folder"), (tmp_path / "no.toml", "no such file")):
        with pytest.raises(DeckError, match=words):
            read_deck(path)


def test_every_prefix_of_a_deck() -> None:
    """A deck cut off anywhere is a deck or a list of complaints."""
    text = GOOD + '[[analysis]]\nkind = "failure-domain"\ndurations = [\n0.1,\n0.2,\n]\n'
    for cut in range(len(text)):
        try:
            read_text(text[:cut].encode())
        except DeckError as error:
            assert error.complaints


def test_analysis_settings_are_checked() -> None:
    for bad, words in (
        ('kind = "failure-domain"\ndurations = [0.0, 0.2]', "greater than 0 s"),
        ('kind = "failure-domain"\ndurations = [-0.1]', "greater than 0 s"),
        ('kind = "failure-domain"\naccuracy = 1e-18', "greater than or equal"),
        ('kind = "assessment"\nmin_period = 5.0', "not below max_period"),
    ):
        found = complaints(GOOD.replace('kind = "tilt"', bad))
        assert any(words in c for c in found), found
    assert any("no [analysis]" in c for c in complaints(GOOD[: GOOD.index("[[analysis]]")].replace("title", "analysis = []\ntitle", 1)))


def test_empty_deck() -> None:
    assert "no [analysis]" in complaints("")[0]


@given(st.data())
@settings(max_examples=300, deadline=None)
def test_mutated_decks_never_break_the_reader(data) -> None:
    """Any edit of a deck gives a deck or complaints."""
    text = list(GOOD)
    for _ in range(data.draw(st.integers(1, 6))):
        at = data.draw(st.integers(0, len(text) - 1))
        text[at : at + data.draw(st.integers(0, 9))] = data.draw(st.text(max_size=6))
    try:
        read_text("".join(text).encode("utf-8", "surrogatepass"))
    except DeckError as error:
        assert error.complaints


@given(st.text(max_size=40))
@settings(max_examples=500, deadline=None)
def test_quantity_grammar(text: str) -> None:
    try:
        parse(text, "m")
    except ValueError:
        return
    assert any(c.isdigit() for c in text)


@pytest.mark.parametrize(
    ("text", "si", "value"),
    [
        ("20 cm", "m", 0.2),
        ("0.5 g", "m/s^2", 4.903325),
        ("55.6 kN", "N", 55600.0),
        ("3 N/mm^2", "Pa", 3e6),
        ("2.7 rad", "deg", 154.69860468),
        ("1.92e-5 N/mm^3", "N/m^3", 19200.0),
        ("300 cm/s**2", "m/s^2", 3.0),
        ("1800 kg/m3", "kg/m^3", 1800.0),
        ("1800 kg/m³", "kg/m^3", 1800.0),
        ("18 kN/m3", "kg/m^3", 18e3 / 9.80665),
        ("18 kN/m³", "kg/m^3", 18e3 / 9.80665),
        ("40 cm²", "m^2", 4e-3),
        ("5 mm2", "m^2", 5e-6),
    ],
)
def test_quantities(text: str, si: str, value: float) -> None:
    assert parse(text, si) == pytest.approx(value, rel=1e-10)


def test_lines_of_nested_keys() -> None:
    text = 'a = [\n 1,\n "x]", # ]\n]\nb.c = """\n[no]\n"""\n[[t]]\nk = 1\n[[t]]\nk = 2\n[t.u]\nv = 3\n'
    lines = key_lines(text)
    assert lines["a",] == 1 and lines["b", "c"] == 5
    assert lines["t", 0, "k"] == 9 and lines["t", 1, "k"] == 11 and lines["t", 1, "u", "v"] == 13


def test_lines_of_entries_of_inline_lists() -> None:
    """Entries on another line than their list have a line of their own; strings, comments and commas at the end change nothing."""
    text = 'a = { b = [\n  { k = "},\\"", p = [1, 2] }, # }]\n  { k = 2,\n    q = [\n 1,\n 2,\n    ] },\n], c = """\n{,"\n""" }\nd = [\'\'\'\n],\'\'\',\n3]\ne = 1\n'
    lines = key_lines(text)
    assert (lines["a", "b", 0], lines["a", "b", 1], lines["a", "b", 1, "q"]) == (2, 3, 4)
    assert (lines["a", "b", 1, "q", 0], lines["a", "b", 1, "q", 1], lines["a", "c"]) == (5, 6, 8)
    assert (lines["d",], lines["d", 1], lines["e",]) == (11, 13, 14)
    assert line_of(("a", "b", 0, "p", 1), lines) == 2 and line_of(("a", "b", 1, "k"), lines) == 3


def test_explain_schema_and_starters() -> None:
    import tomllib

    from extrados import kinds

    def told(word: str) -> str:
        return manual.explain(word, tables)

    tables = explain.facts()
    schema = explain.json_schema()
    assert "arch" in str(schema["$defs"]["structure-arch"]["properties"]["kind"])
    assert "R_A" in told("radius") and "thesis" in told("restitution")
    with pytest.raises(KeyError, match="radius"):
        told("raduis")
    assert 'or "no-sliding", default 0.7' in told("joints.friction")
    assert "joints.types.cohesion: " in told("joints.types")
    assert told("analysis.tilt").startswith('[analysis] kind = "tilt"')
    assert told("tilt.fracture").startswith("analysis.fracture (tilt): ")
    for kind in kinds.ANALYSES:
        assert tomllib.loads(explain.starter(kind))["analysis"][0]["kind"] == kind
    assert "`radius`" in manual.manual(tables)


def test_decks_from_python() -> None:
    deck = make_deck(
        {"structure": {"kind": "arch", "radius": 1.0, "thickness": 0.2, "embrace": 150.0, "voussoirs": 9}, "analysis": {"kind": "tilt"}}
    )
    assert deck.analyses[0].kind == "tilt"


@pytest.mark.parametrize(
    ("tables", "words"),
    [
        (
            {"joints": {"friction_rule": "non-associated"}, "analysis": {"kind": "tilt"}},
            "joints.friction_rule: unknown key; this key belongs in the [[analysis]] table",
        ),
        ({"analysis": {"kind": "moving-load", "dynamic": 1.4}}, "analysis.dynamic: unknown key; this key belongs in analysis.factors"),
    ],
)
def test_a_key_at_the_wrong_place_is_reported_with_its_right_place(tables: dict, words: str) -> None:
    arch = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 150.0, "voussoirs": 20}
    with pytest.raises(DeckError, match=re.escape(words)):
        make_deck({"structure": arch, **tables})


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("piers = { width = 1.0, height = 2.0 }", "expected a list of tables, [{ ... }], also for a single table"),
        ("piers = 2", "piers: 2: expected a list, [ ... ]"),
        ('piers = ["2 m"]', "expected a table such as { "),
        ("piers = [{ width = 1.0, height = 2.0 }]", "1 span needs no piers; found 1"),
        ('title = "x"', "unknown key"),
    ],
)
def test_what_was_expected_is_said_in_words_of_a_deck(text: str, words: str) -> None:
    deck = f'[structure]\nkind = "bridge"\nspans = [{{ span = 10.0, rise = 2.0, thickness = 0.6 }}]\n{text}\n[analysis]\nkind = "tilt"\n'
    with pytest.raises(DeckError) as error:
        read_text(deck.encode())
    assert words in str(error.value)


def test_a_load_in_a_list_of_tables_is_answered_with_the_keys_of_the_table() -> None:
    with pytest.raises(DeckError) as error:
        make_deck({"structure": {"kind": "arch"}, "analysis": {"kind": "moving-load", "axles": [], "uniform": ["20 kN/m"]}})
    assert "expected a table such as { load = ..., start = ..., stop = ... }" in str(error.value)
    assert "UniformLoad" not in str(error.value)


def test_a_number_where_a_name_is_wanted_and_a_word_of_another_kind() -> None:
    wall = 'kind = "brickwork"\nunits = 4\ncourses = 4\nunit_length = 0.5\nunit_height = 0.25\nthickness = 0.2\n'
    with pytest.raises(DeckError) as error:
        read_text(f'[structure]\n{wall}[[initial.movements]]\njoint = 0\n[analysis]\nkind = "tilt"\n'.encode())
    assert "thickness: unknown key; did you mean 'depth'?" in str(error.value)
    assert "initial.movements.joint: 0: expected text in quotes" in str(error.value)
