"""From a study file to its cases: every combination of what varies, each a scene of its own."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray
from pydantic import JsonValue, ValidationError

from analytic.excitation import Excitation, SampledAcceleration, ZeroExcitation
from analytic.problem import Keywords, stated
from analytic.sweep import Body, body_of
from harness.input import overrides, tables
from harness.input import scene_file as load
from harness.input.mistakes import mistakes_of
from harness.input.motions import SceneMotion, prepare
from harness.input.motions.spec import Motion
from harness.input.tables import SceneFile
from harness.model import BaseExcitation, InputError, Mistake, Scene
from harness.model import two_block as twoblock
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
class BaseScene:
    """The base scene's content and where it stands (None: in no file)."""

    path: Path | None
    content: Mapping[str, JsonValue]
    _statues: load.Statues = field(default_factory=dict, compare=False, repr=False)

    def __reduce__(self) -> tuple[type[BaseScene], tuple[Path | None, Mapping[str, JsonValue]]]:
        """Sent to a worker as it was read, without the statues that were resolved here."""
        return BaseScene, (self.path, self.content)

    def with_keys(self, setting: Mapping[str, Value]) -> dict[str, JsonValue]:
        """The content with some keys set: `"keep"` leaves one, `"none"` removes it. Raises `InputError` for a key of no table."""
        content = _copied(self.content)
        for key, value in setting.items():
            if value != "keep":
                overrides.put(content, "study", key, value)
        return content

    def scene(self, setting: Mapping[str, Value]) -> Scene:
        """The base scene with some keys set. Raises `InputError` that names the keys."""
        content = self.with_keys(setting)
        said = ", ".join(f"{key} = {value}" for key, value in setting.items()) or "nothing set"
        where = f"{self.path or load.UNNAMED} with {said}"
        try:
            model = SceneFile.model_validate(content)
        except ValidationError as error:
            raise InputError(mistakes_of(error, SceneFile, where)) from error
        return load.resolve(model, self.path, content, self._statues)


def base_of(study: StudyFile, path: Path) -> BaseScene:
    """The study's base scene, checked. Raises `InputError`."""
    return base_of_scene(path.parent / study.scene)


def base_of_scene(path: Path) -> BaseScene:
    """A scene file as the base of cases, checked. Raises `InputError`."""
    _, content = tables.parse(tables.read(path), str(path))
    return BaseScene(path, content)


def _copied(table: Mapping[str, JsonValue]) -> dict[str, JsonValue]:
    """The table with tables of its own, the values in them shared: enough for setting keys."""
    return {key: _copied(value) if isinstance(value, dict) else value for key, value in table.items()}


def expand(study: StudyFile, base: BaseScene, numbers: Iterable[int] | None = None) -> Iterator[Case]:
    """The cases of a study in a fixed order: axes in the file's order, samples innermost, variants last; or some by number."""
    axes = [item.all_values for item in study.vary]
    # Each key has a stream of its own, so that adding one changes no other.
    streams = {item.key: np.random.default_rng([study.seed, *item.key.encode()]) for item in study.scatter}
    draws = {item.key: _drawn(item, base, streams[item.key], study.samples) for item in study.scatter}
    for number in range(study.points * len(study.variant)) if numbers is None else numbers:
        *indices, sample, of_variant = study.place(number)
        point = {item.key: values[i] for item, values, i in zip(study.vary, axes, indices, strict=True)}
        varied = {**point, **{key: float(values[sample]) for key, values in draws.items()}}
        variant = study.variant[of_variant]
        setting = {**varied, **_also(study.vary, varied), **variant.set}
        yield Case(number, variant.name, tuple(dict.fromkeys(variant.engines)), varied, setting, (*indices, sample))


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


def _drawn(item: Scatter, base: BaseScene, stream: np.random.Generator, samples: int) -> NDArray[np.float64]:
    if item.low is not None and item.high is not None:
        return stream.uniform(item.low, item.high, samples)
    centre: JsonValue = dict(base.content)
    for part in item.key.split("."):
        centre = centre.get(part) if isinstance(centre, Mapping) else None
    if isinstance(centre, bool) or not isinstance(centre, (int, float)) or centre == 0:
        advice = "low and high scatter a key that has none"
        raise InputError(
            Mistake(str(base.path), item.key, "a number other than 0 to scatter around", repr(centre), advice)
        )
    width = item.relative or 0.0
    if item.distribution == "normal":
        return centre * (1.0 + width * stream.standard_normal(samples))
    if item.distribution == "lognormal":
        sigma = math.sqrt(math.log1p(width**2))
        return centre * np.exp(sigma * stream.standard_normal(samples))
    return centre * (1.0 + width * stream.uniform(-1.0, 1.0, samples))


