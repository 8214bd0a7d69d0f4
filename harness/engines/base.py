"""The contract of an engine: what a model must offer to be run beside the others.

How to add an engine
--------------------
1. Write one file in `harness/engines/`, with one final class derived from `Engine`. Import the simulator inside that file
   only, and inside functions, so that a run that does not ask for it does not pay for it.
2. Declare `name`, `capabilities` and `order`; the shared tests are driven by them and check them: a flag that is not true
   fails.
3. Implement `missing` (of a simulator), `refinement_levels`, `settings_for_dt`, `verification_settings` and `simulate`. A scene
   arrives resolved (plain numbers, arrays, accelerations): no engine reads a file. Translate the simulator's exceptions into
   `EngineFailure` at this boundary. An engine with contact offers a `Backend` (`harness.engines.stepping.step_state`): the
   layer steps it, locates events in it, and makes its trajectory.
4. Fill every field of `Run` that the engine can know. A scene that asks for what the engine cannot compute is refused by
   `EngineFailure` in one sentence; a form of the two-block model that it replaces by its own contact is said in `Run.findings`.
5. Add one line to the registry in `harness/engines/__init__.py`, and run `make test`.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from typing import ClassVar, Final, TypeVar

from harness.model import Capabilities, InputError, Run, RunOptions, Scene

VERIFICATION_STEP_SHARE: Final = 0.45
"""Step of a verification run over its level's: steps that are parts of each other begin at the same instants, and err alike."""
VERIFICATION_EVENT_SHARE: Final = 1.5
"""Times as long as in a level, of its own step, a verification run stays around an event: what locates events errs otherwise."""
RELIABLE_RAD: Final = 1e-6
"""Error up to which a certified history counts as reliable, whatever is asked of the other engines."""
MOVING_TABLE: Final = "a moving table (table; it accelerates the floor's frame)"
"""What engines that compute in the floor's frame refuse."""


class EngineFailure(RuntimeError):
    """The engine could not finish this run; the harness records it as a failure of this run only."""

    def __init__(self, reason: str) -> None:
        """The reason is part of a sentence, which ends with its own full stop."""
        super().__init__(reason.removesuffix("."))


class LayerFault(EngineFailure):
    """What locates events in an engine is at fault, not the engine: a `code` that says what, and the `values` that show it."""

    def __init__(self, code: str, **values: float) -> None:
        """Both are the record's: the sentence is made of them."""
        said = ", ".join(f"{name} {value:.3g}" for name, value in values.items())
        super().__init__(f"what locates events is at fault ({code}: {said})")
        self.code, self.values = code, values


@contextmanager
def own_failures(name: str) -> Iterator[None]:
    """Let an engine's faults out as `EngineFailure` alone: what one does must not take along the answers of others."""
    try:
        yield
    except (EngineFailure, InputError):
        raise
    except Exception as fault:
        raise EngineFailure(
            f"{name} failed, {type(fault).__name__}: {fault}; a fault of rockcheck: please report it"
        ) from fault


def refuse(name: str, asked: Mapping[str, bool], *others: str) -> None:
    """Raise `EngineFailure` for what an engine does not compute, as its answer would be that of another scene.

    `asked` says of each thing whether the scene asks for it; `others` are the engines that have it.
    """
    refused = [thing for thing, there in asked.items() if there]
    if refused:
        raise EngineFailure(
            f"{name} does not compute {' nor '.join(refused)}: leave it out, or ask {' or '.join(others)}"
        )


@dataclass(frozen=True)
class Settings:
    """Settings of one run; each engine extends them. `expected_error_rad` is what this level reached where it was tuned."""

    dt_s: float
    expected_error_rad: float

    def as_dict(self) -> dict[str, object]:
        """The settings as plain values, as they stand in the record."""
        return {item.name: getattr(self, item.name) for item in fields(self)}


Own = TypeVar("Own", bound=Settings)


def own_settings(name: str, kind: type[Own], settings: Settings) -> Own:
    """The settings as those of an engine's own kind. Raises `TypeError` for another engine's."""
    if not isinstance(settings, kind):
        raise TypeError(f"{name} wants its own settings, got {type(settings).__name__}")
    return settings


def near(levels: Sequence[tuple[float, ...]], dt_s: float) -> tuple[float, ...]:
    """Numbers of the level whose step is nearest to `dt_s`, for that step: its expected error, the last of them, goes with the
    step, the first.
    """
    # On a logarithmic scale: levels follow each other by factors.
    level_s, *between, error_rad = min(levels, key=lambda level: abs(math.log(level[0] / dt_s)))
    return (dt_s, *between, error_rad * dt_s / level_s)


class Engine(ABC):
    """One model behind the contract. Engines hold no state: every call stands alone."""

    name: ClassVar[str]
    capabilities: ClassVar[Capabilities]
    order: ClassVar[float]
    """Declared order of convergence of the rotation in `dt_s`, before the first impact."""
    agreements: ClassVar[int] = 2
    """Comparisons of a run with the next finer one that must hold in a row before an accuracy counts as reached: one where errors
    are shown to fall evenly with the step (`python -m tests.measures.random_scenes`), two where runs may agree by chance."""

    def __init_subclass__(cls) -> None:
        """Let nothing but `EngineFailure` and a user's mistakes out of the class's runs, whoever asks for them."""
        super().__init_subclass__()
        if "simulate" in cls.__dict__ and not getattr(cls.simulate, "__isabstractmethod__", False):
            cls.simulate = own_failures(cls.name)(cls.simulate)  # type: ignore[method-assign]

    def missing(self) -> str | None:
        """Why the engine cannot run here, in one sentence; None: it can, as one that needs no simulator always does."""
        return None

    @abstractmethod
    def refinement_levels(self, scene: Scene) -> tuple[Settings, ...]:
        """Settings for this scene from coarse to fine, the cost rising."""

    @abstractmethod
    def settings_for_dt(self, scene: Scene, dt_s: float) -> Settings:
        """Settings with the expert's own time step."""

    @abstractmethod
    def verification_settings(self, scene: Scene, settings: Settings) -> tuple[Settings, ...]:
        """Variations of `settings` (half the step, other body order, more iterations) whose spread is the numerical error."""

    def sensitivity_settings(self, scene: Scene, settings: Settings) -> Settings:
        """Settings of the run that shows how much a small change moves the answer: what else should change nothing is changed
        there too.
        """
        return settings

    def step_cost(self, scene: Scene) -> float:
        """Processor time of a step of an unmodified engine over that of the same engine with events located, at most."""
        return 1.0

    def step_s(self, scene: Scene) -> float:
        """Processor seconds of a step, to an order of magnitude: what a forecast takes where there are too few to be timed."""
        return 5e-5

    def awaited(self) -> str:
        """What a run in a process of its own, from which nothing is heard, is at."""
        return "still"

    @abstractmethod
    def simulate(self, scene: Scene, settings: Settings, options: RunOptions) -> Run:
        """Compute the scene. Raises `EngineFailure` when the engine cannot finish."""
