"""Fragility by discrete elements: against the rocking mechanism, limit analysis, similarity; censored runs; refusals."""

from dataclasses import replace

import numpy as np
import pytest

import extrados
from extrados.analyses.context import Context
from extrados.analyses.dem import fragility
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.fragility import Ensemble, follow
from extrados.analyses.dem.measures import Collapse
from extrados.analyses.dem.sampled import Sample
from extrados.analyses.dem.standing import BRIEF
from extrados.analyses.motion_source import source_of
from extrados.analyses.statistics.uncertain import sobol_draws
from extrados.decks.reader import DeckError, read_text
from extrados.limit.programme import LimitAnalysis
from extrados.show.statistics import draw_fragility

BLOCK = '[structure]\nkind = "block"\nwidth = 0.6\nheight = 2.4\n[joints]\nfriction = 2.0\n'
ARCH = '[structure]\nkind = "arch"\nradius = 10.0\nthickness = 1.1\nembrace = 180\nvoussoirs = 11\n'
SINE = '[motion]\nkind = "sine-pulse"\namplitude = "0.5 g"\nperiod = {period}\n'
MANY = '[motion]\nkind = "generated"\nmmi = 8\nduration = 4.0\n'
KIND = '[[analysis]]\nkind = "dem-fragility"\nsolver = "nonsmooth"\n'


def found(tmp_path, text: str):
    (tmp_path / "deck.toml").write_text(text)
    return extrados.run(tmp_path / "deck.toml")


def test_outcomes_of_a_block_are_those_of_the_mechanism(tmp_path) -> None:
    """Motion by motion and level by level, but for runs near the limit."""
    more = 'count = 5\nseed = 2\nlevels = ["0.2 g", "1.0 g"]\nbootstrap = 0\n'
    run = found(tmp_path, BLOCK + MANY + f'[[analysis]]\nkind = "fragility"\n{more}' + KIND + more + "settle = 15\n")
    one, other = (run.array(name, "outcome") == 2 for name in ("fragility", "dem-fragility"))
    assert one.any() and not one.all()
    assert (one == other).mean() >= 0.9
    low, high = np.array(run["fragility"]["confidence_interval"]).T
    share = np.array(run["dem-fragility"]["collapse_probability"])
    assert ((share >= low) & (share <= high)).all()


def test_larger_blocks_are_slower_by_the_root_of_their_size(tmp_path) -> None:
    """Rigid contacts: four times the size under a pulse of twice the period."""
    ratios = []
    for size, period in ((1.0, 0.5), (4.0, 1.0)):
        run = found(
            tmp_path, BLOCK + SINE.format(period=period) + KIND + f'intensity = "size"\nlevels = [{size}]\nsettle = {12 * size**0.5}\n'
        )
        ratios.append(float(run.array("dem-fragility", "displacement_ratio")[0]))
    assert 0.05 < ratios[0] < 1.0, ratios
    assert ratios[1] == pytest.approx(ratios[0], rel=0.02)


def test_buildings_that_cannot_stand_collapse_under_every_motion(tmp_path) -> None:
    """Sampled arches about the least thickness: those that settle are those that limit analysis finds in equilibrium."""
    text = ARCH + '[joints]\nfriction = 2.0\n[motion]\nkind = "sine-pulse"\namplitude = "0.01 g"\nperiod = 0.2\n' + KIND
    text += "levels = [0.01]\nintensity = 'scale'\nuncertain.thickness = 0.1\ncount = 8\nsettle = 0.0\n"
    deck = read_text(text.encode())
    options, building = deck.analyses[0], Context(deck).building
    sample = Sample(building, options, sobol_draws(1, 8, 0))
    falls, cannot = [], []
    for k in range(8):
        one = sample.building_of(k)
        cannot.append(not LimitAnalysis(one.blocks(), one.friction()).stands())
        try:
            model = sample.model(k)
            dem_model.checked(follow(model, options, None, 1.0, BRIEF, Collapse.of(None, model.size), 1), model)
            falls.append(False)
        except (dem_model.Falls, dem_model.Restless):
            falls.append(True)
    assert falls == cannot
    assert 0 < sum(falls) < 8
    run = found(tmp_path, text)
    assert run["dem-fragility"]["unstable"] == sum(falls)
    outcome = run.array("dem-fragility", "outcome")
    assert (outcome[np.array(falls)] == 2).all()
    assert not (outcome[~np.array(falls)] == 2).any()


def test_sizes_are_no_levels_of_a_motion(tmp_path) -> None:
    """Larger blocks survive motions that overturn smaller ones: this is no anomaly, and the largest size is not the worst."""
    run = found(tmp_path, BLOCK + SINE.format(period=0.8) + KIND + 'intensity = "size"\nlevels = [0.1, 4]\nsettle = 15\n')
    (one,) = run.analyses
    assert run["dem-fragility"]["collapse_probability"] == [1.0, 0.0] and run["dem-fragility"]["motions_that_collapse"] == 1
    assert run["dem-fragility"].resurrections is None and "incremental_risen" not in run.arrays["dem-fragility"]
    assert "100 % at 0.1 times the size, 0 % at 4 times the size" in one["verdict"]["statement"]
    said = dict(draw_fragility(run, "dem-fragility", tmp_path))
    assert not any("higher level" in text for text in said.values())


