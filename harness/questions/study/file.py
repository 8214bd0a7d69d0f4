"""The study file: a base scene, what varies, which engines answer, validated strictly."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Final, Literal

import numpy as np
from pydantic import Field, model_validator

from harness.input.mistakes import UserTable, agree
from harness.input.tables import read_model

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
    def _one_way(self) -> Vary:
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
    def _bounds(self) -> Scatter:
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
    def _used(self) -> Ask:
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
    def _whole(self) -> StudyFile:
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
    return read_model(StudyFile, Path(path))
