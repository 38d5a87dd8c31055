"""The tools of those who keep the program: a release, the history of benchmarks, the site, a build apart, and recipes that agree."""

import importlib.util
import re
import subprocess
import sys
import tomllib
from pathlib import Path
from types import ModuleType

import pytest

from extrados.running import provenance

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def tool(place: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(Path(place).stem, ROOT / place)
    assert spec is not None and spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


release = tool("tools/release.py")


@pytest.fixture
def sources(tmp_path: Path) -> Path:
    """A repository that holds what a release touches."""
    for name in ["CHANGELOG.md", *release.PLACES]:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text((ROOT / name).read_text(encoding="utf-8"), encoding="utf-8")
    log = (tmp_path / "CHANGELOG.md").read_text(encoding="utf-8")
    (tmp_path / "CHANGELOG.md").write_text(log.replace(" (unreleased)\n\n", " (unreleased)\n\n- News.\n\n", 1), encoding="utf-8")
    for words in (["init", "-q"], ["config", "user.email", "a@b"], ["config", "user.name", "a"], ["add", "."], ["commit", "-qm", "all"]):
        subprocess.run(["git", "-C", tmp_path, *words], check=True)
    return tmp_path


def _write_news(sources: Path) -> None:
    """A line under the heading of the next version, which is empty after a release."""
    path = sources / "CHANGELOG.md"
    log, heading = path.read_text(encoding="utf-8"), "(unreleased)\n"
    path.write_text(log.replace(heading, f"{heading}\n- News.\n", 1), encoding="utf-8")
    release.git(sources, "commit", "-qam", "News")


def test_a_release_sets_the_version_everywhere(sources: Path) -> None:
    before = release.current(sources)
    major, minor, _ = release.numbers(before)
    version = f"{major}.{minor + 1}.0"
    _write_news(sources)
    assert release.release(sources, version, "2026-12-01").stat().st_size > 1000
    for name, (left, right) in release.PLACES.items():
        text = (sources / name).read_text(encoding="utf-8")
        assert re.search(f"{left}{re.escape(version)}{right}", text, re.M) and f"'{before}'" not in text
    log = (sources / "CHANGELOG.md").read_text(encoding="utf-8")
    assert f"## {major}.{minor + 2}.0 (unreleased)\n\n## {version} (2026-12-01)\n\n" in log
    assert release.git(sources, "tag") == f"v{version}" and not release.git(sources, "status", "--porcelain", "-uno")
    with pytest.raises(release.Refused, match="not larger"):
        release.prepare(sources, version, "2026-12-02")
    with pytest.raises(release.Refused, match="has no news"):
        release.prepare(sources, f"{major}.{minor + 3}.0", "2026-12-02")
    (sources / "pyproject.toml").write_text("")
    with pytest.raises(release.Refused, match="holds changes"):
        release.release(sources, "9.0.0", "2026-12-01")


def test_benchmarks_have_a_history(tmp_path: Path) -> None:
    """Labels are lines without their numbers; curves need two runs."""
    history, place = tool("tests/bench/history.py"), tmp_path / "history.jsonl"
    for seconds in (2.0, 1.5):
        history.append("arch", f"domain 40 x 40, one thread: {seconds} s (4,000 runs/s)\nno time here: 3\n", place)
    entries = history.read(place)
    assert len(entries) == 2 and entries[0]["told"] == {"domain # x #, one thread: # s (# runs/s)": [2.0, "s"]}
    [points] = history.curves(entries, "arch").values()
    assert [(value, unit) for _, value, unit in points] == [(2.0, "s"), (1.5, "s")]
    assert history.parsed("4,000 motions/s") == {"# motions/s": (4000.0, "motions/s")}


def test_a_build_apart_holds_no_source_that_is_gone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    apart = tool("tools/apart.py")
    folder, place = tmp_path / "root" / "python", tmp_path / "place"
    folder.mkdir(parents=True)
    for name in ("kept.py", "gone.py"):
        (folder / name).write_text("")
    monkeypatch.setattr(apart, "ROOT", tmp_path / "root")
    monkeypatch.setattr(apart, "PARTS", ("python",))
    apart.copy(place)
    (place / "python" / "_core.so").write_text("")  # made by the build
    (folder / "gone.py").unlink()
    apart.copy(place)
    assert {path.name for path in place.rglob("*.*")} == {"kept.py", "_core.so"}


def test_every_room_of_the_core_has_tests_that_seeded_faults_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    rooms = tool("tools/fault_tests.py").ROOMS
    sources = [path for root in ("fortran", "c") for end in ("f90", "c") for path in (ROOT / root).glob(f"*/*.{end}")]
    # facades hold no mechanics of their own
    assert {path.parent.relative_to(ROOT).as_posix() for path in sources} - {"fortran/api"} == set(rooms)
    for native, python, _ in rooms.values():
        assert all((ROOT / "tests" / name).exists() for name in python)
        assert all(any((ROOT / "tests").glob(f"*/{name}.*")) for name in native)


def test_a_site_with_a_broken_link_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    (tmp_path / "a.html").write_text(
        '<h1 id="here">a</h1> <a href="#here">b</a> <h2 id="o%28-%29">d</h2> <a href="#o%28-%29">e</a> <img src="data:,"> <a href="https://x">c</a>'
    )
    (tmp_path / "b.html").write_text('<a href="gone.html">a</a> <a href="a.html#gone">b</a> <script src="https://x"></script>')
    wrong = ["gone.html leads nowhere", "a.html#gone leads nowhere", "https://x is loaded from the network"]
    assert tool("tools/site.py").broken(tmp_path) == [f"b.html: {text}" for text in wrong]


def listed(recipe: str, part: str) -> set[str]:
    """The requirements of a part of the conda recipe."""
    found = re.search(rf"^  {part}:\n((?:    - .*\n)+)", recipe, re.M)
    assert found is not None
    return {line.removeprefix("    - ").replace(" ", "") for line in found[1].splitlines()}


def test_every_way_to_install_asks_for_the_same() -> None:
    """Debian's packages of set-up, wheels and container; the libraries of pyproject.toml and the conda recipe."""
    setup, wheels, container, recipe = (
        (ROOT / name).read_text(encoding="utf-8")
        for name in ("tools/setup.sh", "tools/wheels.sh", "Containerfile", "tools/conda/recipe.yaml")
    )
    wanted = re.search(r'^packages="(.*)"$', setup, re.M)[1].split()
    for text in (wheels, container):
        asked = re.search(r"apt-get install(?: -\S+)*((?:\s+\\\n|\s+[a-z][\w.+-]*)+)", text)
        # the bare machine of wheels holds python3; that of a container gets it with python3-dev
        assert set(asked[1].replace("\\", " ").split()) == set(wanted) - {"python3"}
    assert len(set(re.findall(r"^FROM (\S+)", container, re.M))) == 1, "a library of one release is not that of another"
    project = PROJECT["project"]
    renamed = {"matplotlib-base": "matplotlib", "typst-py": "typst"}  # on conda-forge: on PyPI
    run = {re.sub(r"^[\w-]+", lambda name: renamed.get(name[0], name[0]), line) for line in listed(recipe, "run")}
    assert run == {*project["dependencies"], f"python{project['requires-python']}"}
    assert set(PROJECT["build-system"]["requires"]) <= listed(recipe, "host")


def test_forms_of_the_issue_tracker_ask_for_deck_result_source_and_version() -> None:
    forms = {path.stem: path.read_text(encoding="utf-8") for path in (ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml")}
    assert set(forms) == {"config", "fault", "question", "wish"}
    assert re.findall(r"^    id: (\w+)$", forms["fault"], re.M) == ["deck", "found", "expected", "version", "system"]
    assert forms["fault"].count("required: true") == 4


def test_the_citation_and_the_paper_name_the_dissertation() -> None:
    """And every source that the paper cites is in its list."""
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    title = "Seismic assessment strategies for masonry structures"
    assert f'title: "{title}"' in citation
    paper, sources = ((ROOT / "docs" / "paper" / f"paper.{end}").read_text(encoding="utf-8") for end in ("md", "bib"))
    known = set(re.findall(r"^@\w+\{(\w+),", sources, re.M))
    assert set(re.findall(r"@([A-Z]\w+\d{4})", paper)) == known and title.lower() in sources.lower()


def test_an_installed_copy_states_the_commit_that_it_was_built_from(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / ".git").mkdir()  # of a repository that happens to lie around
    monkeypatch.setattr(provenance, "COMMIT", "abc1234")
    monkeypatch.setattr(provenance, "__file__", str(tmp_path / "site-packages" / "extrados" / "running" / "provenance.py"))
    assert provenance.provenance()["commit"] == "abc1234"


def test_the_stub_is_made_with_what_the_build_requires(tmp_path: Path) -> None:
    """numpy and pydantic: the libraries of the program are not there as it is built."""
    absent = ("scipy", "pint", "matplotlib", "h5py", "rich", "typer", "ezdxf", "jinja2", "typst", "highspy", "clarabel", "dask")
    code = (
        f"import runpy, sys; sys.modules.update(dict.fromkeys({absent})); sys.argv[1:] = {[str(ROOT / 'python/extrados'), str(tmp_path / 'x.pyi')]}; "
        f"runpy.run_path({str(ROOT / 'python/make_stub.py')!r}, run_name='__main__')"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert "class Arch:" in (tmp_path / "x.pyi").read_text(encoding="utf-8")
