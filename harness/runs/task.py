"""A keyed task: what names its result, what computes it, and what it gives back; the key of a scene; and one run in a process of
its own.
"""

import hashlib
import json
import math
import operator
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field, fields, replace
from functools import partial
from typing import Any, Final
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from analytic.excitation import Harmonic, Pulse, SampledAcceleration, ZeroExcitation
from harness import engines
from harness.accuracy.refinement import DEFAULT_ACCURACY_RAD, RunTarget, failed, simulate, simulate_with
from harness.engines.base import Engine
from harness.model import (
    BaseExcitation,
    Capabilities,
    Contact,
    Form,
    History,
    Initial,
    Outcome,
    Pedestal,
    Pose,
    Run,
    RunOptions,
    Scene,
    Statue,
    Wall,
    require,
    to_plain,
    versions,
)
from harness.records.base import Plain
from harness.runs.runner import Crash, Hung, LocalPool

# The cache key: the hash of a scene's physics, as far as an engine looks at it.
#
# It is made of names and of exact numbers; a class or a field that is renamed in the code keeps its name here.

NOT_PHYSICS: Final[Mapping[type, str]] = {Scene: "title source given findings uncertainty", Statue: "solid"}
"""Fields of which a run does not depend; of a mesh its own digest is part of the key where an engine uses it."""
KEYED: Final[Mapping[type, str]] = {
    Scene: "scene", Form: "model", Statue: "statue", Pedestal: "pedestal", Contact: "contact", Wall: "wall",
    Initial: "initial", Pose: "pose", BaseExcitation: "motion", ZeroExcitation: "rest", Harmonic: "harmonic",
    Pulse: "pulse", SampledAcceleration: "record",
}  # fmt: skip
"""Name in the key of each class."""
RENAMED: Final = {"base_excitation": "motion", "samples_m_s2": "accel_m_s2"}
"""Name in the key of each field that is called otherwise today; every other has its own, in the order of its class."""
ADDED: Final = {"floor_impact": "kinetic"}
"""Fields that came later, and what they are in scenes without them."""
EVERYTHING: Final = Capabilities(dimensions=3, uses_mesh=True, own_impact=False, statue_slips=True)
"""Of what asks for all of a scene."""
_MEMBERS: Final = {
    kind: [
        (item.name, RENAMED.get(item.name, item.name))
        for item in fields(kind)
        if item.name not in NOT_PHYSICS.get(kind, "").split() and not item.name.startswith("_")
    ]
    for kind in KEYED
}


def scene_key(scene: Scene, capabilities: Capabilities) -> str:
    """SHA-256 of the scene as an engine of these capabilities sees it; equal digests are the same run by physics."""
    state = hashlib.sha256()
    for part in _parts("", relevant(scene, capabilities)):
        state.update(part)
    solid = scene.statue.solid
    if solid is not None and capabilities.uses_mesh:
        state.update(solid.digest.encode())
    return state.hexdigest()


def request_key(scene: Scene, engine: Engine | None, *asked: object) -> str:
    """What names an answer: the scene as the engine sees it (None: all of it), what was asked, and the versions that answer."""
    seen, name = (EVERYTHING, "") if engine is None else (engine.capabilities, engine.name)
    own = versions()
    mine = own if engine is None else {key: own.get(key) for key in ("rockcheck", "numpy", "numba", name)}
    return key_of(scene_key(scene, seen), name, asked, dict(mine))


def key_of(*parts: object) -> str:
    """SHA-256 of plain values as JSON: what names an answer in a store."""
    return hashlib.sha256(json.dumps(parts, sort_keys=True, default=str).encode()).hexdigest()


