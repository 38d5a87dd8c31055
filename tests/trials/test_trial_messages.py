"""Messages of a page with hostile values: a session answers each, or refuses it in words; it writes nothing outside of its folder."""

import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import trials
from extrados import kinds
from extrados.decks.explain import starter
from extrados.explore.session import ANSWERS, Session

SEED = 20261128
HOSTILE: tuple[Any, ...] = (
    float("nan"),
    float("inf"),
    -1,
    0,
    1e308,
    -1e308,
    1e-300,
    1e15,
    True,
    None,
    "",
    "x" * 3000,
    "../../etc/passwd",
    "\0",
    "\ud800",
    [],
    {},
    [[]],
    [1e308, 1e308],
    ["a", 1],
    {"a": 1},
    2**70,
    "1e400 m",
    "nan",
)
#: Requests that take long by their nature: whole runs, files of the page, interventions of blocks in space
LONG = {"compute", "standalone", "needed", "fall", "push", "domain"}


def _wall(rng: random.Random) -> dict[str, Any]:
    opening = {"storey": rng.choice([1, 9]), "x": [1.0, rng.choice([2.0, 1.0, 0.5])], "z": [0.0, 2.1]}
    end = [rng.choice([5.0, 0.0, 1e-9]), rng.choice([0.0, 5.0])]
    return {
        "name": rng.choice(["wall 1", "a"]),
        "start": [0.0, 0.0],
        "end": end,
        "thickness": rng.choice([0.3, 1e-3, 50.0]),
        "openings": [opening],
    }


def _templates(rng: random.Random) -> dict[str, Callable[[], dict[str, Any]]]:
    """Messages as the page sends them."""
    decks = [starter(kind) for kind in ("tilt", "rocking", "frame-pushover", *kinds.STRUCTURES)]
    keys = ("structure.thickness", "motion.amplitude", "analysis.tilt.load", "structure.walls", "joints.friction")
    return {
        "open": lambda: {"text": rng.choice(decks), "name": "deck.toml"},
        "hello": lambda: {"kept": rng.choice([None, {"text": rng.choice(decks), "name": "a"}])},
        "drag": lambda: {
            "handle": rng.choice(["thickness", "radius", "height"]),
            "to": [rng.uniform(-5, 5), rng.uniform(-5, 9)],
            "ends": True,
        },
        "set": lambda: {"changes": {rng.choice(keys): rng.choice([1.0, "0.3 g", None, [{"x": 0.0, "force": 1e4}]])}},
        "show": lambda: {"gamma": rng.uniform(-1, 1), "through": rng.choice([None, [0.0, 1.0]]), "thrust": None, "lines": ["least"]},
        "draw": lambda: {"blocks": [[[0, 0], [1, 0], [1, 1], [0, 1]]], "supports": [], "fresh": True},
        "draw-plan": lambda: {"walls": [_wall(rng) for _ in range(rng.randint(0, 3))], "fresh": True, "floors": True, "storeys": [3.0]},
        "push-plan": lambda: {"direction": rng.choice([0.0, 33.0, 720.0])},
        "analysis": lambda: {"add": rng.choice(["tilt", "rocking", "x"])},
        "run": lambda: {"path": "a"},
        "figures": lambda: {"path": "a", "analysis": 0},
        "save": lambda: {"path": rng.choice(["a.toml", "../a.toml"]), "replace": True},
        "drop": lambda: {"name": rng.choice(["a.dxf", "a.json", "a.AT2", "a.ifc"]), "content": rng.choice(["AAAA", "%%%", ""])},
    }


def _spoilt(value: Any, rng: random.Random) -> Any:
    """The same with one value replaced by a hostile one."""
    if isinstance(value, dict | list) and value and rng.random() < 0.8:
        at = rng.choice(list(value) if isinstance(value, dict) else range(len(value)))
        changed = value.copy()
        changed[at] = _spoilt(value[at], rng)
        return changed
    return rng.choice(HOSTILE)


def test_hostile_messages_of_a_page(tmp_path: Path) -> None:
    trial = trials.Trial("page-messages", "messages of a page that end a session, or in a fault of the program")
    rng = random.Random(SEED)
    folder = tmp_path / "of the page"
    folder.mkdir()
    session, templates = Session(folder), _templates(rng)
    requests = sorted(ANSWERS.keys() - LONG)
    for _ in range(least := trials.count_of(20_000, 200)):
        do = rng.choice(requests)
        message = {"do": do, **templates.get(do, dict)()}
        if rng.random() < 0.6:
            spoilt = _spoilt(message, rng)
            message = spoilt if isinstance(spoilt, dict) else message
        trial.tried += 1
        try:
            with trials.patience(60):
                for reply in session.answer(message):
                    reply.pack()
                    for text in reply.words.get("complaints", []):
                        if "fault of extrados" in text:
                            trial.fail(f"{text:.300}: {message!r:.600}")
        except (Exception, trials.TooLong) as error:
            trial.fail(f"{type(error).__name__}: {error!s:.300}: {message!r:.600}")
    session.close()
    if [path.name for path in tmp_path.iterdir()] != [folder.name]:
        trial.fail("a page wrote outside of its folder")
    trial.close(least)
