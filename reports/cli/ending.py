"""How a command ends: exit codes, a user's mistake told without a traceback, an interrupt; where its result goes."""

from __future__ import annotations

import errno
import shlex
import signal
import sys
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import typer

from harness.model import InputError, printable
from reports.cli.options import OutputOptions

if TYPE_CHECKING:
    from harness.records.base import Record

OK: Final = 0
FAILED: Final = 1
WRONG_INPUT: Final = 2
INTERRUPTED: Final = 130
NO_SUCH_PLACE: Final = frozenset(
    {errno.ENAMETOOLONG, errno.ENOENT, errno.ENOTDIR, errno.EISDIR, errno.ELOOP, errno.EEXIST}
)
"""What the system says of a path that is wrong, not of one that cannot be written or read just now."""


def guarded(action: Any) -> int:
    """Run a command; a user's mistake becomes a message on stderr and exit code 2, never a traceback.

    A request to end (SIGTERM) does what an interrupt does: workers are stopped, a store is closed, what is kept is said. A
    warning of Python's is said where progress is, on one line, or not at all.
    """
    with _ending_cleanly(), warnings.catch_warnings():
        warnings.showwarning = lambda *_: None
        try:
            code = action()
        except InputError as error:
            for mistake in error.mistakes:
                print(f"error: {mistake}", file=sys.stderr)
            return WRONG_INPUT
        except (KeyboardInterrupt, SystemExit) as ending:
            # Typer turns an interrupt into this exit code and says nothing.
            if isinstance(ending, SystemExit) and ending.code != INTERRUPTED:
                raise
            again = shlex.join(["rockcheck", *sys.argv[1:]])
            kept = [note for each in _causes(ending) for note in getattr(each, "__notes__", ())]
            told = f"{kept[0]}, and this goes on" if kept else "the same again"
            print(f"interrupted; {told}: {again}", file=sys.stderr)
            return INTERRUPTED
        except BrokenPipeError:
            sys.stderr.close()
            return FAILED
        except OSError as error:
            what = "the output could not be written: "
            if error.filename:
                what = f"{printable(repr(str(error.filename)))} could not be read or written: "
            elif error.errno is None:  # a library's own words
                what = ""
            print(f"error: {what}{printable(error.strerror or str(error))}", file=sys.stderr)
            return WRONG_INPUT if error.errno in NO_SUCH_PLACE else FAILED
    return int(code or OK)


@contextmanager
def _ending_cleanly() -> Iterator[None]:
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _causes(ending: BaseException | None) -> Iterator[BaseException]:
    """An exception and those while which it was raised, the last first."""
    while ending is not None:
        yield ending
        ending = ending.__context__


# Where a command's result goes, and how it is said: as JSON or as text, then its pages.


def say_record(record: Record, folder: Path, saying: OutputOptions, language: str = "en") -> None:
    """Say what was computed, then write its pages, none with `--json`: most of a short run's time, for a program that reads the
    record. A page that cannot be made is no mistake of the user's, and costs no other.
    """
    from harness.records.base import as_file
    from reports.terminal import record_lines

    saying.say(as_file(record), "\n".join(record_lines(record, verbose=saying.verbose)))
    if saying.as_json:
        return
    from reports.pages.page import write_report

    try:
        page = write_report(folder, language)
    except InputError as error:
        for mistake in error.mistakes:
            typer.echo(f"error: {mistake}", err=True)
        raise typer.Exit(FAILED) from error
    except (OSError, KeyboardInterrupt):
        pages = f"`rockcheck report {shlex.quote(str(folder))}` writes its pages"
        typer.echo(printable(f"the result stands in {folder}; {pages}"), err=True)
        raise
    except Exception as fault:
        name = ", ".join(getattr(fault, "__notes__", ["a page"]))
        what = f"{name} could not be made, {type(fault).__name__}: {fault}"
        typer.echo(printable(f"error: {what}; a fault of rockcheck: please report it"), err=True)
        raise typer.Exit(FAILED) from fault
    if not saying.silent:
        typer.echo(printable(f"report: {page}"))
