"""What is asked of a run, what it may leave out, and what an engine is able to do."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Final

SKIPS: Final[Mapping[str, str]] = {
    "quiet_start": "nothing is integrated before the motion first reaches a limit of rest",
    "quiet_rest": "nothing is integrated while the statue is at rest and the motion stays below its limits of rest",
    "quiet_end": "the run ends when the statue is at rest and the motion that is left cannot move it",
    "energy_outcome": "after the motion ends the outcome follows from the energy, without integration",
    "base_only": "collision shapes other than the base are left out while nothing else can touch",
    "mirror": "half of a scene that is its own mirror image across the rocking plane is computed in 3D",
    "no_history": "no history is kept when only the outcome is asked",
    "planar": "a planar question is not computed in 3D",
    "stop_at_overturn": "the run ends when the statue has overturned",
    "lazy_engines": "engines that were not asked are not imported",
    "cached": "a result that is stored is not computed again",
}


MOST_TIMES: Final = 40.0
"""Steps of all runs of a climb to a target over those of its first level, at most, unless told otherwise: a level nearly twenty
times as fine is reached."""


@dataclass(frozen=True)
class RunOptions:
    """What is asked of a run: the history or only the outcome; whether its numerical error is stated; which skips are on.

    Without `stated` one run is made, at the level that is expected to meet the target: enough for one draw of many.
    `stop` is asked now and then with the time, s, and the rotation, rad: a run that only checks another one ends where it says
    so. An engine may go on to the scene's end all the same. A climb to a target makes at most `most_times` the steps of its first
    run.
    """

    history: bool = True
    skips: frozenset[str] = field(default_factory=lambda: frozenset(SKIPS))
    stop: Callable[[float, float], bool] | None = None
    stated: bool = True
    most_times: float = MOST_TIMES

    def allows(self, name: str) -> bool:
        """Whether the named skip is on; raises `KeyError` for an unknown one."""
        if name not in SKIPS:
            raise KeyError(name)
        return name in self.skips


@dataclass(frozen=True)
class Capabilities:
    """What an engine computes; every flag is checked by a shared test.

    `dimensions` 2 or 3; `certifies` states its own uncertainty (no refinement levels needed); `uses_mesh` takes base and inertia
    from the statue's mesh; `own_impact` finds the impact from contact instead of a law; `pedestal_tips`, `statue_slips`, `flies`
    compute what the two-block model only reports; `pedestal` takes a statue that stands on one; `posed_start` begins from a pose
    in space; `moving_table` can move the table instead of the frame; `forces` records contact forces; `edge_shape` says what of
    the statue meets a pedestal's edge where that is the same in every scene (empty: no contact at all, or chosen by
    `statics.plan`); `skips` are those of `SKIPS` that it has, each with its switch in `RunOptions`.
    """

    dimensions: int
    certifies: bool = False
    uses_mesh: bool = False
    own_impact: bool = False
    pedestal_tips: bool = False
    statue_slips: bool = False
    flies: bool = False
    posed_start: bool = False
    pedestal: bool = True
    moving_table: bool = False
    forces: bool = False
    edge_shape: str = ""
    skips: frozenset[str] = frozenset()
