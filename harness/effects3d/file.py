"""The file of an effects study: a scene, its directions, who answers, and what is compared."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from harness.effects3d.conditions import CONDITIONS
from harness.effects3d.search import Search
from harness.input.mistakes import Contradiction, Table
from harness.records.effects3d import BASELINE, SOLID
from harness.studies.file import EngineName

KIND = "effects3d"


class EffectsFile(Table):
    """A whole file of `kind = "effects3d"`.

    Directions are `directions` equal parts of the circle; conditions are asked at every `every`-th of them. `samples` statues
    with errors in h, b and J are drawn at each of those for the band around the planar model.
    """

    kind: Literal["effects3d"]
    title: Annotated[str, Field(min_length=1)]
    scene: Annotated[str, Field(min_length=1)]
    directions: Annotated[int, Field(ge=4, le=360)] = 24
    every: Annotated[int, Field(ge=1, le=90)] = 2
    engines: Annotated[list[EngineName], Field(min_length=1)]
    conditions: list[str] = Field(default_factory=lambda: [name for name in CONDITIONS if name != BASELINE])
    samples: Annotated[int, Field(ge=0, le=10_000)] = 200
    share: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.95
    seed: Annotated[int, Field(ge=0)] = 0
    search: Search = Search()

    @model_validator(mode="after")
    def _whole(self) -> EffectsFile:
        unknown = [name for name in self.conditions if name not in CONDITIONS or name == BASELINE]
        if unknown:
            names = ", ".join(name for name in CONDITIONS if name != BASELINE)
            raise Contradiction("conditions", f"names out of {names}", repr(unknown[0]))
        if not any(name in SOLID for name in self.engines):
            raise Contradiction("engines", f"one that computes in 3D ({' or '.join(SOLID)})", ", ".join(self.engines))
        if len(set(self.engines)) != len(self.engines):
            raise Contradiction("engines", "each engine once", ", ".join(self.engines))
        if self.directions % self.every:
            raise Contradiction("every", f"a divisor of directions = {self.directions}", str(self.every))
        return self

    def azimuths_deg(self, every: int = 1) -> list[float]:
        """The directions, or every n-th of them."""
        return [360.0 * k / self.directions for k in range(0, self.directions, every)]