def relevant(scene: Scene, capabilities: Capabilities) -> Scene:
    """The scene with everything that the engine does not look at set to one fixed value.

    Without a pedestal nothing slides on the floor; an engine's own contact knows neither the model's normal force nor, unless a
    ratio is imposed, its impact law; a planar engine sees neither the motion across the plane nor the body's third dimension.
    Friction under the statue counts for a model that holds it too: from where on it would slide bounds its domain.
    """
    form, contact, base_excitation, statue = scene.form, scene.contact, scene.base_excitation, scene.statue
    if scene.pedestal is None:
        form, contact = Form(), Contact(0.0, 0.0, contact.statue, contact.restitution)
    acts = contact.at_impact
    contact = replace(contact, floor_impact=acts if acts > contact.floor_kinetic else "kinetic")
    if capabilities.own_impact:
        form = replace(form, friction_normal=Form().friction_normal)
        if contact.restitution is None:
            form = Form()
    if capabilities.dimensions == 2:
        base_excitation = base_excitation.in_plane()
        statue = _planar(statue)
    return replace(scene, form=form, contact=contact, base_excitation=base_excitation, statue=statue)


def _planar(statue: Statue) -> Statue:
    """The statue without its third dimension; the same object for the same statue, which thousands of scenes may share."""
    if statue not in _PLANAR:
        _PLANAR[statue] = replace(
            statue, depth_m=1.0, footprint_m=np.zeros((0, 3)), inertia_tensor_kg_m2=np.zeros((3, 3))
        )
    return _PLANAR[statue]


_PLANAR: Final[WeakKeyDictionary[Statue, Statue]] = WeakKeyDictionary()
_BYTES: Final[WeakKeyDictionary[Statue, bytes]] = WeakKeyDictionary()


def _parts(name: str, value: Any) -> Iterator[bytes]:
    """The bytes that stand for a value: names, types and exact numbers, so that no two values share them."""
    if isinstance(value, Statue):
        # Its section and footprint are long, and thousands of scenes may share it.
        if value not in _BYTES:
            _BYTES[value] = b"".join(_members(name, value))
        yield _BYTES[value]
    elif type(value) in KEYED:
        yield from _members(name, value)
    elif isinstance(value, np.ndarray):
        yield f"{name}:{value.dtype}{value.shape}=".encode()
        yield np.ascontiguousarray(value).tobytes()
    elif isinstance(value, tuple):
        yield from (part for item in (len(value), *value) for part in _parts(name, item))
    elif isinstance(value, (bool, str, int)):
        yield f"{name}={value!r};".encode()
    elif isinstance(value, float):
        # −0.0 and 0.0 are the same physics.
        yield f"{name}={(value + 0.0).hex() if math.isfinite(value) else value};".encode()
    else:
        raise TypeError(f"no name in the cache key for {name}: {type(value).__name__}")


def _members(name: str, value: Any) -> Iterator[bytes]:
    yield f"{name}:{KEYED[type(value)]}{{".encode()
    for attribute, key in _MEMBERS[type(value)]:
        # What is not given has no part in the key: a new thing that may be given changes no key of scenes without it.
        member = getattr(value, attribute)
        if member is not None and not (attribute in ADDED and member == ADDED[attribute]):
            yield from _parts(key, member)
    yield b"}"


RUN = "run"
"""Kind of a result that is an engine's run."""


@dataclass(frozen=True)
class TaskResult:
    """What a task's function gives back: its record as plain values, and the history that belongs to it.

    `seconds` is what the result is said to have cost, `inside_s` the part of the task's time that is no overhead, `failed` the
    number of its runs that failed; `table` holds the columns of many runs, texts as objects.
    """

    kind: str
    record: Plain
    seconds: float
    history: History | None = None
    inside_s: float = 0.0
    failed: int = 0
    table: Mapping[str, NDArray[Any]] | None = None


@dataclass(frozen=True)
class Task:
    """One thing to compute, as it travels to a worker: functions of a module, and an argument.

    `key` names the result in the store. Neighbours of one `group` may go to a worker together.
    `lost` makes the answer of a task whose worker died; without it nothing is kept. It counts as so many `runs`.
    """

    key: str
    work: Callable[[Any], TaskResult]
    argument: Any
    group: str = ""
    lost: Callable[[Any, Crash], TaskResult] | None = None
    runs: int = 1


def answer_of(run: Run, histories: bool, inside_s: float = 0.0) -> TaskResult:
    """A finished run as an answer.

    Times differ from run to run: they stand apart, so that two stores of one study are equal row for row.
    """
    plain = to_plain(run)
    seconds, _ = plain.pop("wall_s"), plain.pop("cpu_s")
    return TaskResult(RUN, plain, seconds, run.history if histories else None, inside_s, run.outcome.failed)


