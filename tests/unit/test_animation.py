"""Films of decks: what moves is in them, at the size and speed that are asked for."""

import itertools
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import extrados
from extrados.schema.programs import ffmpeg
from extrados.show import film as animation

ARCH = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}
STACK = {"kind": "stack", "lower_width": 1.0, "lower_height": 2.0, "upper_width": 0.6, "upper_height": 2.4}
PULSE = {"kind": "step-pulse", "amplitude": "0.8 g", "duration": 0.2}
FAST = {"animation": "gif", "animation_speed": 10.0}


def pictures(path: Path) -> list[np.ndarray]:
    with Image.open(path) as image:
        assert image.size == (1280, 720)
        found = []
        for k in range(image.n_frames):
            image.seek(k)
            found.append(np.asarray(image.convert("L")).astype(int))
        return found


@pytest.mark.parametrize(
    ("name", "deck"),
    [
        ("tilt", {"structure": ARCH, "analysis": [{"kind": "tilt", **FAST}]}),
        (
            "rocking",
            {"structure": ARCH, "motion": PULSE, "analysis": [{"kind": "rocking", "end_time": 2.0, **FAST, "animation_speed": 3.0}]},
        ),
        (
            "rocking",
            {
                "structure": {"kind": "block", "width": 1.0, "height": 4.0},
                "motion": PULSE,
                "analysis": [{"kind": "rocking", "end_time": 2.0, **FAST, "animation_speed": 3.0}],
            },
        ),
        (
            "rocking",
            {"structure": STACK, "motion": PULSE, "analysis": [{"kind": "rocking", "end_time": 2.0, **FAST, "animation_speed": 3.0}]},
        ),
        ("supports", {"structure": ARCH, "analysis": [{"kind": "supports", **FAST}]}),
        ("dem", {"structure": ARCH, "motion": PULSE, "analysis": [{"kind": "dem", "end_time": 0.6, **FAST, "animation_speed": 1.0}]}),
        ("sla", None),
    ],
    ids=["tilt", "rocking of an arch", "rocking of a block", "rocking of a stack", "supports", "dem", "sla"],
)
def test_what_moves_is_filmed(tmp_path: Path, name: str, deck: dict | None) -> None:
    if deck is None:
        deck = extrados.live(Path(__file__).resolve().parents[2] / "cases" / "sla" / "tension.toml").deck.data
        table = deck["analysis"][0] if isinstance(deck["analysis"], list) else deck["analysis"]
        deck = {**deck, "analysis": [{**table, **FAST}]}
    run = extrados.run(deck, tmp_path / "out", figures=True)
    assert run.results[0].status == "ok", run.results[0].reason
    seen = pictures(tmp_path / "out" / "figures" / f"{name}.gif")
    assert len(seen) >= 5
    changed = [np.abs(a - b).max() for a, b in itertools.pairwise(seen)]
    assert max(changed) > 60, "something moves"
    assert np.abs(seen[0] - seen[-1]).max() > 60


def test_pictures_keep_time() -> None:
    times = np.linspace(0.0, 10.0, 2001)
    index, rate = animation.pictures(times, "mp4", 1.0)
    assert rate == 30
    assert len(index) / rate == pytest.approx(10.0, abs=0.1)
    index, rate = animation.pictures(times, "gif", 0.5)
    assert rate == 15
    assert len(index) / rate == pytest.approx(20.0, abs=0.2)
    index, rate = animation.pictures(np.linspace(0.0, 1000.0, 20001), "mp4", 1.0)
    assert len(index) <= animation.MOST + 1


def test_mp4_is_made_or_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    deck = {"structure": ARCH, "analysis": [{"kind": "tilt", "animation": "mp4", "animation_speed": 10.0}]}
    if ffmpeg() is not None:
        extrados.run(deck, tmp_path / "out", figures=True)
        content = (tmp_path / "out" / "figures" / "tilt.mp4").read_bytes()
        assert content[4:8] == b"ftyp"
    monkeypatch.setattr("extrados.analyses.needs.ffmpeg", lambda: None)
    (result,) = extrados.run(deck).results
    assert result.status == "refused"
    assert "ffmpeg" in result.reason


def test_without_a_wish_there_is_no_film(tmp_path: Path) -> None:
    extrados.run({"structure": ARCH, "analysis": [{"kind": "tilt"}]}, tmp_path / "out", figures=True)
    assert not list((tmp_path / "out" / "figures").glob("*.gif"))
