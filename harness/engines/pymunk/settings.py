"""What pymunk can be told: numbers alone, so that the engine can say that it is missing where pymunk cannot be imported."""

from dataclasses import dataclass

from harness.engines.base import Settings


@dataclass(frozen=True)
class MunkSettings(Settings):
    """Chipmunk's settings for one run.

    `iterations` of its solver in a step, `turning_iterations` while the statue turns on one corner and its forces change little
    from step to step, `impact_iterations` in a step that is an impact, a stick onset at rest or a change of sliding;
    `slop_m` the penetration that it leaves, `depth_m` the one at which the statue is placed; `pedestal_first` the order in
    which bodies are added (results depend on it); `event_share` how long, over its own, what locates events stays around one.
    """

    iterations: int
    turning_iterations: int
    depth_m: float
    slop_m: float
    impact_iterations: int
    pedestal_first: bool = True
    event_share: float = 1.0
