"""Many runs of one scene, over every combination of some values of its keys: one table."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from harness import engines
from harness.accuracy.simulation import DEFAULT_ACCURACY_RAD, check_target
from harness.input.overrides import plain
from harness.model.errors import InputError, Mistake
from harness.model.run import NUMBERS
from harness.model.run_set import RunSet, run_set
from harness.model.scene import Scene, must_be_scene
from harness.questions.study.case_blocks import SweptRuns
from harness.questions.study.cases import BaseScene
from harness.questions.study.file import Value
from harness.runs.execute import execute
from harness.runs.task import RunRequest


def sweep(
    scene: Scene,
    values: Mapping[str, Iterable[object]],
    engine: str = "analytic",
    *,
    accuracy_rad: float | None = None,
    history: bool = False,
    store: Path | str | None = None,
    jobs: int = 1,
) -> RunSet:
    """Run a scene with every combination of some values of its keys, the last key innermost.

    >>> runs = harness.sweep(scene, {"motion.x.amplitude_g": [0.2, 0.3, 0.4]}, "analytic")
    >>> frame = runs.to_dataframe()

    The analytic model's runs for their outcomes are computed together, on all cores; others, and those that keep their `history`,
    as `harness.execute` does, whose `store` and `jobs` these are. Raises `InputError` for a key or value that makes no scene, an
    unknown engine, or a scene of resolved parts, whose keys are not known.
    """
    check_target(accuracy_rad, None)
    engines.load(engine)
    if not isinstance(values, Mapping) or not values:
        wanted = 'values by dotted key, such as {"motion.x.amplitude_g": [0.2, 0.3]}'
        raise InputError(Mistake("sweep", "values", wanted, repr(values)))
    axes = {key: _values(key, given) for key, given in values.items()}
    must_be_scene(scene, "sweep")
    if not scene.given:
        wanted = "a scene that was loaded, whose keys are known"
        raise InputError(Mistake("sweep", "scene", wanted, "one made of parts"))
    settings = [dict(zip(axes, point, strict=True)) for point in itertools.product(*axes.values())]
    asked = accuracy_rad or DEFAULT_ACCURACY_RAD
    single = all(isinstance(value, Value) for value in itertools.chain(*axes.values()))
    if engine == "analytic" and single and scene.initial.pose is None and not history and store is None:
        return _swept(scene, settings, asked)
    requests = [RunRequest(scene.replace(each), engine, asked, history=history, varied=each) for each in settings]
    return execute(requests, store, title=scene.title, jobs=jobs)


def _values(key: str, given: object) -> list[object]:
    found = plain(list(given) if isinstance(given, range) else given)
    if not isinstance(found, list) or not found:
        raise InputError(Mistake("sweep", key, "a list of values", repr(found)))
    return ["none" if value is None else value for value in found]


def _swept(scene: Scene, settings: Sequence[Mapping[str, Any]], asked_rad: float) -> RunSet:
    """The analytic model's runs, together."""
    runs = SweptRuns(BaseScene(scene.source, scene.given), asked_rad)
    for place, setting in enumerate(settings):
        runs.add(place, setting)
    columns = runs.columns()
    numbers = {name: columns[name] for name in (*NUMBERS, "steps", "impacts")}
    return run_set(scene.title, settings, ["analytic"] * len(settings), columns["outcome"].tolist(), numbers)
