"""What the third dimension changes: overturning amplitude by azimuth in 3D beside the planar model taken at that
azimuth.

Azimuths are directions in the statue's own frame, counter-clockwise from x seen from above: the direction along which
the floor
shakes. The statue is turned, not the floor: shaking stays along x, so every planar model sees its own section
(docs/effects3d.md).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from analytic.excitation import Rest
from harness.engine import Want
from harness.errors import InputError, Mistake
from harness.load import statue_of
from harness.record import Run
from harness.scene import Scene
from meshes import MeshError, Solid
from meshes.survey import adjusted

Array = NDArray[np.float64]

OVERTURNED: Final = ("overturned_left", "overturned_right", "overturned_front", "overturned_back")
GEOMETRY_REL: Final = 0.03
"""Uncertainty of centroid height, corners and inertia: a few per cent, as surveys of one statue differ."""
UPRIGHT_RAD: Final = 1.0
"""Beyond this tilt the statue is falling: its yaw and its way say nothing of rocking."""
FRICTION_REL: Final = 0.10
"""Uncertainty of a friction coefficient of stone on stone."""


def _solid(scene: Scene) -> Solid:
    """The scene's mesh; raises `InputError` for a statue given by numbers alone."""
    if scene.statue.solid is None:
        advice = "a block given by numbers has no azimuth"
        raise InputError(Mistake(str(scene.source or "scene"), "statue.mesh", "a mesh", "numbers alone", advice))
    return scene.statue.solid


def with_solid(scene: Scene, solid: Solid) -> Scene:
    """The same scene with another solid, every number of the statue taken from it."""
    return scene.but(statue=statue_of(solid))


def turned(scene: Scene, azimuth_deg: float) -> Scene:
    """The scene with the statue turned so that the floor shakes along `azimuth_deg` of the statue's own frame."""
    return with_solid(scene, _solid(scene).rotated(-azimuth_deg))


def amplified(scene: Scene, factor: float) -> Scene:
    """The scene with all components of the motion scaled alike."""
    shake = scene.shake
    return scene.but(shake=replace(shake, x=shake.x.scaled(factor), y=shake.y.scaled(factor), z=shake.z.scaled(factor)))


def adjust(scene: Scene, **shares: Any) -> Scene:
    """The scene with its statue adjusted (`meshes.survey.adjusted`)."""
    return with_solid(scene, adjusted(_solid(scene), **shares))


def no_vertical(scene: Scene) -> Scene:
    """The scene without vertical shaking."""
    return scene.but(shake=replace(scene.shake, z=Rest()))


def along_x_only(scene: Scene) -> Scene:
    """The scene shaken along x alone."""
    return scene.but(shake=replace(scene.shake, y=Rest(), z=Rest()))


def rougher(scene: Scene, relative: float) -> Scene:
    """The scene with the statue's friction on its support grown by a share."""
    return scene.but(contact=replace(scene.contact, statue=(1.0 + relative) * scene.contact.statue))


CONDITIONS: Final[Mapping[str, Callable[[Scene], Scene]]] = {
    "as scanned": lambda scene: scene,
    "along x only": along_x_only,
    "no vertical": no_vertical,
    "flat base": lambda scene: adjust(scene, flat_base=True),
    "no products of inertia": lambda scene: adjust(scene, products=False),
    "centroid 3 % higher": lambda scene: adjust(scene, centroid_rel=GEOMETRY_REL),
    "centroid 3 % lower": lambda scene: adjust(scene, centroid_rel=-GEOMETRY_REL),
    "base 3 % wider": lambda scene: adjust(scene, base_rel=GEOMETRY_REL),
    "base 3 % narrower": lambda scene: adjust(scene, base_rel=-GEOMETRY_REL),
    "inertia 3 % larger": lambda scene: adjust(scene, inertia_rel=GEOMETRY_REL),
    "inertia 3 % smaller": lambda scene: adjust(scene, inertia_rel=-GEOMETRY_REL),
    "friction 10 % larger": lambda scene: rougher(scene, FRICTION_REL),
    "friction 10 % smaller": lambda scene: rougher(scene, -FRICTION_REL),
}
"""What is changed of a scene, one thing at a time."""


@dataclass(frozen=True)
class Search:
    """Where overturning is looked for: factors on the motion from `least` to `most` in steps of the ratio `step`,
    then halved.

    Overturning is not monotonic in amplitude: the amplitude found is the least of the grid that overturns, bracketed
    down to
    `resolution` (relative) below it. `dt_s` is the step of every contact engine.
    """

    least: float = 0.2
    most: float = 4.0
    step: float = 1.08
    resolution: float = 0.01
    dt_s: float = 5e-4


@dataclass(frozen=True)
class Amplitude:
    """The least factor on the motion at which an engine's statue overturns (None: not up to the most tried), and what
    was run."""

    condition: str
    azimuth_deg: float
    engine: str
    factor: float | None
    stands_at: float
    outcome: str
    runs: int


