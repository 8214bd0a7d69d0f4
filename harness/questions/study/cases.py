"""From a study file to its cases: every combination of what varies, each a scene of its own."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from pydantic import JsonValue, ValidationError

from harness.input import overrides, tables
from harness.input import scene_file as load
from harness.input.mistakes import mistakes_of
from harness.input.tables import SceneFile
from harness.model.errors import InputError, Mistake
from harness.model.scene import Scene
from harness.questions.study.file import Scatter, StudyFile, Value, Vary


@dataclass(frozen=True)
class Case:
    """One case: its number in the study, the variant that it belongs to, and the keys that it sets."""

    number: int
    variant: str
    engines: tuple[str, ...]
    varied: Mapping[str, Value]
    """What varies (without the variant's own keys), as it stands in tables."""
    setting: Mapping[str, Value]
    """All keys set in the base scene, the variant's included."""
    position: tuple[int, ...]
    """Index on each varied axis (for neighbours on the grid), the sample's number last."""


@dataclass(frozen=True)
class Base:
    """The base scene's content and where it stands (None: in no file)."""

    path: Path | None
    content: Mapping[str, JsonValue]
    _statues: load.Statues = field(default_factory=dict, compare=False, repr=False)

    def __reduce__(self) -> tuple[type[Base], tuple[Path | None, Mapping[str, JsonValue]]]:
        """Sent to a worker as it was read, without the statues that were resolved here."""
        return Base, (self.path, self.content)

    def scene(self, setting: Mapping[str, Value]) -> Scene:
        """The base scene with some keys set. Raises `InputError` that names the keys."""
        content = _copied(self.content)
        for key, value in setting.items():
            put(content, key, value)
        said = ", ".join(f"{key} = {value}" for key, value in setting.items()) or "nothing set"
        where = f"{self.path or load.UNNAMED} with {said}"
        try:
            model = SceneFile.model_validate(content)
        except ValidationError as error:
            raise InputError(mistakes_of(error, SceneFile, where)) from error
        return load.resolve(model, self.path, content, self._statues)


def base_of(study: StudyFile, path: Path) -> Base:
    """The study's base scene, checked. Raises `InputError`."""
    return base_of_scene(path.parent / study.scene)


def base_of_scene(path: Path) -> Base:
    """A scene file as the base of cases, checked. Raises `InputError`."""
    _, content = tables.parse(tables.read(path), str(path))
    return Base(path, content)


def _copied(table: Mapping[str, JsonValue]) -> dict[str, JsonValue]:
    """The table with tables of its own, the values in them shared: enough for setting keys."""
    return {key: _copied(value) if isinstance(value, dict) else value for key, value in table.items()}


def put(content: dict[str, JsonValue], key: str, value: Value) -> None:
    """Set one dotted key; `"keep"` leaves it, `"none"` removes it. Raises `InputError` where the path is no table."""
    if value != "keep":
        overrides.put(content, "study", key, value)


def expand(study: StudyFile, base: Base, numbers: range | None = None) -> Iterator[Case]:
    """The cases of a study in a fixed order: axes in the file's order, samples innermost, variants last; or some by number."""
    axes = [_values(item) for item in study.vary]
    # Each key has a stream of its own, so that adding one changes no other.
    streams = {item.key: np.random.default_rng([study.seed, *item.key.encode()]) for item in study.scatter}
    draws = {item.key: _drawn(item, base, streams[item.key], study.samples) for item in study.scatter}
    sizes = [*study.sizes, len(study.variant)]
    for number in range(math.prod(sizes)) if numbers is None else numbers:
        *indices, sample, of_variant = (int(index) for index in np.unravel_index(number, sizes))
        point = {item.key: values[i] for item, values, i in zip(study.vary, axes, indices, strict=True)}
        varied = {**point, **{key: float(values[sample]) for key, values in draws.items()}}
        variant = study.variant[of_variant]
        setting = {**varied, **_also(study.vary, varied), **variant.set}
        yield Case(number, variant.name, tuple(variant.engines), varied, setting, (*indices, sample))


def _also(axes: Sequence[Vary], varied: Mapping[str, Value]) -> dict[str, float]:
    """The further keys that follow a varied one. Raises `InputError` where that one is not a number."""
    further = {}
    for item in axes:
        for key, factor in item.also.items():
            value = varied[item.key]
            if isinstance(value, bool) or not isinstance(value, (int, float)):
                raise InputError(Mistake("study", f"vary {item.key}.also", "numbers to multiply", repr(value)))
            further[key] = factor * value
    return further


def _values(item: Vary) -> Sequence[Value]:
    if item.values is not None:
        return item.values
    if item.start is None or item.stop is None or item.count is None:
        raise InputError(Mistake("study", f"vary {item.key}", "start, stop and count", "not all of them"))
    space = np.geomspace if item.spacing == "log" else np.linspace
    # Twelve digits: a grid's value reads the same in a table as in the store.
    return [float(f"{value:.12g}") for value in space(item.start, item.stop, item.count)]


def _drawn(item: Scatter, base: Base, stream: np.random.Generator, samples: int) -> NDArray[np.float64]:
    if item.low is not None and item.high is not None:
        return stream.uniform(item.low, item.high, samples)
    centre: JsonValue = dict(base.content)
    for part in item.key.split("."):
        centre = centre.get(part) if isinstance(centre, Mapping) else None
    if isinstance(centre, bool) or not isinstance(centre, (int, float)):
        raise InputError(Mistake(str(base.path), item.key, "a number to scatter around", repr(centre)))
    width = item.relative or 0.0
    if item.distribution == "normal":
        return centre * (1.0 + width * stream.standard_normal(samples))
    if item.distribution == "lognormal":
        sigma = math.sqrt(math.log1p(width**2))
        return centre * np.exp(sigma * stream.standard_normal(samples))
    return centre * (1.0 + width * stream.uniform(-1.0, 1.0, samples))
