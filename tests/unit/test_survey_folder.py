"""Folders of buildings, and two runs beside each other."""

import csv
from pathlib import Path

import numpy as np
import pytest
from test_every_strategy import quick_save
from typer.testing import CliRunner

import extrados
from extrados import cli
from extrados.analyses.context import Context
from extrados.core.errors import Cancelled
from extrados.decks.reader import DeckError, make_deck
from extrados.results.compare import changes, compare, flat
from extrados.running import survey
from extrados.running.run import Run, compute
from extrados.show import comparing, html, style
from extrados.show.telling import heading, kind_of

COMMON = """motion = { kind = "sine-pulse", amplitude = "0.3 g", period = 0.6 }
analysis = [{ kind = "assess", budget = 5, strategies = ["tilt", "rocking"] }]
"""
COLUMN = 'structure = {{ kind = "column", width = {}, height = 6.0, drums = 3 }}\n'


@pytest.fixture(autouse=True)
def _coarse_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(style, "save", quick_save)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    place = tmp_path / "towers"
    place.mkdir()
    (place / "common.toml").write_text(COMMON)
    for width in (2.0, 0.8, 1.2):
        (place / f"w{width}.toml").write_text(COLUMN.format(width))
    return place


def test_the_worst_comes_first(folder: Path, tmp_path: Path) -> None:
    rows = survey.assess_folder(folder, tmp_path / "out", figures=False)
    assert [r.building for r in rows] == ["w0.8", "w1.2", "w2.0"]
    assert [r.least_margin for r in rows] == pytest.approx([0.8 / 6 / 0.3, 1.2 / 6 / 0.3, 2.0 / 6 / 0.3])
    told = list(csv.DictReader((tmp_path / "out" / "ranking.csv").open()))
    assert [t["building"] for t in told] == ["w0.8", "w1.2", "w2.0"] and told[2]["overall"] == "stands under all"
    deck = extrados.load(rows[0].folder).summary["deck"]
    assert (deck["path"], heading(deck), kind_of(deck)) == ("w0.8.toml", "w0.8", "column")
    page = (tmp_path / "out" / "ranking.html").read_text()
    assert page.index("w0.8") < page.index("w1.2") and "limit analysis" in page
    assert extrados.load(rows[0].folder)["assess"].overall == rows[0].overall
    assert not (tmp_path / "out.checkpoint").exists()


def test_the_assessment_of_a_deck_is_its_own_or_the_common_one(folder: Path) -> None:
    (folder / "w0.8.toml").write_text(COLUMN.format(0.8) + 'analysis = [{ kind = "tilt" }]\n')
    assert 'strategies = ["tilt", "rocking"]' in survey.decks_of(folder)["w0.8"], "the common one, not a default"
    (folder / "w0.8.toml").write_text(COLUMN.format(0.8) + 'analysis = [{ kind = "asses" }, { kind = "assess" }]\n')
    assert "unknown kind 'asses'; did you mean 'assess'" in str(survey.decks_of(folder)["w0.8"])


def test_the_order_of_the_ranking() -> None:
    """Collapse that is proven, no answer, no verdict, the least margins, what stands by a margin that is not known."""
    nan = float("nan")
    worst_first = [
        ("cannot stand", 0.0, "ok"),
        ("", nan, "failed"),
        ("open", nan, "ok"),
        ("open", 0.4, "ok"),
        ("depends", 0.9, "ok"),
        ("stands under all", 1.4, "ok"),
        ("stands under all", nan, "ok"),
    ]
    rows = [survey.Assessed("", overall, margin, "", status, "", Path()) for overall, margin, status in worst_first]
    orders = [row.order for row in rows]
    assert orders == sorted(orders) and orders[0] < orders[1] and orders[5] < orders[6]