@dataclass(frozen=True)
class Departure:
    """How far a 3D run left the plane: largest tilt out of it, yaw and way across, and what stayed of them at the
    end."""

    azimuth_deg: float
    factor: float
    outcome: str
    peak_theta_rad: float
    out_of_plane_rad: float
    yaw_rad: float
    across_m: float
    yaw_left_rad: float
    walked_m: float


def run_once(scene: Scene, engine: str, search: Search, *, history: bool = False) -> Run:
    """One run; contact engines at the search's step, the analytic model at its default accuracy."""
    from harness.run import simulate

    want = Want(history=history)
    if engine == "analytic":
        return simulate(scene, engine, want=want)
    return simulate(scene, engine, dt_s=search.dt_s, want=want)


def overturning(scene: Scene, engine: str, search: Search) -> tuple[float | None, float, str, int]:
    """Least factor on the motion that overturns, the largest below it that was seen to stand, outcome, and runs
    made."""
    below, runs = 0.0, 0
    count = math.ceil(math.log(search.most / search.least) / math.log(search.step))
    for factor in search.least * search.step ** np.arange(count + 1):
        outcome = run_once(amplified(scene, float(factor)), engine, search).outcome.value
        runs += 1
        if outcome not in OVERTURNED:
            below = float(factor)
            continue
        above = float(factor)
        while below > 0.0 and above / below > 1.0 + search.resolution:
            middle = math.sqrt(above * below)
            tried = run_once(amplified(scene, middle), engine, search).outcome.value
            runs += 1
            if tried in OVERTURNED:
                above, outcome = middle, tried
            else:
                below = middle
        return above, below, outcome, runs
    return None, below, "none", runs


def rose(
    scene: Scene,
    azimuths_deg: Sequence[float],
    engines: Sequence[str],
    search: Search,
    conditions: Sequence[str] = ("as scanned",),
    told: Callable[[str], None] = lambda _: None,
) -> list[Amplitude]:
    """The overturning factor for every condition, azimuth and engine; `told` hears of each. Raises `InputError`."""
    found = []
    for condition in conditions:
        if condition not in CONDITIONS:
            raise InputError(Mistake("conditions", condition, f"one of {', '.join(CONDITIONS)}", repr(condition)))
        for azimuth in azimuths_deg:
            changed = changed_scene(scene, condition, azimuth)
            for engine in engines:
                factor, below, outcome, runs = overturning(changed, engine, search)
                found.append(Amplitude(condition, float(azimuth), engine, factor, below, outcome, runs))
                told(f"{condition}, {azimuth:g}°, {engine}: {'stands' if factor is None else f'{factor:.3f}'}")
    return found


def changed_scene(scene: Scene, condition: str, azimuth_deg: float) -> Scene:
    """The scene under a condition with the statue turned; raises `InputError` where the changed statue does not
    stand."""
    try:
        return turned(CONDITIONS[condition](scene), azimuth_deg)
    except MeshError as error:
        raise InputError(Mistake(str(scene.source or "scene"), "statue", "a statue that stands", str(error))) from error


def departure(scene: Scene, azimuth_deg: float, factor: float, search: Search) -> Departure:
    """How far pybullet's statue leaves the plane of shaking at that azimuth and factor."""
    run = run_once(amplified(turned(scene, azimuth_deg), factor), "pybullet", search, history=True)
    if run.history is None:
        raise InputError(Mistake("pybullet", "history", "a run with a history", run.message or run.outcome.value))
    extra, theta = run.history.extra, run.history.theta_rad
    standing = np.hypot(theta, extra["out_of_plane_rad"]) < UPRIGHT_RAD
    until = len(theta) if standing.all() else int(np.argmin(standing))
    yaw, across = (extra[name][:until] - extra[name][0] for name in ("yaw_rad", "statue_y_m"))
    return Departure(
        azimuth_deg=azimuth_deg,
        factor=factor,
        outcome=run.outcome.value,
        peak_theta_rad=float(np.abs(theta[:until]).max()),
        out_of_plane_rad=float(np.abs(extra["out_of_plane_rad"][:until]).max()),
        yaw_rad=float(np.abs(yaw).max()),
        across_m=float(np.abs(across).max()),
        yaw_left_rad=float(yaw[-1]),
        walked_m=float(math.hypot(across[-1], extra["statue_slip_m"][until - 1])),
    )


def tilt_along(theta_rad: Array, out_of_plane_rad: Array, direction_deg: float) -> Array:
    """Rotation (n,) towards a horizontal direction of the table, from the planar rotation and the tilt out of the x-z
    plane."""
    up_x, up_y = np.cos(out_of_plane_rad) * np.sin(theta_rad), np.sin(out_of_plane_rad)
    up_z = np.cos(out_of_plane_rad) * np.cos(theta_rad)
    angle = np.deg2rad(direction_deg)
    return np.asarray(np.arctan2(np.cos(angle) * up_x + np.sin(angle) * up_y, up_z))
