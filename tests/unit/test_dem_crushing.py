"""Corners that crush on springs: closed form of a block, limit analysis with crushing, energy, refusals."""

import tomllib

import numpy as np
import pytest
from dem_models import G, model, pieces, rectangle

import extrados
from extrados.core import dem

WEIGHT = 2000.0 * G * 4.0  # of a block 1 x 4 m


def block(strength: float, damping: float = 2e-4) -> dem.Bodies:
    law = dem.Law(1e10, 1e10, 0.9, damping=damping, strength=strength)
    bodies = model([rectangle(-0.5, 0.5, 0.0, 4.0)], [rectangle(-2.0, 2.0, -1.0, 0.0)], law)
    return dem.Bodies(**{**bodies.__dict__, "laws": [dem.Law(1e10, 1e10, 0.9, damping=damping), law], "joints": {(0, 1): 1}})


@pytest.mark.parametrize("share", [2.5, 10.0, 100.0])
def test_a_block_tips_about_the_middle_of_its_pressed_edge(share: float) -> None:
    """a / g = (b - W / f_c) / h, for a strength of so many times the even pressure."""
    least = (1.0 - 1.0 / share) / 4.0 * G
    for ratio in (0.99, 1.01):
        ramp = pieces([0.0, 0.5, 1.0, 1.5, 20.0], [0.25 * ratio * least * k for k in (1, 2, 3, 4)])
        run = dem.run(block(share * WEIGHT), dem.Options(12.0, 0.1, collapse=0.5), ramp)
        assert (run.reason == "collapse") == (ratio > 1.0)


@pytest.mark.parametrize(("share", "stands"), [(0.99, False), (1.02, True)])
def test_a_block_stands_up_to_its_strength(share: float, stands: bool) -> None:
    run = dem.run(block(share * WEIGHT), dem.Options(0.1, settlement=0.01))
    assert (run.reason == "end") == stands
    if not stands:
        assert run.reason == "unsettled" and run.blamed == [0]


def test_a_block_beyond_its_strength_falls_by_the_rest_of_its_weight() -> None:
    """A face that crushes at a constant force has no dashpot: the acceleration is g (1 - .99), with damping too."""
    times = np.linspace(0.1, 0.3, 3)
    run = dem.run(block(0.99 * WEIGHT), dem.Options(0.35, settle_steps=0), times=times)
    fall = np.diff(run.place[:, 0, 1]) / np.diff(run.time)
    assert (fall[0] - fall[1]) / np.diff(run.time).mean() == pytest.approx(0.01 * G, rel=1e-3)


def test_a_great_strength_changes_nothing_and_the_ledger_closes() -> None:
    """A rocking block, and one that rocks without dashpots between corners that crush: the energy balance includes the energy stored in them."""
    pulse = pieces([0.0, 0.3, 0.6], [0.4 * G, -0.4 * G])
    times = np.arange(0.0, 0.7, 0.01)
    dry = dem.run(block(0.0), dem.Options(0.7), pulse, times=times)
    stiff = dem.run(block(1e6 * WEIGHT), dem.Options(0.7), pulse, times=times)
    assert np.abs(dry.place - stiff.place).max() < 1e-3 * np.abs(dry.place[:, 0, 2]).max()
    weak = dem.run(block(8.0 * WEIGHT, damping=0.0), dem.Options(0.7), pulse, times=times)
    at = int(np.abs(weak.place[:, 0, 2]).argmax())
    held = WEIGHT / 16.0 * np.abs(weak.place[at, 0, 2])  # W e theta, with e = W / 2 f_c
    assert weak.residual < 1e-3 and weak.energy["elastic"][at] == pytest.approx(held, rel=0.3)
    assert abs(weak.place[30, 0, 2]) > 1.05 * abs(dry.place[30, 0, 2])  # at the end of the push


@pytest.mark.parametrize(
    ("of_dem", "more", "why"),
    [
        ("crushing = true", "", "requires `compressive_strength`"),
        ("crushing = true\ndirection = 0.0", "", "requires `compressive_strength`"),
        ("crushing = true", '[material]\ncompressive_strength = "4 MPa"\n[joints]\ncohesion = "0.1 MPa"\n', "for joints without mortar"),
    ],
)
def test_crushing_is_refused_by_name(of_dem: str, more: str, why: str) -> None:
    deck = (
        f'[structure]\nkind = "column"\nwidth = 1.0\nheight = 3.0\ndrums = 2\n{more}[[analysis]]\nkind = "dem"\ntest = "tilt"\n{of_dem}\n'
    )
    found = extrados.run(tomllib.loads(deck)).results[0]
    assert found.status == "refused" and why in found.reason


def test_limit_analysis_proves_that_a_joint_crushes_under_self_weight(tmp_path) -> None:
    deck = tmp_path / "deck.toml"
    deck.write_text(
        '[structure]\nkind = "block"\nwidth = 1\nheight = 4\n[material]\ndensity = 2000\ncompressive_strength = "70 kPa"\n'
        "[joints]\nfriction = 0.9\nnormal_stiffness = 1e9\nbeta = 1e-3\n"
        '[[analysis]]\nkind = "dem"\ncrushing = true\nend_time = 0.1\nperturbed = false\n'
    )
    (one,) = extrados.run(deck).analyses
    assert one["verdict"]["outcome"] == "cannot-stand", one
    assert "more work than crushing" in one["verdict"]["statement"] or "strength" in one["verdict"]["statement"]
