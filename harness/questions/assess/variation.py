"""A scene with other values of what it does not know."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from analytic.excitation import Harmonic
from harness.model.errors import InputError, Mistake
from harness.model.scene import Scene, written

if TYPE_CHECKING:
    from pydantic import JsonValue

AXES: Final = ("x", "y", "z")
STATIC: Final = "contact.floor_static"
KINETIC: Final = "contact.floor_kinetic"
"""The floor's two coefficients drawn apart: where one in motion would be more than the one at rest, it is that."""
IMPACT: Final = "contact.floor_impact"
"""Which of the two, or what between them, acts at an impact: drawn by its place between them, 0 the kinetic one, 1 the static."""
TIME_SCALE: Final = "motion.time_scale"
"""The factor τ on the motion's axis of time, by which its step, its periods and its duration grow, and the run's with it.

In the time t/τ every acceleration is τ² times as large and every place is the same: gravity and shaking times τ², rates times τ,
computed in the scene's own time.
"""


def varied(scene: Scene, values: Mapping[str, float]) -> Scene:
    """The scene with those values by dotted key. Raises `InputError` where a value makes no scene.

    Friction, strength and frequency are changed in place; any other key is written into the scene's own file content, which is
    then read again as a whole.
    """
    other = {key: value for key, value in values.items() if not _direct(scene, key)}
    if other:
        scene = reread(scene, other, f"{scene.source or 'the scene'}: uncertainty")
    # What is at rest first: friction in motion is at most that, and what acts at an impact lies between them.
    for key in sorted(values, key=lambda key: (key == KINETIC, key == IMPACT)):
        if key not in other:
            scene = _changed(scene, key, values[key])
    return scene


def _direct(scene: Scene, key: str) -> bool:
    if key in ("contact.floor", STATIC, KINETIC, IMPACT, "contact.statue", "motion.scale", TIME_SCALE):
        return True
    parts = key.split(".")
    if len(parts) == 3 and parts[0] == "motion" and parts[2] == "frequency_hz":
        return isinstance(getattr(scene.base_excitation, parts[1]), Harmonic)
    return False


def _changed(scene: Scene, key: str, value: float) -> Scene:
    if key == "contact.floor":
        factor = value / scene.contact.floor_static if scene.contact.floor_static > 0.0 else 1.0
        return replace(scene, contact=scene.contact.with_floor(value, scene.contact.floor_kinetic * factor))
    static, kinetic = scene.contact.floor_static, scene.contact.floor_kinetic
    if key == STATIC:
        return replace(scene, contact=scene.contact.with_floor(value, kinetic))
    if key == KINETIC:
        return replace(scene, contact=scene.contact.with_floor(static, value))
    if key == IMPACT:
        return replace(scene, contact=scene.contact.with_floor(static, kinetic, share=value))
    if key == "contact.statue":
        return replace(scene, contact=replace(scene.contact, statue=value))
    base_excitation = scene.base_excitation
    if key == "motion.scale":
        return replace(scene, base_excitation=base_excitation.scaled(value / file_scale(scene)))
    if key == TIME_SCALE:
        start = scene.initial
        return replace(
            scene,
            gravity_m_s2=scene.gravity_m_s2 * value**2,
            base_excitation=base_excitation.scaled(value**2),
            initial=replace(start, theta_rate_rad_s=start.theta_rate_rad_s * value),
        )
    axis = key.split(".")[1]
    return replace(
        scene,
        base_excitation=replace(base_excitation, **{axis: replace(getattr(base_excitation, axis), frequency_hz=value)}),
    )


def file_scale(scene: Scene) -> float:
    """The factor that the scene's file puts on all axes, which its excitations hold already."""
    scale = written(scene, "motion", "scale")
    return float(scale) if isinstance(scale, int | float) else 1.0


def reread(scene: Scene, values: Mapping[str, object], place: str) -> Scene:
    """The scene of its own file's content with other values by dotted key (`"none"` removes one), read again as a whole.

    `place` is where a mistake is: raises `InputError` for values that make no scene, and for a scene made in Python.
    """
    from pydantic import ValidationError

    from harness.input.mistakes import mistakes_of
    from harness.input.overrides import put
    from harness.input.scene_file import resolve
    from harness.input.tables import SceneFile

    if not scene.given:
        raise InputError(Mistake(place, ", ".join(values), "a scene read from a file", "one made in Python"))
    content: dict[str, JsonValue] = copy.deepcopy(dict(scene.given))
    values_text = ", ".join(
        f"{key} = {value:.6g}" if isinstance(value, float) else f"{key} = {value}" for key, value in values.items()
    )
    for key, value in values.items():
        put(content, place, key, value)
    try:
        return resolve(SceneFile.model_validate(content), scene.source, content)
    except (ValidationError, InputError) as error:
        mistakes = error.mistakes if isinstance(error, InputError) else mistakes_of(error, SceneFile, place)
        reasons = "; ".join(str(replace(item, where=item.key, key="")) for item in mistakes)
        raise InputError(Mistake(place, ", ".join(values), "values that make a scene", values_text, reasons)) from error
