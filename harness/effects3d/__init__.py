"""What the third dimension changes: overturning amplitude by direction in 3D beside the planar models, and what moves it.

Azimuths are directions in the statue's own frame, counter-clockwise from x seen from above: the direction along which the
floor shakes. The statue is turned, not the floor: shaking stays along x, so every planar model sees its own section.
"""

from harness.effects3d.conditions import CONDITIONS, Condition, amplified, changed_scene, turned, with_solid
from harness.effects3d.departure import departure, tilt_along
from harness.effects3d.file import asked
from harness.effects3d.search import Search, find, start_factor
from harness.effects3d.study import run_effects
from harness.records.effects3d import BASELINE, Amplitude, Departure

__all__ = [
    "BASELINE",
    "CONDITIONS",
    "Amplitude",
    "Condition",
    "Departure",
    "Search",
    "amplified",
    "asked",
    "changed_scene",
    "departure",
    "find",
    "run_effects",
    "start_factor",
    "tilt_along",
    "turned",
    "with_solid",
]
