"""What a user says of a text that no reader knows: its step, where its numbers begin, which columns hold what."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

WHOLE: Final = "all"
"""`columns` of one channel whose numbers run on from line to line."""


@dataclass(frozen=True)
class Layout:
    """`--dt`, `--skip-lines`, `--columns` ("2,3" or "2:N,3:E", or "all") and `--time-column` (columns count from 1)."""

    dt_s: float | None = None
    skip_lines: int | None = None
    columns: str | None = None
    time_column: int | None = None

    @property
    def given(self) -> bool:
        """Whether anything is said."""
        return self != Layout()

    def options(self) -> str:
        """The same as options of `rockcheck motion inspect`."""
        said = (("skip-lines", self.skip_lines), ("time-column", self.time_column), ("columns", self.columns))
        words = [f"--{name} {value}" for name, value in said if value]
        return " ".join([*words, *([f"--dt {self.dt_s:g}"] if self.dt_s is not None else [])])
