"""What a contact engine could compute only by writing to its bodies: unmodified engines refuse it."""

from __future__ import annotations

from harness.engines.base import MOVING_TABLE, refuse
from harness.model.scene import Scene


def refuse_steering(scene: Scene, name: str) -> None:
    """Raise `EngineFailure`, in the name of the plain engine, for what can be had only by writing to bodies."""
    imposed = "a prescribed ratio at impact (contact.restitution; it would have to be imposed on the bodies)"
    asked = {
        # A body thrown in space bounces by the engine's own coefficient of restitution, without a write.
        imposed: scene.contact.restitution is not None and scene.initial.pose is None,
        MOVING_TABLE: scene.table == "moving",
    }
    refuse(name, asked, name.removesuffix(":plain"))