# What the analytic model needs of a study's cases: what many of them share is read and resolved once.

Setting = Mapping[str, Value]
SCALE: Final = "motion.scale"
OF_MOTION: Final = ("gravity_m_s2", "duration_s")
"""Keys outside `[motion]` that its formulas and filters take from the scene."""
MOST_REMEMBERED: Final = 4096
"""Bodies and motions that are remembered: a study's axes rarely have more, and draws would fill the memory."""
MOST_SAMPLES: Final = 4_000_000
"""Samples of records that are remembered, 64 MB of them."""

Own = tuple[tuple[str, Value], ...]


class StillScene(NamedTuple):
    """A scene without its motion, and as the model reads it."""

    scene: Scene
    body: Body


class CaseScenes:
    """The bodies and the motions of a study's cases, by what each sets; the same objects for the same settings.

    A scene's bodies do not depend on its motion, nor its motion on anything but `OF_MOTION`: the two are resolved apart. What is
    refused apart is resolved whole, so that the same mistake is told as of a single run.
    """

    def __init__(self, base: BaseScene, accuracy_rad: float) -> None:
        self._base, self._accuracy_rad = base, accuracy_rad
        uncertain = base.content.get("uncertainty")
        inputs = uncertain if isinstance(uncertain, Mapping) else {}
        still = {key: value for key, value in base.content.items() if key not in ("motion", "uncertainty")}
        of_bodies = {key: value for key, value in inputs.items() if not key.startswith("motion.")}
        self._without_motion = replace(base, content={**still, "uncertainty": of_bodies})
        self._uncertain = bool(inputs)
        self._stills: dict[Own, StillScene] = {}
        self._unscaled: dict[Own, BaseExcitation] = {}
        self._motions: dict[Own, BaseExcitation] = {}

    def still(self, setting: Setting) -> StillScene:
        """The case's scene without its motion. Raises `InputError` for a case that is no scene."""
        own = tuple((key, value) for key, value in setting.items() if not _of_motion(key))
        if own not in self._stills:
            _make_room(self._stills, MOST_REMEMBERED)
            try:
                scene = self._without_motion.scene(dict(own))
            except InputError:
                self._base.scene(setting)
                raise
            given = cast(Keywords, twoblock.keywords(scene))
            problem, _ = stated(twoblock.block_of(scene), ZeroExcitation(), None, given)
            self._stills[own] = StillScene(scene, body_of(problem, self._accuracy_rad))
        return self._stills[own]

    def motion(self, setting: Setting, still: Scene) -> BaseExcitation:
        """The case's motion in its scene without one. Raises `InputError` for a case that is no scene."""
        own = tuple((key, value) for key, value in setting.items() if _of_motion(key) or key in OF_MOTION)
        if own not in self._motions:
            try:
                made = self._made(own, still)
            except (InputError, ValidationError):
                self._base.scene(setting)
                raise
            if self._uncertain:
                self._base.scene(setting)
            samples = sum(item.t_s.size for item in (made.x, made.y, made.z) if isinstance(item, SampledAcceleration))
            _make_room(self._motions, MOST_SAMPLES // samples if samples else MOST_REMEMBERED)
            self._motions[own] = made
        return self._motions[own]

    def _made(self, own: Own, still: Scene) -> BaseExcitation:
        """The motion of these keys; cases that only scale one share it."""
        table = Motion.model_validate(self._base.with_keys(dict(own)).get("motion", {}))
        name = tuple(item for item in own if item[0] != SCALE)
        if name not in self._unscaled:
            _make_room(self._unscaled, MOST_REMEMBERED)
            path, of_scene = self._base.path or load.UNNAMED, (still.duration_s, still.gravity_m_s2)
            axes: dict[str, Excitation] = dict.fromkeys(("x", "y", "z"), ZeroExcitation())
            for axis in axes:
                component = getattr(table, axis)
                if component is not None:
                    motion = SceneMotion(component, path.parent, str(path), f"motion.{axis}", *of_scene)
                    axes[axis] = prepare(motion).excitation
            self._unscaled[name] = BaseExcitation(**axes)
        return self._unscaled[name].scaled(table.scale)


def _of_motion(key: str) -> bool:
    return key == "motion" or key.startswith("motion.")


def _make_room(memory: dict[Any, Any], most: int) -> None:
    if len(memory) >= max(most, 1):
        memory.clear()