def test_bars_of_an_arch_that_cannot_stand_collapse() -> None:
    """Such a sample has no hinges to be joined at; the others have results."""
    text = ARCH + '[joints]\nfriction = 2.0\n[motion]\nkind = "sine-pulse"\namplitude = "0.01 g"\nperiod = 0.2\n' + KIND
    text += "levels = [0.01]\nintensity = 'scale'\nmerge = 'three-bars'\nuncertain.thickness = 0.1\ncount = 4\nsettle = 0.0\n"
    deck = read_text(text.encode())
    context = Context(deck)
    job = Ensemble(Sample(context.building, deck.analyses[0], sobol_draws(1, 4, 0)), source_of(context, 0)[0])
    rows = job.run(0, 4, 1)
    cannot = []
    for k in range(4):
        one = job.sample.building_of(k)
        cannot.append(not LimitAnalysis(one.blocks(), one.friction()).stands())
    assert 0 < sum(cannot) < 4
    assert (rows["unstable"] == cannot).all() and (rows["outcome"][cannot] == 2).all()


def test_a_building_that_cannot_stand_has_no_probability(tmp_path) -> None:
    (one,) = found(tmp_path, ARCH.replace("1.1", "0.6") + MANY + KIND + "levels = [0.1]\ncount = 1\n").analyses
    assert one["verdict"]["outcome"] == "cannot-stand"


def test_runs_that_end_in_motion_are_censored(tmp_path) -> None:
    run = found(tmp_path, BLOCK + SINE.format(period=0.8) + KIND + "intensity = 'scale'\nlevels = [1.0]\nsettle = 0.05\n")
    r = run["dem-fragility"]
    assert r["censored"] == [1] and r["count"] == [0] and r["collapse_probability"] == [None]
    assert r["collapse_probability_bounds"] == [[0.0, 1.0]]
    assert run.array("dem-fragility", "outcome").tolist() == [-1]
    assert any("still move" in w for a in run.analyses for w in a["warnings"])
    assert r["convergence"]["steps"] > 0 and r["convergence"]["open_steps"] == 0


def test_doubts_of_contacts_are_reported(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps that did not converge, errors of the energy balance, and mortar on rigid contacts."""

    def doubtful(*given):
        run = follow(*given)
        return replace(run, residual=0.05, effort=replace(run.effort, open_steps=2, residual=0.3, worst=0.7))

    monkeypatch.setattr(fragility, "follow", doubtful)
    text = BLOCK.replace("friction = 2.0", "friction = 2.0\ntension = 1e4\ncohesion = 1e4") + SINE.format(period=0.1)
    run = found(tmp_path, text + KIND + "intensity = 'scale'\nlevels = [0.1, 0.2]\ndirection = 0.0\nsettle = 0.0\n")
    (one,) = run.analyses
    told = "\n".join(one["warnings"])
    assert "did not converge in 4 of" in told and "at 0.7 s, is 0.3" in told
    assert "energy balance is up to 5 %" in told
    assert "brittle mortar may fail earlier" in told
    assert run["dem-fragility"]["convergence"]["open_steps"] == 4


def test_solids_end_as_their_section(tmp_path) -> None:
    same = "intensity = 'scale'\nlevels = [0.72, 2.4]\nsettle = 12\n"
    text = BLOCK + SINE.format(period=0.8) + KIND + same + KIND + same + "direction = 0.0\n"
    run = found(tmp_path, text)
    one, other = (run.array(name, "displacement_ratio") for name in ("dem-fragility", "dem-fragility-2"))
    assert run.array("dem-fragility", "outcome").tolist() == run.array("dem-fragility-2", "outcome").tolist() == [1, 2]
    assert other[0] == pytest.approx(one[0], rel=0.05)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("uncertain = { stiffness = 0.2 }", "no springs"),
        ("uncertain = { radius = 0.2 }", "no uncertain value"),
        ("uncertain = { imperfection = 0.02 }\ndirection = 0.0", "would not be plane"),
        ("intensity = 'sa'", "requires sa_period"),
        ("intensity = 'size'\nhazard = { intensities = [1, 2], annual_rates = [0.1, 0.01] }", "hazard"),
    ],
)
def test_refusals_name_the_key_and_the_cure(more: str, words: str, tmp_path) -> None:
    try:
        reason = found(tmp_path, BLOCK + MANY + KIND + f"levels = [0.3]\ncount = 1\n{more}\n").analyses[0]["reason"]
    except DeckError as error:
        reason = str(error)
    assert words in reason


def test_joined_blocks_have_no_values_of_their_own(tmp_path) -> None:
    text = ARCH + "[joints]\nfriction = 2.0\n" + MANY + KIND + 'merge = "three-bars"\nlevels = [0.3]\ncount = 1\n'
    for name in ("density", "imperfection"):
        assert "joins the blocks" in found(tmp_path, f"{text}uncertain = {{ {name} = 0.02 }}\n").analyses[0]["reason"]


def test_all_lengths_of_a_structure_have_its_size() -> None:
    """Corners that are worn, also of blocks drawn anew, and the floor."""
    text = BLOCK + "worn_corners = 0.05\n" + MANY + KIND + 'intensity = "size"\nlevels = [1, 4]\nfloor = -0.5\n'
    deck = read_text(f"{text}uncertain = {{ density = 0.05 }}\n".encode())
    sample = Sample(Context(deck).building, deck.analyses[0], np.full((1, 1), 0.3))
    one, other = (sample.model(0, size).rigid for size in (1.0, 4.0))
    assert len(one.parts) == len(other.parts) and len(one.parts[0]) > 4
    for small, large in zip(one.parts, other.parts, strict=True):
        assert large == pytest.approx(4.0 * small, rel=1e-9, abs=1e-9)


def test_two_equal_levels_are_refused() -> None:
    with pytest.raises(DeckError, match="twice"):
        read_text((BLOCK + MANY + KIND + "levels = [0.3, 0.3]\n").encode())
