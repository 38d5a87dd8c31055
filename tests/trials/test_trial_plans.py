"""Plans and models of buildings by the grammar of their formats, with hostile words: a deck, or a refusal in words."""

import random
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from foreign import HOSTILE, Groups, Words

import trials
from extrados.bridges.plan_drawing import deck_of_file
from extrados.decks.reader import DeckError, read_text

SEED = 20261128
SECONDS = 300  # of the clock: a trial that hangs


def plan(rng: random.Random) -> bytes:
    """A DXF of a plan: rectangles of rooms with both faces of their walls, or axes, with gaps; a layer of openings; hostile words."""
    w = Words(rng, rng.choice((10, 40, 200, 10**9)))
    entities: Groups = []

    def line(layer: str, *ends: float) -> None:
        values = [w.number() if w.odd() else f"{v:.6g}" for v in ends]
        pairs = list(zip((10, 20, 11, 21), values, strict=True))
        if rng.random() < 0.2:
            pairs = [(90, "2"), (70, w.whole(0, 1)), (10, values[0]), (20, values[1]), (10, values[2]), (20, values[3])]
            entities.extend([(0, "LWPOLYLINE"), (8, layer), *pairs])
        else:
            entities.extend([(0, "LINE"), (8, layer), *pairs])

    for _ in range(rng.randint(1, 4)):
        x, y, a, b, t = (rng.choice((0.0, 4.0, rng.uniform(-20.0, 20.0))) for _ in range(5))
        t = rng.choice((0.3, 0.08, 1.5, abs(t) / 10.0))
        skew = rng.choice((0.0, 0.0, 1e-3, 5e-3, 0.3))
        for inside in (0.0, t) if rng.random() < 0.8 else (0.0,):
            low, high = (x + inside, y + inside), (x + abs(a) + 5.0 - inside, y + abs(b) + 5.0 - inside)
            gap = rng.uniform(low[0], high[0])
            line("W", *low, gap, low[1])
            line("W", min(gap + rng.choice((0.9, 0.0, 4.0)), high[0]), low[1], high[0], low[1] + skew)
            line("W", high[0], low[1], *high)
            line("W", *high, low[0], high[1] + skew)
            line("W", low[0], high[1], *low)
        line("O", x + 1.0, y, x + 2.0, y + rng.choice((0.0, t)))
    while w.odd() and entities:
        k = rng.randrange(len(entities))
        entities[k] = (rng.choice((entities[k][0], 0, 8, 10, 62, 1071, -1)), rng.choice((*HOSTILE, entities[k][1])))
    header = [(9, "$INSUNITS"), (70, w.whole(6, 6))]
    groups = [g for title, body in (("HEADER", header), ("ENTITIES", entities)) for g in ((0, "SECTION"), (2, title), *body, (0, "ENDSEC"))]
    return "".join(f"{code:>3}\n{value}\n" for code, value in [*groups, (0, "EOF")]).encode("utf-8", "surrogateescape")


