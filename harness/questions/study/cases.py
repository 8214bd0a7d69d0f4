"""From a study file to its cases, every combination of what varies, and which of them an engine is asked."""

import itertools
import math
import random
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, Final, Literal, NamedTuple, Self, cast

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, JsonValue, ValidationError, model_validator

from analytic.excitation import SampledAcceleration, ZeroExcitation
from analytic.problem import Keywords, stated
from analytic.sweep import Body, body_of
from harness.input import scene_file, tables
from harness.input.mistakes import UserTable, agree, mistakes_of
from harness.input.motions import SceneMotion, prepare
from harness.input.motions.spec import Motion
from harness.model import BaseExcitation, InputError, Mistake, Scene, block_of, grouped, keywords, require
from harness.records.study import RecheckRecord, StudyRow

# The study file: a base scene, what varies, which engines answer, validated strictly.

Value = float | int | str | bool
EngineName = Literal["analytic", "pymunk", "pybullet", "spatial", "pymunk:plain", "pybullet:plain"]
Name = Annotated[str, Field(min_length=1)]
COMPARED: Final[Mapping[str, tuple[str, ...]]] = {
    "pedestal": ("motion.x.frequency_hz",),
    "planes": ("statue.mesh.azimuth_deg",),
    "paper": ("motion.x.frequency_hz", "motion.x.amplitude_g", "contact.restitution"),
}
"""The keys over whose numbers a set of claims compares runs: without them none can be judged."""


class Vary(UserTable):
    """`[[vary]]`: one key of the scene and its values: a list, or a grid from … to … of `count` values.

    The values `"keep"` and `"none"` leave the key as the scene has it and remove it (`pedestal = "none"`). `also` sets further
    keys to the value times a factor (static friction that keeps its proportion to the kinetic one).
    """

    key: Name
    values: list[Value] | None = Field(default=None, min_length=1)
    start: float | None = None
    stop: float | None = None
    count: Annotated[int, Field(ge=1, le=1_000_000)] | None = None
    spacing: Literal["linear", "log"] = "linear"
    also: dict[str, Annotated[float, Field(gt=0.0)]] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        lacking = [item is None for item in (self.start, self.stop, self.count)]
        listed = self.values is not None
        logarithmic, ends = self.spacing == "log", min(self.start or 0.0, self.stop or 0.0)
        agree(
            (listed == all(lacking), "values", "either values, or start, stop and count", "both or neither"),
            (listed or not any(lacking), "count", "start, stop and count together", "not all three"),
            (not listed or "spacing" not in self.model_fields_set, "spacing", "a grid beside it", "values"),
            (
                not logarithmic or ends > 0.0,
                "spacing",
                "positive start and stop for a logarithmic grid",
                "no such grid",
            ),
        )
        return self

    @property
    def all_values(self) -> Sequence[Value]:
        """The values of the list or the grid."""
        if self.values is not None:
            return self.values
        space = np.geomspace if self.spacing == "log" else np.linspace
        # Twelve digits: a grid's value reads the same in a table as in the store.
        return [float(f"{value:.12g}") for value in space(self.start or 0.0, self.stop or 0.0, self.count or 1)]


class Scatter(UserTable):
    """`[[scatter]]`: one key drawn at random around its value in the scene (`normal` and `uniform` relative, or absolute)."""

    key: Name
    distribution: Literal["normal", "lognormal", "uniform"]
    relative: Annotated[float, Field(gt=0.0, lt=1.0)] | None = None
    low: float | None = None
    high: float | None = None

    @model_validator(mode="after")
    def _bounds(self) -> Self:
        bounds = [each for each in (self.low, self.high) if each is not None]
        low, high = bounds if len(bounds) == 2 else (0.0, 1.0)
        relative, uniform = self.relative is not None, self.distribution == "uniform"
        agree(
            (len(bounds) == (0 if relative else 2), "relative", "either relative, or low and high", "both or neither"),
            (not bounds or uniform, "distribution", "'uniform' with low and high", repr(self.distribution)),
            (low < high, "low", f"less than high = {high:g}", f"{low:g}"),
        )
        return self


class StudyVariant(UserTable):
    """`[[variant]]`: keys set for all cases of this variant, and the engines that answer it."""

    name: Name
    engines: list[EngineName] = Field(min_length=1)
    set: dict[str, Value] = Field(default_factory=dict)


