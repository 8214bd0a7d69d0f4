"""Many runs of one scene, over every combination of some values of its keys: one table."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from harness import engines
from harness.accuracy.simulation import DEFAULT_ACCURACY_RAD, check_target, simulate
from harness.input.overrides import plain
from harness.model.errors import InputError, Mistake
from harness.model.history import Outcome
from harness.model.options import RunOptions
from harness.model.run import NUMBERS, Run
from harness.model.scene import Scene
from harness.model.shown import Shown, new_axes
from harness.studies.case_blocks import SweptRuns
from harness.studies.cases import Base
from harness.studies.file import Value

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Column = NDArray[Any]


@dataclass(frozen=True, eq=False, repr=False)
class RunSet(Shown):
    """Runs of one scene by one engine: `table` holds a column for each key of `varied`, then what the runs answered."""

    title: str
    engine: str
    varied: Mapping[str, Sequence[object]]
    table: Mapping[str, Column]

    def __len__(self) -> int:
        return len(self.table["outcome"])

    def facts(self) -> dict[str, str]:
        """Title, what varies, by which engine, how many runs overturn."""
        axes = ", ".join(f"{key} ({len(values)})" for key, values in self.varied.items())
        falls = f"overturns in {int(self.table['overturned'].sum())} of {len(self)}"
        return {"title": self.title, "varied": axes, self.engine: falls}

    def columns(self) -> dict[str, Column]:
        """One row for each run: the values set, outcome, peaks, times, uncertainties; a number that there is not is NaN."""
        return {"run": np.arange(len(self)), **self.table}

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the largest rotation over the only number that varies, or outcomes over the first two.

        Raises `InputError` where no number varies.
        """
        keys = [key for key in self.varied if self.table[key].dtype.kind in "fi"][:2]
        if not keys:
            raise InputError(Mistake("sweep", "plot", "a number that varies", ", ".join(self.varied)))
        ax, falls = new_axes(ax), self.table["overturned"]
        if len(keys) == 1:
            ax.plot(self.table[keys[0]], self.table["peak_theta_rad"], marker="o", label=self.engine)
        else:
            for chosen, label, marker in ((~falls, "does not overturn", "o"), (falls, "overturns", "x")):
                ax.scatter(self.table[keys[0]][chosen], self.table[keys[1]][chosen], marker=marker, label=label)
        ax.set(xlabel=keys[0], ylabel=keys[1] if len(keys) > 1 else "largest rotation [rad]", title=self.title)
        return ax


def sweep(
    scene: Scene,
    values: Mapping[str, Iterable[object]],
    engine: str = "analytic",
    *,
    accuracy_rad: float | None = None,
) -> RunSet:
    """Run a scene for its outcome with every combination of some values of its keys, the last key innermost.

    >>> runs = harness.sweep(scene, {"motion.x.amplitude_g": [0.2, 0.3, 0.4]}, "analytic")
    >>> frame = runs.to_dataframe()

    The analytic model's runs are computed together, on all cores. Raises `InputError` for a key or value that makes no scene, an
    unknown engine, or a scene of resolved parts, whose keys are not known.
    """
    check_target(accuracy_rad, None)
    engines.load(engine)
    axes = {key: _values(key, given) for key, given in _mapping(values).items()}
    if not isinstance(scene, Scene):
        raise InputError(Mistake("sweep", "scene", "a scene: harness.load_scene(path)", type(scene).__name__))
    if not scene.given:
        wanted = "a scene that was loaded, whose keys are known"
        raise InputError(Mistake("sweep", "scene", wanted, "one made of parts"))
    settings = [dict(zip(axes, point, strict=True)) for point in itertools.product(*axes.values())]
    asked = accuracy_rad or DEFAULT_ACCURACY_RAD
    single = all(isinstance(value, Value) for value in itertools.chain(*axes.values()))
    swept = engine == "analytic" and single and scene.initial.pose is None
    answers = _swept(scene, settings, asked) if swept else _one_by_one(scene, settings, engine, asked)
    outcomes = answers.pop("outcome")
    falls = np.array([Outcome(each).overturned for each in outcomes.tolist()])
    varied = {key: _column([setting[key] for setting in settings]) for key in axes}
    name = _column([engine] * len(settings))
    return RunSet(
        scene.title, engine, axes, {**varied, "engine": name, "outcome": outcomes, "overturned": falls, **answers}
    )


def _mapping(values: object) -> Mapping[str, Iterable[object]]:
    if not isinstance(values, Mapping) or not values:
        wanted = 'values by dotted key, such as {"motion.x.amplitude_g": [0.2, 0.3]}'
        raise InputError(Mistake("sweep", "values", wanted, repr(values)))
    return values


def _values(key: str, given: object) -> list[object]:
    found = plain(list(given) if isinstance(given, range) else given)
    if not isinstance(found, list) or not found:
        raise InputError(Mistake("sweep", key, "a list of values", repr(found)))
    return ["none" if value is None else value for value in found]


def _column(values: Sequence[object]) -> Column:
    if all(type(value) in (int, float) for value in values):
        return np.array(values)
    column = np.empty(len(values), dtype=object)
    column[:] = values
    return column


def _swept(scene: Scene, settings: Sequence[Mapping[str, Any]], asked_rad: float) -> dict[str, Column]:
    """The analytic model's runs, together."""
    runs = SweptRuns(Base(scene.source, scene.given), asked_rad)
    for place, setting in enumerate(settings):
        runs.add(place, setting)
    columns = runs.columns()
    return {name: columns[name] for name in ("outcome", *NUMBERS, "steps", "impacts")}


def _one_by_one(
    scene: Scene, settings: Sequence[Mapping[str, object]], engine: str, asked_rad: float
) -> dict[str, Column]:
    """Any engine's runs, one after the other."""
    options = RunOptions(history=False)
    runs = [simulate(scene.replace(setting), engine, accuracy_rad=asked_rad, options=options) for setting in settings]
    numbers = {name: np.array([getattr(run, name) for run in runs], dtype=np.float64) for name in NUMBERS}
    numbers["peak_theta_rad"] = np.abs(numbers["peak_theta_rad"])
    outcomes = _column([run.outcome.value for run in runs])
    steps, impacts = (np.array([of(run) for run in runs]) for of in (_steps, _impacts))
    return {"outcome": outcomes, **numbers, "steps": steps, "impacts": impacts}


def _steps(run: Run) -> int:
    return run.steps


def _impacts(run: Run) -> int:
    return len(run.impact_times_s) or int(run.work.get("impacts", 0))