def model(rng: random.Random) -> bytes:
    """An IFC of a few walls with openings whose rows have other numbers, references (circles, too), names or are gone."""
    from test_plan_ifc import Model

    made = Model(rng.choice((".MILLI.", "$", ".CENTI.")))
    for _ in range(rng.randint(1, 5)):
        way = rng.choice(((1, 0), (0, 1), (-1, 0), (0.6, 0.8)))
        holes = [(500, 1500, 0, 2100)] if rng.random() < 0.5 else []
        start = (rng.choice((0, 5000, rng.uniform(-1e4, 1e4))), rng.choice((0, 4000)))
        made.wall(start, way, rng.choice((3000, 8000)), rng.choice((300, 450)), rng.choice((0.0, 3000.0)), 3000.0, holes)
    rows, w = made.rows, Words(rng, rng.choice((2, 6, 20)))
    while w.odd():
        k = rng.randrange(len(rows))
        match rng.randrange(8):
            case 0:
                numbers = list(re.finditer(r"(?<![#\w.])-?\d+\.\d*(?:E-?\d+)?", rows[k]))
                if numbers:
                    spot = rng.choice(numbers)
                    word = rng.choice((*HOSTILE, "0.", "-1.", "1.E300", "1.E-300", "1.E9", "*", "$"))
                    rows[k] = rows[k][: spot.start()] + word + rows[k][spot.end() :]
            case 1:
                places = list(re.finditer(r"#\d+", rows[k]))
                if places:
                    spot = rng.choice(places)
                    word = rng.choice((f"#{k + 1}", f"#{rng.randint(1, len(rows))}", "#999999", "#0", "$", "*", "()"))
                    rows[k] = rows[k][: spot.start()] + word + rows[k][spot.end() :]
            case 2:
                rows[k] = rows[rng.randrange(len(rows))]
            case 3:
                rows[k] = ""
            case 4:
                rows[k] = rng.choice(("IFCWALL", "IFCOPENINGELEMENT", "IFCSIUNIT", "IFCNOTHING", "X")) + rows[k][rows[k].find("(") :]
            case 5:
                rows[k] = rows[k].replace("(", "(" * rng.choice((2, 2000)), 1)
            case 6:
                rows[k] = rows[k].replace("'", rng.choice(("", "'\\X2\\D800\\X0\\", "'" + "A" * 70_000, "'\0", "'\"]\n[x]\n")), 1)
            case _:
                rows[k] = rows[k][: rng.randrange(1 + len(rows[k]))]
    head = "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\nFILE_SCHEMA(('IFC4'));\nENDSEC;\nDATA;\n"
    head = rng.choice((head, head, head, head.replace("IFC4", rng.choice(("IFC2X3", "IFC9", "", "IFC4X3")))))
    text = head + "".join(f"#{k}={row};\n" for k, row in enumerate(rows, 1)) + "ENDSEC;\nEND-ISO-10303-21;\n"
    return text[: rng.randrange(len(text))].encode() if rng.random() < 0.03 else text.encode()


def _tried(
    trial: trials.Trial, least: int, path: Path, content_of: Callable[[random.Random], bytes], deck_of: Callable[[random.Random], str]
) -> None:
    """Each file becomes a deck that can be read, or DeckError gives the reason."""
    decks = refused = odd = 0
    for k in range(least):
        rng = random.Random(f"{path.suffix} {SEED} {k}")
        path.write_bytes(content_of(rng))
        trial.tried += 1
        try:
            with trials.patience(SECONDS):
                text = deck_of(rng)
                decks += 1
                try:
                    read_text(text.encode())
                except DeckError as error:  # a wall of length 0, say: refused in words, yet one step later than it could be
                    odd += 1
                    if any("TOML" in line or "line " in line.split(":")[0] for line in error.complaints):
                        trial.fail(f"{k}: no deck: {error}")
        except DeckError as error:
            refused += 1
            if "its reader ended" in str(error) or "Error: " in str(error):
                trial.fail(f"{k}: {error!s:.300}")
        except (Exception, trials.TooLong) as error:
            trial.fail(f"{k}: {type(error).__name__}: {error!s:.300}")
    trial.notes.append(f"{decks} decks, of which {odd} are refused in words when they are read; {refused} files refused")
    assert decks and refused
    trial.close(least)


@pytest.mark.verify
def test_plans_by_the_grammar_of_drawings(tmp_path: Path) -> None:
    trial = trials.Trial("plans-dxf", "DXF plans that give neither a deck nor a refusal in words")
    path = tmp_path / "a.dxf"

    def deck_of(rng: random.Random) -> str:
        return deck_of_file(path, ["W"], rng.choice(([], ["O"])), rng.choice((None, None, 0.4)), rng.choice(([3.0], [3.0, 2.8])), "m")

    _tried(trial, trials.count_of(2_000, 60), path, plan, deck_of)


@pytest.mark.verify
def test_models_by_the_grammar_of_ifc(tmp_path: Path) -> None:
    pytest.importorskip("ifcopenshell", reason="ifcopenshell is not installed: pip install extrados[ifc]")
    from extrados.bridges.plan_ifc import deck_of_ifc

    trial = trials.Trial("plans-ifc", "IFC models that give neither a deck nor a refusal in words")
    path = tmp_path / "a.ifc"
    _tried(trial, trials.count_of(500, 30), path, model, lambda rng: deck_of_ifc(path))