def test_what_cannot_stand_comes_first(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A proof of collapse under self-weight is the worst verdict, and the command is done: exit code 0."""
    leaning = '[structure]\nkind = "blocks"\n[[structure.block]]\nname = "leaning"\npoints = [[0, 0], [1, 0], [4, 4], [3, 4]]\n'
    (folder / "z-leaning.toml").write_text(leaning)
    rows = survey.assess_folder(folder, tmp_path / "out", figures=False)
    assert [r.building for r in rows] == ["z-leaning", "w0.8", "w1.2", "w2.0"]
    assert (rows[0].overall, rows[0].least_margin, rows[0].status) == ("cannot stand", 0.0, "ok")
    deck = tmp_path / "deck.toml"
    deck.write_text(leaning + '[[analysis]]\nkind = "tilt"\n')
    monkeypatch.undo()  # a report holds its pictures as SVG
    done = CliRunner().invoke(cli.app, ["run", str(deck), "--out", str(tmp_path / "one")])
    assert done.exit_code == 0 and "cannot stand" in done.output
    assert (tmp_path / "one" / "figures" / "tilt-self-weight.png").exists()


def test_it_goes_on_where_it_was_stopped(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    done: list[str] = []
    one = survey.SurveyJob._one

    def stopped(job: survey.SurveyJob, k: int, threads: int) -> dict[str, np.ndarray]:
        if len(done) == 1:
            raise Cancelled(0, "interrupted")
        done.append(job.names[k])
        return one(job, k, threads)

    monkeypatch.setattr(survey.SurveyJob, "_one", stopped)
    assert len(survey.assess_folder(folder, tmp_path / "out", figures=False)) == 1
    again: list[str] = []
    monkeypatch.setattr(survey.SurveyJob, "_one", lambda job, k, threads: (again.append(job.names[k]), one(job, k, threads))[1])
    rows = survey.assess_folder(folder, tmp_path / "out", resume=True, figures=False)
    assert len(rows) == 3 and not set(done) & set(again), "the building that was done is not computed anew"


def test_results_that_must_lie_beside_a_folder_are_those_of_the_ranking(folder: Path, tmp_path: Path) -> None:
    """A folder that holds files of others is left alone, and the page of that building is not an earlier one's."""
    out = tmp_path / "out"
    survey.assess_folder(folder, out, figures=False)
    (out / "w0.8" / "notes.txt").write_text("ours")
    (folder / "w0.8.toml").write_text(COLUMN.format(0.9))
    rows = survey.assess_folder(folder, out, figures=False)
    (moved,) = [r for r in rows if r.building == "w0.8"]
    assert moved.folder == out / "w0.8-2" and (out / "w0.8" / "notes.txt").read_text() == "ours"
    assert extrados.load(moved.folder)["assess"].least_margin == pytest.approx(0.9 / 6 / 0.3)
    assert "0.5" in (out / "ranking.csv").read_text() and moved.least_margin == pytest.approx(0.5)


@pytest.mark.verify
def test_a_cluster_gives_the_same_ranking(cluster, folder: Path, tmp_path: Path) -> None:
    address, _ = cluster
    apart = survey.assess_folder(folder, tmp_path / "a", scheduler=address, figures=False)
    here = survey.assess_folder(folder, tmp_path / "b", figures=False)
    assert [(r.building, r.overall, r.least_margin) for r in apart] == [(r.building, r.overall, r.least_margin) for r in here]
    assert (tmp_path / "a" / "ranking.csv").read_bytes() == (tmp_path / "b" / "ranking.csv").read_bytes()
    for row in apart:
        assert extrados.load(row.folder)["assess"].statement == row.statement, "written by a worker"


def test_all_that_is_wrong_is_reported_with_its_file(folder: Path) -> None:
    (folder / "bad.toml").write_text(COLUMN.format(-1.0))
    (folder / "worse.toml").write_text("structure = 3\n")
    found = survey.decks_of(folder)
    wrong = [one for one in found.values() if isinstance(one, DeckError)]
    assert len(found) == 5 and len(wrong) == 2
    assert "bad.toml" in wrong[0].complaints[0] and "worse.toml" in wrong[1].complaints[0]
    for path in folder.glob("w0*.toml"):
        path.unlink()
    for path in folder.glob("w[12]*.toml"):
        path.unlink()
    with pytest.raises(DeckError) as all_wrong:
        survey.decks_of(folder)
    assert len(all_wrong.value.complaints) == 2


def test_a_wrong_deck_does_not_stop_the_others(folder: Path, tmp_path: Path) -> None:
    (folder / "bad.toml").write_text(COLUMN.format(-1.0))
    rows = survey.assess_folder(folder, tmp_path / "out", figures=False)
    assert [r.building for r in rows] == ["bad", "w0.8", "w1.2", "w2.0"]
    assert rows[0].status == "wrong deck" and "bad.toml" in rows[0].statement and "width" in rows[0].statement
    assert "width" in (tmp_path / "out" / "ranking.html").read_text()
    done = CliRunner().invoke(cli.app, ["assess", str(folder), "--out", str(tmp_path / "two"), "--no-figures"])
    assert done.exit_code == 3 and "wrong deck" in done.output and "w2.0" in done.output


def test_a_fault_in_one_building_does_not_stop_the_others(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def failing(context: Context) -> Run:
        if context.deck.path == "w1.2.toml":
            raise ZeroDivisionError("planted")
        return compute(context)

    monkeypatch.setattr(survey, "compute", failing)
    rows = survey.assess_folder(folder, tmp_path / "out", figures=False)
    assert [(r.building, r.status) for r in rows] == [("w1.2", "failed"), ("w0.8", "ok"), ("w2.0", "ok")]
    assert "ZeroDivisionError" in rows[0].statement


def test_what_changed_between_two_runs() -> None:
    def ran(width: float) -> Run:
        deck = {
            "structure": {"kind": "block", "width": width, "height": 5.0},
            "motion": {"kind": "constant", "amplitude": "0.22 g"},
            "analysis": {"kind": "tilt"},
        }
        return compute(Context(make_deck(deck)))

    same = compare(ran(1.0), ran(1.0))
    assert same.same and "Only the computing time differs" in comparing.document(("a", "b"), same).blocks[0].text
    found = compare(ran(1.0), ran(1.2))
    assert [(c.key, c.old, c.new) for c in found.deck] == [("structure.width", 1.0, 1.2)]
    (verdict,) = found.verdicts
    assert (
        (verdict.key, verdict.ratio) == ("tilt", pytest.approx(1.2))
        and verdict.old.startswith("collapses")
        and verdict.new.startswith("stands")
    )
    numbers = {c.key: c.ratio for c in found.numbers["tilt"]}
    assert numbers["collapse_acceleration_g"] == pytest.approx(1.2) and numbers["weight_N"] == pytest.approx(1.2)
    assert compare(ran(1.0), ran(1.0 + 1e-7), tolerance=1e-5).numbers == {}
    assert "collapse_acceleration_g" in html.page(comparing.document(("a", "b"), found), Path())


def test_what_changed_of_an_assessment_is_reported_by_names() -> None:
    """Strategies and reasons by their names, whatever their place in the list; what follows from verdicts is not told again."""
    old = {"verdicts": [{"strategy": "tilt", "margin": 0.5}, {"strategy": "dem", "margin": None}], "agreement": {"tilt": {"dem": "open"}}}
    new = {"verdicts": [{"strategy": "dem", "margin": None}, {"strategy": "tilt", "margin": 0.8}], "agreement": {"tilt": {"dem": "agree"}}}
    (only,) = changes(flat(old), flat(new), 0.0)
    assert (only.key, only.ratio) == ("verdicts.tilt.margin", pytest.approx(1.6))
    twice = {"rows": [{"name": "a", "n": 1}, {"name": "a", "n": 2}]}
    assert set(flat(twice)) == {"rows.0.name", "rows.0.n", "rows.1.name", "rows.1.n"}, "names that stand twice name nothing"


def test_on_the_command_line(folder: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    done = CliRunner().invoke(cli.app, ["assess", str(folder), "--out", str(out), "--no-figures"])
    assert done.exit_code == 0 and done.output.index("w0.8") < done.output.index("w2.0"), done.output
    page = tmp_path / "changes.html"
    told = CliRunner().invoke(cli.app, ["compare", str(out / "w0.8"), str(out / "w1.2"), "--page", str(page)])
    assert told.exit_code == 0 and "structure.width" in told.output and "structure.width" in page.read_text()
    same = CliRunner().invoke(cli.app, ["compare", str(out / "w0.8"), str(out / "w0.8")])
    assert "Only the computing time differs" in same.output
    missing = CliRunner().invoke(cli.app, ["compare", str(out), str(out / "none")])
    assert missing.exit_code == 3 and "Traceback" not in missing.output
    empty = CliRunner().invoke(cli.app, ["assess", str(tmp_path)])
    assert empty.exit_code == 2


def test_a_ranking_that_was_changed_stays(folder: Path, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """What an engineer wrote into the ranking is not lost to the next run; what nobody touched is replaced."""
    out = tmp_path / "out"
    survey.assess_folder(folder, out, figures=False)
    with (out / "ranking.csv").open("a") as file:
        file.write("remarks,,,,,look again\n")
    survey.assess_folder(folder, out, figures=False)
    assert "look again" in (out / "ranking.csv").read_text() and "ranking-2.csv" in caplog.text
    assert not (out / "ranking-2.html").exists() and "look again" not in (out / "ranking-2.csv").read_text()


def test_names_of_buildings_are_no_formulas(folder: Path, tmp_path: Path) -> None:
    deck = next(p for p in folder.glob("*.toml") if p.name != "common.toml")
    deck.rename(deck.with_name("=cmd|calc.toml"))
    survey.assess_folder(folder, tmp_path / "out", figures=False)
    assert "\n'=cmd|calc," in (tmp_path / "out" / "ranking.csv").read_text()
