"""What a command says on stderr while it works: never longer silent than ten seconds."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from threading import Event, Thread
from typing import TYPE_CHECKING, Any, Final

from harness.model.terminal import printable

if TYPE_CHECKING:
    from rich.progress import Progress

SILENT_S: Final = 10.0
"""Off a terminal, where nothing can turn, a line comes at least this often."""


class ProgressMessages:
    """Says what is at work: a spinner with the time spent on a terminal, lines elsewhere, nothing when quiet."""

    def __init__(self, quiet: bool, silent_s: float = SILENT_S) -> None:
        self._lines = not quiet and not sys.stderr.isatty()
        self._bar = None if quiet or self._lines else _spinner()
        self._silent_s = silent_s
        self._done = Event()
        self._now = ("reading", time.monotonic())
        self._said = time.monotonic()

    def __enter__(self) -> ProgressMessages:
        if self._lines:
            Thread(target=self._remind, daemon=True).start()
        elif self._bar is not None:
            self._bar.start()
        return self

    def __exit__(self, *details: Any) -> None:
        self._done.set()
        if self._bar is not None:
            self._bar.stop()

    def engine(self, name: str) -> None:
        """Tell that an engine has started."""
        self.now(f"running {name}")

    def now(self, words: str) -> None:
        """Tell what is at work from now on."""
        words = printable(words)
        self._now = (words, time.monotonic())
        if self._bar is not None:
            self._bar.update(self._bar.task_ids[0], description=words)
        elif self._lines:
            self.say(words)

    def later(self, words: str) -> None:
        """What a reminder tells from now on, without a word now."""
        self._now = (words, time.monotonic())

    def say(self, words: str) -> None:
        """Tell this once."""
        self._said = time.monotonic()
        if self._bar is not None:
            self._bar.console.print(words, highlight=False)
        elif self._lines:
            print(words, file=sys.stderr, flush=True)

    def _remind(self) -> None:
        while not self._done.wait(max(0.01, self._said + self._silent_s - time.monotonic())):
            if time.monotonic() - self._said >= self._silent_s:
                words, since = self._now
                self.say(f"{words}: {time.monotonic() - since:.0f} s so far")


def _spinner() -> Progress:
    """A spinner with the time spent; what draws it takes a twentieth of a second to import, and only a terminal needs it."""
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn()
    bar = Progress(*columns, console=Console(stderr=True, markup=False, emoji=False), transient=True)
    bar.add_task("reading", total=None)
    return bar


@contextmanager
def progress(title: str, quiet: bool, size: str = "") -> Iterator[Any]:
    """A bar with the time left on a terminal, a line every tenth elsewhere; yields `told(done, all)`; `size` is said first."""
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    console = Console(stderr=True, quiet=quiet, markup=False, emoji=False)
    title = printable(title)
    if size:
        console.print(printable(size), highlight=False)
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with ExitStack() as stack:
        bar = stack.enter_context(Progress(*columns, console=console, disable=quiet or not console.is_terminal))
        lines = ProgressMessages(quiet or console.is_terminal)
        stack.enter_context(lines)
        task = bar.add_task(title, total=None)
        said = -1

        def told(done: int, total: int) -> None:
            nonlocal said
            bar.update(task, completed=done, total=total)
            tenth = 10 * done // total if total else 10
            (lines.now if tenth != said else lines.later)(f"{title}: {done} of {total} runs")
            said = tenth

        yield told
