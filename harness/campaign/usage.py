"""Where the seconds of a study go: how busy its workers were, and what planning and storing cost."""

from __future__ import annotations

import statistics
import time
from collections.abc import Sequence
from dataclasses import fields

from harness.records.study import UsageRecord


class Usage:
    """Seconds of one call: of the clock, of all workers at work, of this process's processor, and outside engines per run."""

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self.runs = 0
        self.busy_s = self.own_s = self.wall_s = 0.0
        self._outside_s: list[float] = []
        self._begin = time.perf_counter(), time.process_time()

    def note(self, runs: int, busy_s: float, outside_s: Sequence[float]) -> None:
        """Count what a worker gave back: runs, seconds at work, and what each run took outside its engine."""
        self.runs += runs
        self.busy_s += busy_s
        self._outside_s.extend(outside_s)

    def stop(self) -> None:
        """Take both clocks."""
        self.wall_s = time.perf_counter() - self._begin[0]
        self.own_s = time.process_time() - self._begin[1]

    @property
    def utilisation(self) -> float | None:
        """Share of the workers' time in which they were at work; None where nothing ran."""
        return self.busy_s / (self.wall_s * self.workers) if self.runs else None

    @property
    def overhead_s_per_run(self) -> float | None:
        """Planning, sending, packing and storing: this process's time by the run, and the median run's outside its engine.

        The median leaves out what a worker does once, such as loading the statue's mesh.
        """
        if not self._outside_s:
            return None
        return self.own_s / self.runs + statistics.median(self._outside_s)

    def record(self) -> UsageRecord:
        """All numbers with their sentence, as a record holds them."""
        numbers = {item.name: getattr(self, item.name) for item in fields(UsageRecord) if item.name != "sentence"}
        return UsageRecord(**numbers, sentence=str(self))

    def __str__(self) -> str:
        if self.utilisation is None or self.overhead_s_per_run is None:
            return "nothing had to be computed"
        return (
            f"{self.runs} runs in {self.wall_s:.1f} s: {self.workers} workers {100.0 * self.utilisation:.0f} % busy, "
            f"{1000.0 * self.overhead_s_per_run:.2f} ms per run for planning, sending and storing"
        )
