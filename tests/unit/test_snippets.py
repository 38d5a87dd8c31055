"""The commands and snippets of README and docs: all are right in form here; `-m verify` runs the pages whole.

A page runs in a folder of its own, from top to bottom. A block of TOML whose first line is `# NAME.toml` becomes that
file; a block marked `text` shows what the block before it prints, line by line: each line, or as far as it goes, is in it.
"""

import contextlib
import io
import os
import re
import shlex
from pathlib import Path

import click
import pytest
import typer.main
from typer.testing import CliRunner

from extrados.cli import app

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
#: Pages whose every block is run, in order
WHOLE = ["start", "tutorial-bridge", "tutorial-fragility", "tutorial-lesson", "tutorial-typology", "scripting", "guide"]
FENCE = re.compile(r"^```(\w*)[^\n]*\n(.*?)^```", re.S | re.M)
ARCH = """title = "An arch"
[structure]
kind = "arch"
radius = 1.0
thickness = 0.18
embrace = 170.0
voussoirs = 34
[motion]
kind = "record"
file = "extrados:el-centro-1940"
[[analysis]]
kind = "tilt"
[[analysis]]
kind = "rocking"
"""
#: What stands for something of the reader's, by what the test has; none: a page that waits, a file or machine that is not here
MEANT = {
    "FOLDER": "decks",
    "WORD": "friction",
    "DIR": "results/my",
    "A": "results/my",
    "B": "results/my",
    "KIND": "rocking",
    "FILE": "extrados:el-centro-1940",
    "DECK": "my.toml",
    "ADDRESS": "",
    "results/a": "results/my",
    "results/b": "results/my",
    "results/bridge": "results/my",
    "PATH": "my.toml",
}
AWAY = ("explore", "--scheduler", "--install-completion", "my-vault.toml", "--to compas", "--together", ".ifc", ".dxf", "office/")


def text_of(page: Path) -> str:
    return page.read_text(encoding="utf-8")


def commands(text: str) -> list[str]:
    """Lines of a page that call the program, in fenced blocks and in backquotes, without comments and explanations."""
    lines = [line for _, block in FENCE.findall(text) for line in block.splitlines()]
    lines += re.findall(r"`(extrados [^`]+)`", FENCE.sub("", text))
    found = [re.split(r"\s{2,}|\s#", line.strip().removeprefix(".venv/bin/"))[0] for line in lines]
    return [line for line in found if line.startswith("extrados ")]


ALL = sorted({line for page in PAGES for line in commands(text_of(page))})
PYTHON = [
    pytest.param(block, id=f"{page.stem}-{k}")
    for page in PAGES
    for k, (language, block) in enumerate(FENCE.findall(text_of(page)))
    if language == "python"
]


def meant(line: str) -> list[str]:
    """The words of a command with files that are here, without the file that a shell writes its output to."""
    words = shlex.split(line.split(" > ")[0])[1:]
    known = MEANT | ({"FOLDER": "results/my"} if words[0] == "report" else {})
    return [known.get(word, word) for word in words]


@pytest.mark.parametrize("line", ALL)
def test_commands_have_the_form_that_the_program_takes(line: str) -> None:
    """The command is there, and so are its options; nothing is run."""
    group = typer.main.get_command(app)
    name, *rest = meant(line)
    if name.startswith("--"):
        assert name in {option for p in group.get_params(click.Context(group)) for option in p.opts}, line
        return
    command = group.commands[name]
    context = command.context_class(command, info_name=name, resilient_parsing=True)
    command.make_parser(context).parse_args(list(rest))


@pytest.mark.parametrize("block", PYTHON)
def test_python_of_the_docs_is_python(block: str) -> None:
    compile(block, "docs", "exec")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where a reader would sit: decks of theirs, the cases, and results of a run."""
    (tmp_path / "decks").mkdir()
    for name in ("my.toml", "deck.toml", "decks/one.toml"):
        (tmp_path / name).write_text(ARCH)
    (tmp_path / "cases").symlink_to(ROOT / "cases")
    (tmp_path / "house.toml").symlink_to(ROOT / "cases" / "building" / "two-rooms.toml")
    monkeypatch.chdir(tmp_path)
    assert CliRunner().invoke(app, ["run", "my.toml", "--quiet", "--no-figures"]).exit_code == 0
    return tmp_path


def plain(text: str) -> str:
    return " ".join(text.split())


@pytest.mark.verify
@pytest.mark.parametrize("name", WHOLE)
def test_pages_run_from_top_to_bottom(name: str, folder: Path) -> None:
    names: dict = {}
    printed = ""
    for language, block in FENCE.findall(text_of(ROOT / "docs" / f"{name}.md")):
        if language == "toml" and (file := re.match(r"# ([\w-]+\.toml)\n", block)):
            (folder / file[1]).write_text(block)
        elif language == "python":
            with contextlib.redirect_stdout(io.StringIO()) as out:
                exec(compile(block, f"{name}.md", "exec"), names)
            printed = plain(out.getvalue())
        elif language == "sh":
            printed = ""
            for line in commands(f"```\n{block}```"):
                done = CliRunner().invoke(app, meant(line))
                assert done.exit_code == 0, f"{line}: {done.output}"
                printed += " " + plain(done.output)
        elif language == "text":
            for line in block.splitlines():
                assert plain(line).removesuffix(" ...") in printed, f"{name}: '{line}' is not in: {printed}"


@pytest.mark.verify
def test_the_readme_shows_what_its_deck_prints(folder: Path) -> None:
    shown = re.search(r"^```text\n(.*?)^```", text_of(ROOT / "README.md"), re.S | re.M)
    assert shown is not None
    done = CliRunner().invoke(app, ["run", "cases/arch/readme.toml", "--out", "results/readme"])
    assert done.exit_code == 0, done.output
    printed = plain(done.output)
    assert [line for line in shown[1].splitlines() if plain(line).removesuffix(" ...") not in printed] == []


#: Commands of the pages that `test_pages_run_from_top_to_bottom` runs
RUN_WITH_THEIR_PAGE = {line for name in WHOLE if name != "guide" for line in commands(text_of(ROOT / "docs" / f"{name}.md"))}


@pytest.mark.verify
@pytest.mark.parametrize("line", [line for line in ALL if line not in RUN_WITH_THEIR_PAGE and not any(word in line for word in AWAY)])
def test_commands_of_the_docs_run(line: str, folder: Path) -> None:
    words = meant(line)
    if len(words) == 1 and words[0] in ("run", "check", "report", "compare", "assess"):
        return  # a word about the command
    done = CliRunner().invoke(app, words, env={"COLUMNS": "200"})
    assert done.exit_code == 0, f"{line}: {done.output[-2000:]}"
    assert os.listdir(folder)
