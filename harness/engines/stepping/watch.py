"""What a run in progress is looked at for, and what ends it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from harness.engines.stepping.rows import Row, Vector

if TYPE_CHECKING:
    from harness.engines.stepping.contact_gaps import ContactGaps
    from harness.engines.stepping.rest_spell import RestSpells

UPRIGHT: Final[Vector] = (0.0, 0.0, 1.0)
LOOK_STEPS: Final = 64
"""Steps between two questions whether the run may end: a statue that has fallen stays down."""


@dataclass(frozen=True, eq=False)
class Watch:
    """What a loop looks at: the statue's `axis` in its principal frame and in the world at `rest`, when and what to end.

    `impose` says that impacts are the model's. `quiet_from` is the number of the step from which the table is still (None: the
    run is not ended at rest). `leave` is asked now and then whether the statue may touch what this world leaves out, `stop`, with
    time and rotation, whether the run may end. `gaps` finds impacts; None leaves them to whole steps, as they are while `edges`
    says that the pedestal's edges may be met. `spells` finds times of rest; `ends_fallen` ends a run whose statue has overturned.
    """

    axis: Vector = UPRIGHT
    rest: Vector = UPRIGHT
    quiet_from: int | None = None
    impose: bool = False
    leave: Callable[[Row], bool] | None = None
    stop: Callable[[float, float], bool] | None = None
    gaps: ContactGaps | None = None
    spells: RestSpells | None = None
    edges: Callable[[Row], bool] | None = None
    # Engines that do not say otherwise end there: what has fallen does not stand up again.
    ends_fallen: bool = True