class Ask(UserTable):
    """`[ask]`: which cases go to the contact engines, after the analytic model has run them all.

    `all`; `boundary`: those whose analytic outcome is near a change (a neighbour on the grid differs, or the peak lies within
    `margin` of the balance point), and of the rest a random `audit` share; `adaptive`: a map over the two axes given as grids,
    refined for each engine where its own outcome changes, with the same rechecks.
    """

    cases: Literal["all", "boundary", "adaptive"] = "all"
    margin: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.25
    audit: Annotated[float, Field(ge=0.0, le=1.0)] = 0.1
    histories: bool = False

    @model_validator(mode="after")
    def _used(self) -> Self:
        for key, asking in (("margin", ("boundary",)), ("audit", ("boundary", "adaptive"))):
            used = key not in self.model_fields_set or self.cases in asking
            agree((used, key, f"cases = {' or '.join(asking)} beside it", repr(self.cases)))
        return self


class StudyFile(UserTable):
    """A whole study file."""

    title: Name
    scene: Name
    seed: Annotated[int, Field(ge=0)] = 0
    samples: Annotated[int, Field(ge=1, le=1_000_000)] = 1
    vary: list[Vary] = Field(default_factory=list)
    scatter: list[Scatter] = Field(default_factory=list)
    variant: list[StudyVariant] = Field(min_length=1)
    accuracy: dict[EngineName, Annotated[float, Field(ge=1e-9, le=0.1)]] = Field(default_factory=dict)
    ask: Ask = Ask()
    claims: Literal["paper", "pedestal", "planes"] | None = None

    @property
    def asked_rad(self) -> dict[str, float]:
        """The accuracies that are asked, by engine."""
        return {str(name): value for name, value in self.accuracy.items()}

    @property
    def sizes(self) -> list[int]:
        """Values of each axis, samples last."""
        return [*(len(item.values) if item.values else item.count or 1 for item in self.vary), self.samples]

    @property
    def points(self) -> int:
        """Combinations of what varies, samples included."""
        return math.prod(self.sizes)

    def place(self, number: int) -> tuple[int, ...]:
        """Where a case stands on each axis; its sample and its variant last."""
        return tuple(int(index) for index in np.unravel_index(number, [*self.sizes, len(self.variant)]))

    @property
    def runs(self) -> int:
        """Runs of all variants by all their engines, were each asked every case."""
        return self.points * sum(len(set(variant.engines)) for variant in self.variant)

    @model_validator(mode="after")
    def _whole(self) -> Self:
        names = [variant.name for variant in self.variant]
        keys = [item.key for item in self.vary] + [item.key for item in self.scatter]
        grids = [item.key for item in self.vary if item.values is None]
        by_words = {
            item.key for item in self.vary if not all(type(value) in (int, float) for value in item.values or ())
        }
        compared = COMPARED.get(self.claims or "", ())
        absent = next((key for key in compared if key not in keys or key in by_words), "")
        sampled, scattered = self.samples > 1, bool(self.scatter)
        agree(
            (len(set(names)) == len(names), "variant", "variants of different names", ", ".join(names)),
            (len(set(keys)) == len(keys), "vary", "each key varied once", ", ".join(keys)),
            (
                sampled == scattered,
                "samples",
                "more than one sample exactly where something is scattered",
                str(self.samples),
            ),
            (
                self.ask.cases != "adaptive" or (len(grids) == 2 and not sampled),
                "ask.cases",
                "exactly two grids and no samples for an adaptive map",
                f"{len(grids)} grids",
            ),
            (not absent, "claims", f"{absent} varied over numbers, which these claims compare", "not so here"),
        )
        return self


