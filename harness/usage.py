"""Where the seconds of a study go: how busy its workers were, and what keeping the store and the order cost."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Any


@dataclass
class Usage:
    """Seconds of one call: of the clock, of all workers together, of these inside engines, of this process's processor."""

    workers: int
    runs: int = 0
    busy_s: float = 0.0
    engine_s: float = 0.0
    own_s: float = 0.0
    wall_s: float = 0.0
    _begin: tuple[float, float] = field(default=(0.0, 0.0), repr=False)

    def __post_init__(self) -> None:
        """Start both clocks."""
        self._begin = time.perf_counter(), time.process_time()

    def note(self, runs: int, busy_s: float, engine_s: float) -> None:
        """Count what a worker gave back."""
        self.runs += runs
        self.busy_s += busy_s
        self.engine_s += engine_s

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
        """Planning, sending, packing and storing of one run: this process's time, and the workers' outside engines."""
        return (self.own_s + self.busy_s - self.engine_s) / self.runs if self.runs else None

    def as_dict(self) -> dict[str, Any]:
        """All numbers as plain values."""
        names = ("workers", "runs", "wall_s", "busy_s", "engine_s", "own_s", "utilisation", "overhead_s_per_run")
        return {name: getattr(self, name) for name in names}

    def __str__(self) -> str:
        if self.utilisation is None or self.overhead_s_per_run is None:
            return "nothing had to be computed"
        return (
            f"{self.runs} runs in {self.wall_s:.1f} s: {self.workers} workers {100.0 * self.utilisation:.0f} % busy, "
            f"{1000.0 * self.overhead_s_per_run:.2f} ms per run outside the engines"
        )
