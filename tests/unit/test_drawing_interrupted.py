"""Signals while figures are drawn side by side: everything ends within seconds, the results stay, the exit code is the signal's."""

import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from extrados.show.forked import Lost, side_by_side

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="figures are drawn side by side on Linux")
SECONDS = 30.0  # a hang is for ever; a busy machine takes its time
ANALYSES = '[[analysis]]\nkind = "rocking"\n' * 8 + '[[analysis]]\nkind = "tilt"\n' * 4
DECK = '[structure]\nkind = "block"\nwidth = 1.0\nheight = 4.0\n[motion]\nkind = "sine-pulse"\namplitude = "0.4 g"\nperiod = 1.0\n'


def children(process: int) -> list[int]:
    """Processes that a process has begun and that live."""
    try:
        return [int(n) for n in Path(f"/proc/{process}/task/{process}/children").read_text().split()]
    except OSError:
        return []


def drawers(process: int) -> list[int]:
    """Processes forked from a command that stay with its own command line; the reader of files takes another."""

    def forked() -> set[int]:
        said, found = Path(f"/proc/{process}/cmdline").read_bytes(), set()
        for child in children(process):
            with contextlib.suppress(OSError):
                if Path(f"/proc/{child}/cmdline").read_bytes() == said:
                    found.add(child)
        return found

    first = forked()
    time.sleep(0.1 if first else 0.0)
    return sorted(first & forked()) if first else []


def group(leader: int) -> list[int]:
    """Living processes of a group."""
    found = []
    for place in Path("/proc").glob("[0-9]*"):
        try:
            words = (place / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(words[2]) == leader and words[0] != "Z":
            found.append(int(place.name))
    return found


#: The command, whose figures of `rocking` take longer than anyone waits
ENDLESS = """
import sys, time
import extrados.show.arch
from extrados.__main__ import main
extrados.show.arch.draw_rocking = lambda *_: time.sleep(600)
sys.argv[0] = "extrados"
main()
"""


def drawing(
    folder: Path, written: str, *arguments: str, command: tuple[str, ...] = ("-m", "extrados")
) -> tuple[subprocess.Popen, list[int]]:
    """The command in a group of its own, once `written` is there and it draws, and the processes that draw."""
    process = subprocess.Popen(
        [sys.executable, *command, *arguments, "--quiet"],
        cwd=folder,
        start_new_session=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    end = time.monotonic() + 120.0
    while not ((folder / written).exists() and (found := drawers(process.pid))):
        assert process.poll() is None and time.monotonic() < end, process.communicate()[0]
        time.sleep(0.005)
    return process, found


def gone(process: subprocess.Popen) -> str:
    """What it said; fails where a process of its group is left after SECONDS."""
    try:
        text = process.communicate(timeout=SECONDS)[0]
        end = time.monotonic() + 5.0
        while (left := group(process.pid)) and time.monotonic() < end:
            time.sleep(0.05)
        assert not left
        return text
    finally:
        if group(process.pid):
            os.killpg(process.pid, signal.SIGKILL)


needs_cores = pytest.mark.skipif(
    not hasattr(os, "sched_getaffinity") or len(os.sched_getaffinity(0)) < 2, reason="one core draws one by one"
)


@needs_cores
@pytest.mark.parametrize("everyone", [True, False], ids=["group", "command"])
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_while_a_run_is_drawn(tmp_path, number, everyone) -> None:
    (tmp_path / "deck.toml").write_text(DECK + ANALYSES)
    process, _ = drawing(tmp_path, "out/summary.json", "run", "deck.toml", "--out", "out")
    (os.killpg if everyone else os.kill)(process.pid, number)
    text = gone(process)
    assert process.returncode == 128 + number, text
    assert "interrupted while drawing" in text and "Traceback" not in text
    assert (tmp_path / "out" / "summary.json").exists()
    assert not list(tmp_path.glob(".out.drawing-*"))


@needs_cores
@pytest.mark.parametrize("everyone", [True, False], ids=["group", "command"])
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_while_a_folder_is_drawn(tmp_path, number, everyone) -> None:
    """Here signals are noted and no exception: the wait for killed processes had no end."""
    (tmp_path / "decks").mkdir()
    for name in ("a", "b"):
        (tmp_path / "decks" / f"{name}.toml").write_text(f'{DECK}[analysis]\nkind = "assess"\nbudget = 5.0\n')
    process, _ = drawing(tmp_path, "out/a/summary.json", "assess", "decks", "--out", "out", command=("-c", ENDLESS))
    time.sleep(5.0)  # by now the other tasks are done
    (os.killpg if everyone else os.kill)(process.pid, number)
    text = gone(process)
    assert process.returncode == 128 + number, text
    assert "Traceback" not in text
    assert (tmp_path / "out" / "a" / "summary.json").exists()


@needs_cores
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_while_one_long_task_is_left(tmp_path, number) -> None:
    """A process without work waited with a lock in hand, killed it left the lock closed."""
    (tmp_path / "deck.toml").write_text(f'{DECK}[[analysis]]\nkind = "tilt"\n[[analysis]]\nkind = "rocking"\n')
    process, _ = drawing(tmp_path, "out/summary.json", "run", "deck.toml", "--out", "out", command=("-c", ENDLESS))
    time.sleep(5.0)  # by now the other task is done
    os.killpg(process.pid, number)
    text = gone(process)
    assert process.returncode == 128 + number and "interrupted while drawing" in text, text


@needs_cores
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_a_process_that_draws_is_killed(tmp_path, number) -> None:
    (tmp_path / "deck.toml").write_text(DECK + ANALYSES)
    process, (first, *_) = drawing(tmp_path, "out/summary.json", "run", "deck.toml", "--out", "out")
    os.kill(first, number)
    text = gone(process)
    assert process.returncode == 3 and f"ended with exit code -{int(number)}" in text and "The results are kept" in text
    assert (tmp_path / "out" / "summary.json").exists()
    again = subprocess.run([sys.executable, "-m", "extrados", "report", "out"], cwd=tmp_path, timeout=300, check=False)
    assert again.returncode == 0 and (tmp_path / "out" / "report.html").exists()


@needs_cores
def test_the_processes_that_draw_end_with_the_command(tmp_path) -> None:
    (tmp_path / "deck.toml").write_text(DECK + ANALYSES)
    process, _ = drawing(tmp_path, "out/summary.json", "run", "deck.toml", "--out", "out")
    process.kill()
    gone(process)
    assert (tmp_path / "out" / "summary.json").exists()


def test_order_errors_and_limits() -> None:
    before = set(children(os.getpid()))  # another test of this process may keep one, such as the reader of files
    assert side_by_side([lambda k=k: k * k for k in range(7)], 3) == [k * k for k in range(7)]
    large = side_by_side([lambda: "x" * 1_000_000] * 3, 2)  # more than a pipe holds
    assert [len(text) for text in large] == [1_000_000] * 3
    with pytest.raises(ValueError, match="of its own"):
        side_by_side([lambda: 1, lambda: (_ for _ in ()).throw(ValueError("of its own"))], 2)
    with pytest.raises(Lost, match="code 7"):
        side_by_side([lambda: os._exit(7)], 1)
    with pytest.raises(Lost, match="did not end within"):
        side_by_side([lambda: time.sleep(600)], 1, longest=0.3)
    assert not set(children(os.getpid())) - before
