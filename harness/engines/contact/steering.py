"""What a contact engine could compute only by writing to its bodies: engines as they come refuse it."""

from __future__ import annotations

from harness.engines.base import EngineFailure
from harness.model.scene import Scene


def refuse_steering(scene: Scene, name: str) -> None:
    """Raise `EngineFailure`, in the name of the plain engine, for what can be had only by writing to bodies."""
    refused = []
    if scene.contact.restitution is not None and scene.initial.pose is None:
        refused.append("a prescribed ratio at impact (contact.restitution; it would have to be imposed on the bodies)")
    if scene.table == "moving":
        refused.append("a moving table (table; it accelerates the floor's frame)")
    if refused:
        other = name.removesuffix(":plain")
        raise EngineFailure(f"{name} does not compute {' nor '.join(refused)}: leave it out, or ask {other}")