def lost_answer(argument: Any, crash: Crash) -> TaskResult:
    """The answer of a task that is a run of `argument.engine`, and whose worker died or hung."""
    return answer_of(lost_run(argument.engine, crash), histories=False)


@dataclass(frozen=True)
class RunRequest:
    """One run that is wanted, as it travels to a worker: its scene, or what makes it there, the engine, its target, what is kept.

    >>> request = harness.RunRequest(scene.replace(motion__x__amplitude_g=0.3), "pymunk", varied={"amplitude_g": 0.3})

    Either `accuracy_rad`, the target of the rotation's numerical error (1e-3 where neither is given), or a fixed step `dt_s`;
    without `stated` one run is made and its error is not. `varied` tells it from others in a table (and is no part of the key).
    """

    scene: Scene | Callable[[], Scene]
    engine: str
    accuracy_rad: float | None = None
    dt_s: float | None = None
    history: bool = False
    stated: bool = True
    varied: Mapping[str, object] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Fill in the target. Raises `InputError` for what is no scene, nor makes one."""
        wanted, got = "a scene (harness.load_scene), or a function that makes one", type(self.scene).__name__
        require(isinstance(self.scene, Scene) or callable(self.scene), "RunRequest", wanted, got, key="scene")
        if self.accuracy_rad is None and self.dt_s is None:
            object.__setattr__(self, "accuracy_rad", DEFAULT_ACCURACY_RAD)

    def made(self) -> Scene:
        """Its scene."""
        return self.scene if isinstance(self.scene, Scene) else self.scene()

    def task(self, scene: Scene | None = None) -> Task:
        """Its task, named by all that decides its answer; `scene` is what it will make, where that is there already."""
        asked = self.accuracy_rad, self.dt_s, self.history, self.stated
        key = request_key(scene or self.made(), engines.load(self.engine), *asked)
        return Task(key, run_request, self, self.engine, lost_answer)


def run_request(wanted: RunRequest) -> TaskResult:
    """Make the scene and run it (a failure is a `Run` that says so); overhead is what `simulate` does not take."""
    scene = wanted.made()
    begin = time.perf_counter()
    run = simulate(
        scene,
        wanted.engine,
        accuracy_rad=wanted.accuracy_rad,
        dt_s=wanted.dt_s,
        options=RunOptions(history=wanted.history, stated=wanted.stated),
    )
    return answer_of(run, wanted.history, time.perf_counter() - begin)


DEFAULT_TIMEOUT_S: Final = 600.0


def call(function: Callable[..., Any], arguments: Sequence[Any] = (), *, timeout_s: float = DEFAULT_TIMEOUT_S) -> Any:
    """Call a function of a module in a fresh process and return what it returns.

    Raises `Crash` when the process ends without an answer, `Hung` after `timeout_s` (it is then killed), and what the function
    itself raised.
    """
    answers: list[Any] = []
    with closing(LocalPool(1, timeout_s, tries=1)) as pool:
        pool.run(operator.call, [partial(function, *arguments)], lambda task, answer: answers.append(answer))
    if isinstance(answers[0], Crash):
        raise answers[0]
    return answers[0]


def lost_run(engine: str, crash: Crash, wall_s: float = 0.0) -> Run:
    """The run whose process died or hung: it says so."""
    outcome = Outcome.TIMED_OUT if isinstance(crash, Hung) else Outcome.CRASHED
    return failed(engine, outcome, str(crash), wall_s)


def simulate_isolated(scene: Scene, engine: str, target: RunTarget, *, timeout_s: float = DEFAULT_TIMEOUT_S) -> Run:
    """`harness.simulate` in a process of its own; a crash or hang is a run whose outcome says so.

    Raises `InputError` for an unknown engine.
    """
    begin = time.perf_counter()
    try:
        run: Run = call(simulate_with, (engines.load(engine), scene, target), timeout_s=timeout_s)
    except Crash as crash:
        return lost_run(engine, crash, time.perf_counter() - begin)
    return run
