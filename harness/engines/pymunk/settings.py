"""What pymunk can be told: numbers alone, so that the engine can say that it is missing where pymunk cannot be imported."""

from dataclasses import dataclass

from harness.engines.base import Settings


@dataclass(frozen=True)
class MunkSettings(Settings):
    """Chipmunk's settings for one run.

    `iterations` of its solver in a step, `impact_iterations` in one that is an impact, a stick onset or near either; `slop_m`
    the penetration that it leaves, `depth_m` the one at which the statue is placed; `pedestal_first` the order in which bodies
    are added (results depend on it); `event_share` how long, over its own, what locates events stays around one.
    """

    iterations: int
    depth_m: float
    slop_m: float
    impact_iterations: int
    pedestal_first: bool = True
    event_share: float = 1.0
