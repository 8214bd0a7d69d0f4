"""What a command says on stderr while it works: never longer silent than ten seconds."""

from __future__ import annotations

import sys
import time
import warnings
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from threading import Event, Thread
from typing import TYPE_CHECKING, Final

from harness.model import printable

if TYPE_CHECKING:
    from rich.progress import Progress

SILENT_S: Final = 10.0
"""Off a terminal, where nothing can turn, a line comes at least this often."""
LESS_STORED: Final = ", less what the store holds"
"""Follows what a call is expected to take, where calls before it left results."""
RATE_S: Final = 1800.0
"""The rate is that of so long: a task may take minutes, and the machine's load changes within the hour."""
FORECAST_TASKS: Final = 10
"""What was forecast of a task counts as much as so many tasks that finished: in a study of 70 runs, whose longest take ten times
the median, the time left is then within 1.5 of the truth from a tenth on in 93 % of orders, by the rate alone in 75 %."""


class ProgressMessages:
    """Says what is at work: on a terminal a spinner with the time spent, and a bar of what it `counts`; lines elsewhere, nothing
    when quiet.
    """

    def __init__(self, quiet: bool, silent_s: float = SILENT_S, *, counts: bool = False) -> None:
        self._lines = not quiet and not sys.stderr.isatty()
        self._bar = None if quiet or self._lines else _bar(counts)
        self._silent_s = silent_s
        self.left: Callable[[], str] = lambda: ""
        """What a reminder says of the time that is left."""
        self._done = Event()
        self._now = ("reading", time.monotonic())
        self._said = time.monotonic()
        self._before: str | None = None
        self._ending = ExitStack()

    def __enter__(self) -> ProgressMessages:
        from analytic.machine_code import listeners  # not for help

        listeners.append(self.compiling)
        self._ending.callback(listeners.remove, self.compiling)
        self._ending.enter_context(warnings.catch_warnings())
        warnings.showwarning = lambda message, *place: self.say(printable(f"warning: {message}"))
        if self._lines:
            Thread(target=self._remind, daemon=True).start()
            self._ending.callback(self._done.set)
        elif self._bar is not None:
            self._ending.enter_context(self._bar)
        return self

    def __exit__(self, *details: object) -> None:
        self._ending.close()

    def engine(self, name: str) -> None:
        """Tell that an engine has started."""
        self.now(f"running {name}")

    def now(self, words: str) -> None:
        """Tell what is at work from now on."""
        words = printable(words)
        self.later(words)
        if self._lines:
            self.say(words)

    def compiling(self, done: int, total: int) -> None:
        """Tell how many functions of a model are compiled."""
        if self._before is None:
            self._before = self._now[0]
            self.now("compiling a model, once after an upgrade")
        words = f"compiling a model, {done} of {total} functions"
        if done == total:
            words, self._before = self._before, None
        self.later(words, self._now[1])

    def later(self, words: str, since_s: float | None = None, counted: tuple[int, int] | None = None) -> None:
        """What the spinner shows, and a reminder tells from now on, without a line now; how many of how many are done."""
        self._now = (words, time.monotonic() if since_s is None else since_s)
        if self._bar is not None:
            done, total = counted or (None, None)
            self._bar.update(self._bar.task_ids[0], description=words + self.left(), completed=done, total=total)

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
                self.say(f"{words}: {time.monotonic() - since:.0f} s so far{self.left()}")


def _bar(counts: bool) -> Progress:
    """A spinner with the time spent; what draws it takes a twentieth of a second to import, and only a terminal needs it."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    bar = Progress(
        SpinnerColumn(),
        TextColumn("{task.description}", markup=False),
        *([BarColumn()] if counts else []),
        TimeElapsedColumn(),
        console=Console(stderr=True, markup=False, emoji=False),
        transient=not counts,
    )
    bar.add_task("reading", total=None)
    return bar


@contextmanager
def progress(
    title: str,
    quiet: bool,
    size: str = "",
    *,
    workers: int = 1,
    each_s: float = 0.0,
    after_s: float = 0.0,
    grows: bool = False,
) -> Iterator[Callable[[int, int], None]]:
    """A bar with the time left on a terminal, lines elsewhere; yields `on_progress(done, all)`; `size` is said first.

    The time left is by the clock, from the rate at which tasks finished lately: it holds whatever else the machine does. The
    first count for little beside `each_s`, what a task was forecast to take by the clock (0: nothing was). What `workers` have in
    hand at the end takes them one after another out of work; `after_s` is what follows the last task.
    Of tasks that ask for others (it `grows`) none is told.
    """
    title = printable(title)
    # The bar's own rate begins with the first tasks that finish: two blocks that finish together would be infinitely fast.
    samples: deque[tuple[float, int]] = deque()
    wanted, said = 0, -1

    def on_progress(done: int, total: int) -> None:
        nonlocal said, wanted
        wanted = total
        samples.append((time.monotonic(), done))
        while len(samples) > 2 and samples[1][0] < samples[-1][0] - RATE_S:
            samples.popleft()
        tenth = 10 * done // total if total else 10
        # Nothing that costs is known yet.
        words = f"{title}: {done} of {counted(total, 'run')}" if total else title
        if tenth != said:
            messages.now(words + left())
        # A reminder says the time that is left as it is then.
        messages.later(words, counted=(done, total))
        said = tenth

    def left() -> str:
        if grows or not samples:
            return ""
        (begin_s, before), (_, done) = samples[0], samples[-1]
        known = FORECAST_TASKS * (each_s > 0.0)
        if done - before + known == 0 or done >= wanted:
            return ""
        rate_s = (time.monotonic() - begin_s + known * each_s) / (done - before + known)
        # The last of n tasks of chance lengths that run at once takes 1 + 1/2 + … + 1/n times their mean.
        last = min(wanted - done, workers)
        in_hand = workers * sum(1.0 / k for k in range(1, last + 1))
        return f", about {duration_words(rate_s * (wanted - done - last + in_hand) + after_s)} left"

    with ProgressMessages(quiet, counts=True) as messages:
        if size:
            messages.say(printable(size))
        messages.left = left
        yield on_progress


def counted(count: int, noun: str) -> str:
    """`1 run`, `2 runs`."""
    return f"{count} {noun}{'s' if count != 1 else ''}"


def duration_words(seconds: float) -> str:
    """Seconds in the unit that fits."""
    for size, unit in ((86_400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if seconds >= 1.5 * size:
            return f"{seconds / size:{'.2g' if seconds < 10.0 * size else '.0f'}} {unit}"
    return f"{max(seconds, 1.0):.0f} s"


def forecast_words(least_s: float, most_s: float) -> str:
    """`about 40 s`, or `40 s to 2 min`."""
    low, high = duration_words(least_s), duration_words(most_s)
    return f"about {low}" if low == high else f"{low} to {high}"
