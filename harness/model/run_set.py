"""Runs as one table: what varied and what each run answered, by one or several engines."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from harness.model.errors import require, required
from harness.model.finding import Axes, Shown, library, new_axes
from harness.model.history import History, Outcome
from harness.model.run import NUMBERS

if TYPE_CHECKING:
    import pyarrow

Column = NDArray[Any]
K = TypeVar("K")
V = TypeVar("V")


def grouped(pairs: Iterable[tuple[K, V]]) -> dict[K, list[V]]:
    """The values of each key, both in the order in which they come."""
    groups: dict[K, list[V]] = {}
    for key, value in pairs:
        groups.setdefault(key, []).append(value)
    return groups


def column_of(values: Sequence[object]) -> Column:
    """Values as a column: numbers as numbers, anything else as it is."""
    if all(type(value) in (int, float) for value in values):
        return np.array(values)
    column = np.empty(len(values), dtype=object)
    column[:] = values
    return column


def answered(table: Mapping[str, Column]) -> dict[str, Column]:
    """The columns with no number where a run failed: it has none, whatever its record holds in their place."""
    failed = np.array([each is not None and Outcome(each).failed for each in table["outcome"].tolist()], dtype=bool)
    nothing: dict[str, Any] = {
        name: None if table[name].dtype == object else np.nan for name in NUMBERS if name in table
    }
    return {name: np.where(failed, nothing[name], each) if name in nothing else each for name, each in table.items()}


@dataclass(frozen=True, eq=False, repr=False)
class RunSet(Shown):
    """Runs as a table of columns of one length: the keys of `varied`, `engine`, `outcome` (None: not run), and its numbers.

    >>> runs = harness.sweep(scene, {"motion.x.amplitude_g": [0.2, 0.3]})
    >>> runs.where({"outcome": "stands"}).to_dataframe()

    `histories` has one for each run where they were asked for (None: a run that failed), and is empty where not.
    """

    title: str
    varied: Sequence[str]
    table: Mapping[str, Column]
    histories: Sequence[History | None] = ()

    def __len__(self) -> int:
        return len(self.table["engine"])

    @property
    def engines(self) -> list[str]:
        """Who answered, in their order."""
        return list(dict.fromkeys(self.table["engine"].tolist()))

    def where(self, chosen: Mapping[str, object]) -> RunSet:
        """The runs whose columns have these values.

        >>> runs.where({"engine": "analytic", "motion.x.amplitude_g": 0.3})
        """
        self._check(*chosen)
        kept = np.logical_and.reduce([np.ones(len(self), bool), *(self.table[key] == chosen[key] for key in chosen)])
        return self._at(np.flatnonzero(kept).tolist())

    def pivot(self, down: str, across: str, value: str = "outcome") -> tuple[Column, Column, Column]:
        """The values of two columns, and a third column arranged by them, (n, m); None where there is no run.

        >>> amplitudes, frequencies, outcomes = runs.pivot("motion.x.amplitude_g", "motion.x.frequency_hz")
        """
        self._check(down, across, value)
        rows, columns = self._distinct(down), self._distinct(across)
        values = np.full((len(rows), len(columns)), None, dtype=object)
        i, j = (
            [list(own).index(repr(each)) for each in self.table[key].tolist()]
            for own, key in ((rows, down), (columns, across))
        )
        values[i, j] = self.table[value]
        return column_of([*rows.values()]), column_of([*columns.values()]), values

    def pairs(self, reference: str = "analytic") -> dict[str, tuple[RunSet, RunSet]]:
        """Of each other engine the cases that it and the reference answered: its runs and the reference's, case by case.

        >>> own, model = runs.pairs()["pymunk"]
        """
        cases = [repr(case) for case in zip(*(self.table[key].tolist() for key in self.varied), strict=True)]
        cases = cases or [""] * len(self)
        place: dict[str, dict[str, int]] = {name: {} for name in self.engines}
        for k, (engine, outcome) in enumerate(zip(self.table["engine"], self.table["outcome"], strict=True)):
            if outcome is not None:
                place[engine][cases[k]] = k
        known = place.pop(reference, {})
        both = {name: [(k, known[case]) for case, k in mine.items() if case in known] for name, mine in place.items()}
        return {name: (self._at([a for a, _ in some]), self._at([b for _, b in some])) for name, some in both.items()}

    def history(self, place: int) -> History:
        """The history of one run. Raises `InputError` where none was kept.

        >>> runs = harness.sweep(scene, {"motion.x.amplitude_g": [0.2, 0.3]}, "pymunk", history=True)
        >>> runs.history(0).theta_rad
        """
        kept = self.histories[place] if self.histories else None
        return required(kept, self.title, "a run whose history was asked for", "none", key=f"history of run {place}")

    def to_arrow(self) -> pyarrow.Table:
        """Its table as Arrow's. Raises `InputError` without pyarrow (the extra [parquet])."""
        return library("pyarrow", "to_arrow", "parquet").table({name: list(each) for name, each in self.table.items()})

    def facts(self) -> dict[str, str]:
        """Title, what varies, how many runs, in how many of them the statue overturns, by engine."""
        axes = [f"{key} ({len(self._distinct(key))})" for key in self.varied]
        ran, falls = self.table["outcome"] != None, self._falls()  # noqa: E711 - by element
        facts = {"title": self.title, "varied": ", ".join(axes) or "lists of cases", "runs": str(int(ran.sum()))}
        for name in self.engines:
            own = ran & (self.table["engine"] == name)
            facts[name] = f"overturns in {int(falls[own].sum())} of {int(own.sum())}"
        return facts

    def columns(self) -> dict[str, Column]:
        """One row for each run: the values set, outcome, peaks, times, uncertainties."""
        return {"run": np.arange(len(self)), **self.table}

    def plot(self, ax: Axes | None = None, engine: str | None = None) -> Axes:
        """Draw the largest rotation over the only number that varies, by all engines, or outcomes over the first two, by one.

        `engine`: by default the first. Raises `InputError` where no number varies.
        """
        ax, keys, falls = new_axes(ax), self._axes(), self._falls()
        ran = self.table["outcome"] != None  # noqa: E711 - by element
        x = self.table[keys[0]]
        if len(keys) == 1:
            for name in self.engines:
                own = np.flatnonzero(ran & (self.table["engine"] == name))
                own = own[np.argsort(x[own], kind="stable")]
                ax.plot(x[own], [abs(value) for value in self.table["peak_theta_rad"][own]], marker="o", label=name)
        chosen = engine or self.engines[0]
        for some, label, marker in ((~falls, "does not overturn", "o"), (falls, "overturns", "x")) if keys[1:] else ():
            own = ran & some & (self.table["engine"] == chosen)
            if own.any():
                ax.scatter(x[own], self.table[keys[1]][own], marker=marker, label=f"{chosen} {label}")
        ax.set(xlabel=keys[0], ylabel=keys[1] if len(keys) > 1 else "largest rotation [rad]", title=self.title)
        return ax

    def _at(self, places: Sequence[int]) -> RunSet:
        table = {name: column[np.array(places, int)] for name, column in self.table.items()}
        return replace(self, table=table, histories=[self.histories[k] for k in places] if self.histories else ())

    def _falls(self) -> NDArray[np.bool_]:
        return np.array([each is not None and Outcome(each).overturned for each in self.table["outcome"]], dtype=bool)

    def _check(self, *names: str) -> None:
        for name in names:
            require(name in self.table, self.title, f"a column: {', '.join(self.table)}", "none of this name", key=name)

    def _distinct(self, key: str) -> dict[str, Any]:
        """The values of a column, each once: numbers by size, anything else in its order; a list is a value, too."""
        values = {repr(each): each for each in self.table[key].tolist()}
        numbers = all(type(each) in (int, float) for each in values.values())
        return dict(sorted(values.items(), key=lambda item: item[1])) if numbers else values

    def _axes(self) -> list[str]:
        """The keys of numbers that vary, at most two."""
        columns = {key: [*self._distinct(key).values()] for key in self.varied}
        numbers = [key for key, some in columns.items() if len(some) > 1 and all(type(v) in (int, float) for v in some)]
        require(numbers, self.title, "a number that varies", ", ".join(columns) or "nothing", key="vary")
        return numbers[:2]


def run_set(
    title: str,
    varied: Sequence[Mapping[str, object]],
    engines: Sequence[str],
    outcomes: Sequence[str],
    numbers: Mapping[str, Column],
    histories: Sequence[History | None] = (),
) -> RunSet:
    """Runs as a table: what varied in each, who answered, its outcome, whether the statue overturned, and `numbers` by column."""
    keys = list(dict.fromkeys(key for each in varied for key in each))
    table: dict[str, Column] = {key: column_of([each.get(key) for each in varied]) for key in keys}
    table |= {
        "engine": column_of(engines),
        "outcome": column_of(outcomes),
        "overturned": np.array([Outcome(end).overturned for end in outcomes]),
        **numbers,
    }
    return RunSet(title, keys, answered(table), histories)
