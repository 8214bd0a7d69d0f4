"""What an engine offers so that events can be located in it: its own step, its bodies' state, and three things it is told.

The layer reads a step as velocities first, places after: what touches is found at the places at which the step begins, velocities
are solved there, and the places go on with these. An engine that moves places first is read one move later.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

from harness.engines.stepping.step_log import Impulse, Row, StepLog, Vector

if TYPE_CHECKING:
    from harness.engines.stepping.step_state import StepState


class Backend(Protocol):
    """One world of an engine with the scene's bodies in it."""

    depth_m: float
    """Depth at which what stands is kept in contact."""

    # The balance of momentum over a step, which tells friction, begins with what the engine was given.
    owed_m_s: tuple[float, float]
    """What was taken from the statue's velocity along x and z before the last step was solved."""
    near: bool | None
    """Whether a vertex may come down within the next steps; None of an engine that does not look, so that few are asked for."""
    runs: bool
    """Whether whole steps in which nothing is asked may be made by `run`."""

    def read(self) -> Row:
        """The bodies' state."""

    def place(self, row: Row) -> None:
        """Put the bodies into a state."""

    def set_length(self, length_s: float) -> None:
        """Length of the steps that follow, s."""

    def prepare_step(self, state: StepState, kick_s: float, length_s: float) -> None:
        """Be told of the next step: it begins at `state`, is so long, s, and takes velocities to `kick_s`."""

    def advance(self, gravity: Vector) -> Row:
        """One step under a gravity, m/s²; the row after it."""

    def run(self, pulls: Sequence[Vector], record: StepLog) -> Row:
        """Whole steps, one for each gravity or up to where a vertex comes `near`; rows are recorded, the last is returned."""

    def impulses(self, places: Row) -> Sequence[Impulse]:
        """What the contacts gave each body in the last step, as the engine reports it; centroids stood as in a row.

        Empty where it does not know.
        """

    def set_floor_friction(self, friction: float) -> None:
        """Coefficient of the pedestal on the floor from now on."""

    def move_table(self, place_m: Vector, velocity_m_s: Vector) -> None:
        """Put floor and wall to where a moving table is at the beginning of a step, with its mean velocity in it."""

    def look(self, pulls: Sequence[Vector], before: Row, after: Row, table_m_s: Vector) -> None:
        """After whole steps under `pulls`: what the bodies' contacts need next."""