def load_study(path: Path | str) -> StudyFile:
    """Read and validate a study file. Raises `InputError` with every mistake."""
    return tables.read_model(StudyFile, Path(path))


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
    _statues: scene_file.Statues = field(default_factory=dict, compare=False, repr=False)

    def __reduce__(self) -> tuple[object, ...]:
        """Sent to a worker as it was read, without the statues that were resolved here."""
        return BaseScene, (self.path, self.content)

    def with_keys(self, setting: Mapping[str, Value]) -> dict[str, JsonValue]:
        """The content with some keys set: `"keep"` leaves one, `"none"` removes it. Raises `InputError` for a key of no table."""
        content = _copied(self.content)
        for key, value in setting.items():
            if value != "keep":
                tables.put(content, "study", key, value)
        return content

    def scene(self, setting: Mapping[str, Value]) -> Scene:
        """The base scene with some keys set. Raises `InputError` that names the keys."""
        content = self.with_keys(setting)
        said = ", ".join(f"{key} = {value}" for key, value in setting.items()) or "nothing set"
        where = f"{self.path or scene_file.UNNAMED} with {said}"
        try:
            model = tables.SceneFile.model_validate(content)
        except ValidationError as error:
            raise InputError(mistakes_of(error, tables.SceneFile, where)) from error
        return scene_file.resolve(model, self.path, content, self._statues)


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
    draws = {
        item.key: _drawn(item, base, np.random.default_rng([study.seed, *item.key.encode()]), study.samples)
        for item in study.scatter
    }
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
            numeric = type(value) in (int, float)
            require(numeric, "study", "numbers to multiply", repr(value), key=f"vary {item.key}.also")
            further[key] = factor * float(value)
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

    A scene's bodies do not depend on its motion, nor its motion on anything but `OF_MOTION`: the two are resolved apart.
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
            scene = self._without_motion.scene(dict(own))
            given = cast(Keywords, keywords(scene))
            problem, _ = stated(block_of(scene), ZeroExcitation(), None, given)
            self._stills[own] = StillScene(scene, body_of(problem, self._accuracy_rad))
        return self._stills[own]

    def motion(self, setting: Setting, still: Scene) -> BaseExcitation:
        """The case's motion in its scene without one. Raises `InputError` for a case that is no scene."""
        own = tuple((key, value) for key, value in setting.items() if _of_motion(key) or key in OF_MOTION)
        if own not in self._motions:
            made = self._made(own, still)
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
            path, of_scene = self._base.path or scene_file.UNNAMED, (still.duration_s, still.gravity_m_s2)
            given = {axis: component for axis in "xyz" if (component := getattr(table, axis)) is not None}
            axes = {
                axis: prepare(SceneMotion(component, path.parent, str(path), f"motion.{axis}", *of_scene)).excitation
                for axis, component in given.items()
            }
            self._unscaled[name] = BaseExcitation(**axes)
        return self._unscaled[name].scaled(table.scale)


def _of_motion(key: str) -> bool:
    return key == "motion" or key.startswith("motion.")


def _make_room(memory: dict[Any, Any], most: int) -> None:
    if len(memory) >= max(most, 1):
        memory.clear()


# Which cases an engine is asked (all, those near the boundary of the outcome, or a map refined where it changes), and what
# random rechecks say of those that were left out.

Place = tuple[int, ...]
Cell = tuple[tuple[int, int], tuple[int, int]]
"""Lowest and highest index along both axes of a map."""

REFERENCE: Final = "analytic"
"""The model that runs every case first; it costs next to nothing."""
EVERY: Final = "every_case"
NEAR: Final = "near_change"
MARGIN: Final = "near_balance"
RECHECK: Final = "random_recheck"
COARSE: Final = "coarse_grid"
REFINED: Final = "beside_change"
NOT_SENT: Final = "not_sent"
SAME_CELL: Final = "same_cell"
"""Why a case is asked or not, as the catalogues of messages name it."""
COARSEST: Final = 8
"""Stride of the map's first grid: every eighth point along each axis."""


@dataclass(frozen=True)
class PlaceAnswer:
    """What one run said: its outcome and its peak as a share of the slenderness on that side."""

    outcome: str
    share: float


def map_axes(study: StudyFile) -> tuple[int, int]:
    """The two axes given as grids, which make the map (the study file's own check: there are exactly two)."""
    first, second = (axis for axis, item in enumerate(study.vary) if item.values is None)
    return first, second


def near_boundary(known: Mapping[Place, PlaceAnswer], margin: float, share: float, seed: int) -> dict[Place, str]:
    """Places whose neighbour's outcome differs or whose peak is near the balance point; of the rest a random share."""
    reasons = {}
    stream = random.Random(seed)
    for place in sorted(known):
        draw = stream.random()
        around = (known[other] for other in neighbours(place) if other in known)
        if any(other.outcome != known[place].outcome for other in around):
            reasons[place] = NEAR
        elif abs(known[place].share - 1.0) <= margin:
            reasons[place] = MARGIN
        elif draw < share:
            reasons[place] = RECHECK
    return reasons


def rechecked(places: Iterable[Place], share: float, seed: int) -> dict[Place, str]:
    """A random share of all places, the same for every engine and every call."""
    stream = random.Random(seed)
    return {place: RECHECK for place in sorted(set(places)) if stream.random() < share}


def neighbours(place: Place) -> list[Place]:
    """The next places along each axis."""
    return [(*place[:axis], place[axis] + step, *place[axis + 1 :]) for axis in range(len(place)) for step in (-1, 1)]


def refined(
    places: Sequence[Place],
    known: Mapping[Place, str],
    axes: tuple[int, int],
    strides: tuple[int, int] = (COARSEST, COARSEST),
) -> dict[Place, str]:
    """The map's places to compute: a coarse grid first, then the halves of every cell whose known corners differ."""
    reasons: dict[Place, str] = {}
    for _, corners, reason in _cells(places, known, axes, strides):
        for corner in corners:
            reasons.setdefault(corner, reason)
    return reasons


