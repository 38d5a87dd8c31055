"""The command line. Exit codes: 0 done; 2 the deck is wrong; 3 refused or failed; 130 or 143 interrupted (Ctrl-C, SIGTERM)."""

import contextlib
import io
import logging
import os
import signal
import sys
from collections import namedtuple
from typing import Annotated

import typer

from extrados import interrupts, room
from extrados.cli.checking import check
from extrados.cli.elsewhere import explore, export, import_plan
from extrados.cli.reference import cases, explain, new, schema, version
from extrados.cli.running import assess, motion, run
from extrados.cli.stored import compare, plot, report
from extrados.cli.terminal import NOT_DONE, Commands

app = Commands(no_args_is_help=True, pretty_exceptions_enable=False, help=__doc__)
#: In the order in which `extrados --help` lists them. What a command needs it imports as it is called.
COMMANDS = (run, motion, check, schema, explain, new, cases, report, compare, assess, plot, explore, export, import_plan, version)
for command in COMMANDS:
    app.command()(command)


def _print_version(asked: bool) -> None:
    if asked:
        version()
        raise typer.Exit()


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="version, commit and compilers")
    ] = False,
) -> None:
    pass


def _open_streams() -> None:
    """Open a substitute for streams that the caller has closed; otherwise the next opened file would receive their output."""
    while (handle := os.open(os.devnull, os.O_RDWR)) <= 2:
        os.set_inheritable(handle, True)
    os.close(handle)
    sys.stdout = sys.stdout or os.fdopen(1, "w", closefd=False)
    sys.stderr = sys.stderr or os.fdopen(2, "w", closefd=False)


def main() -> None:
    """Run a command; see `extrados.__main__` for what comes before."""
    _open_streams()
    logging.basicConfig(level=logging.WARNING, format="%(message)s")
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a terminal may know ASCII alone
    code: int | str | None = 0
    try:
        try:
            interrupts.answer(interrupts.stop)
            interrupts.insist()
            app()
        except SystemExit as left:
            code = left.code
        except KeyboardInterrupt:
            code = interrupts.exit_code()
        except Exception as error:
            if isinstance(error, MemoryError) or room.lacked(error):
                os.write(2, f"{room.words(error)}\n".encode(errors="replace"))  # a console may find no room either
                code = NOT_DONE
            elif interrupts.asked:  # a library that was interrupted may call it an error of its own
                code = interrupts.exit_code()
            else:
                raise
        interrupts.answer(signal.SIG_IGN)  # what is to be done is done
        if code and interrupts.asked:
            code = interrupts.exit_code()  # typer has one of its own
            # CPython kills itself at its end where a text that it evaluated was interrupted, unless another follows
            namedtuple("Text", "")
        sys.stdout.flush()
    except OSError as error:
        # the reader of our output went away, as in `extrados cases | head`, or what it goes to is full
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(error, BrokenPipeError):
            with contextlib.suppress(OSError):  # what errors are told to may be full, too
                os.write(2, f"the output could not be written: {error.strerror}\n".encode())
        code = code or NOT_DONE
    sys.exit(code)
