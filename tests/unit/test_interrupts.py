"""Signals that come amid what Python does on its own."""

import signal
import subprocess
import sys

import pytest

#: A signal amid a finaliser, where Python ignores every exception; then work that takes longer than anyone waits
UNHEARD = """
import signal, sys, time
from extrados import interrupts
interrupts.answer(interrupts.stop)
interrupts.insist()
class Held:
    def __del__(self):
        signal.raise_signal(int(sys.argv[1]))
        time.sleep(0)
try:
    held = Held()
    del held
    time.sleep(600)
except KeyboardInterrupt:
    sys.exit(interrupts.exit_code())
"""


@pytest.mark.skipif(sys.platform == "win32", reason="timers are those of POSIX")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_amid_a_finaliser_is_not_lost(number: signal.Signals) -> None:
    run = subprocess.run([sys.executable, "-c", UNHEARD, str(int(number))], capture_output=True, text=True, timeout=60)
    assert run.returncode == 128 + number, run.stderr
    assert not run.stderr


def test_other_errors_amid_a_finaliser_are_reported_as_ever() -> None:
    raising = "class Held:\n    def __del__(self):\n        raise ValueError('of its own')\nheld = Held()\ndel held\n"
    run = subprocess.run(
        [sys.executable, "-c", "from extrados import interrupts\ninterrupts.insist()\n" + raising], capture_output=True, text=True
    )
    assert run.returncode == 0 and "of its own" in run.stderr