def filled(
    places: Sequence[Place],
    known: Mapping[Place, str],
    axes: tuple[int, int],
    strides: tuple[int, int] = (COARSEST, COARSEST),
) -> dict[Place, str]:
    """The outcome of a refined map's places: their own where computed, else that of their cell, whose corners agree."""
    outcome = dict(known)
    for cell, corners, _ in _cells(places, known, axes, strides):
        said = {known.get(corner) for corner in corners}
        if len(said) == 1 and (agreed := said.pop()) is not None:
            for pair in itertools.product(*(range(low, high + 1) for low, high in cell)):
                outcome.setdefault(_placed(corners[0], axes, pair), agreed)
    return outcome


def _cells(
    places: Sequence[Place], known: Mapping[Place, str], axes: tuple[int, int], strides: tuple[int, int]
) -> Iterator[tuple[Cell, list[Place], str]]:
    """The cells of every map with their corners and why these are computed; the halves of one whose corners differ follow it.

    A cell is cut when its corners are all known and disagree; an unknown corner waits for the next call.
    """
    # The places of each map agree on every other axis: their indices on the map's own axes are set to 0.
    for fixed, plane in grouped((_placed(place, axes, (0, 0)), place) for place in places).items():
        ends = [max(place[axis] for place in plane) for axis in axes]
        grid = [[*range(0, end, stride), end] for end, stride in zip(ends, strides, strict=True)]
        cells = [(cell, COARSE) for cell in _between(grid)]
        while cells:
            cell, reason = cells.pop()
            corners = [_placed(fixed, axes, pair) for pair in itertools.product(*cell)]
            yield cell, corners, reason
            said = {known.get(corner) for corner in corners}
            if len(said) > 1 and None not in said:
                halves = [sorted({low, (low + high) // 2, high}) for low, high in cell]
                # A cell without places between its corners is its own only part.
                cells += [(part, REFINED) for part in _between(halves) if part != cell]


def _between(lines: Iterable[Iterable[int]]) -> list[Cell]:
    """The cells between the lines along both axes."""
    first, second = map(itertools.pairwise, lines)
    return list(itertools.product(first, second))


def _placed(place: Place, axes: tuple[int, int], indices: Sequence[int]) -> Place:
    changed = list(place)
    for axis, index in zip(axes, indices, strict=True):
        changed[axis] = index
    return tuple(changed)


def recheck(study: StudyFile, rows: Sequence[StudyRow]) -> RecheckRecord | None:
    """How the rechecked cases came out; None where every case was asked.

    Near a boundary the engine's outcome is held against the analytic one, on a refined map against the outcome that its cell was
    taken to have.
    """
    if study.ask.cases == "all":
        return None
    near = study.ask.cases == "boundary"
    expected = _of_reference(rows) if near else _of_cells(study, rows)
    asked = [(row.run.outcome, expected.get((row.number, row.engine))) for row in rows if row.run is not None]
    told = [(outcome, taken) for outcome, taken in asked if taken is not None]
    differ = sum(outcome != taken for outcome, taken in told)
    return RecheckRecord(len(told), differ, "analytic" if near else "map")


def _of_reference(rows: Sequence[StudyRow]) -> dict[tuple[int, str], str]:
    """The analytic outcome of every rechecked case, by the case and the engine that was asked."""
    known = {row.number: str(row.run.outcome) for row in rows if row.engine == REFERENCE and row.run is not None}
    asked = [row for row in rows if row.reason == RECHECK and row.engine != REFERENCE]
    return {(row.number, row.engine): known[row.number] for row in asked if row.number in known}


def _of_cells(study: StudyFile, rows: Sequence[StudyRow]) -> dict[tuple[int, str], str]:
    """What a map refined without the rechecks says of every rechecked case, by case and engine."""
    axes = map_axes(study)
    groups: dict[tuple[str, int], dict[Place, StudyRow]] = defaultdict(dict)
    for row in rows:
        if row.engine != REFERENCE:
            place = study.place(row.number)
            groups[row.engine, place[-1]][place[:-1]] = row
    expected: dict[tuple[int, str], str] = {}
    for members in groups.values():
        known = {place: str(row.run.outcome) for place, row in members.items() if row.run is not None}
        needed = refined([*members], known, axes)
        taken = filled([*members], {place: known[place] for place in needed if place in known}, axes)
        for place, row in members.items():
            if row.reason == RECHECK and place not in needed and place in taken:
                expected[row.number, row.engine] = taken[place]
    return expected
