"""One case of an effects study run with histories, to be watched: where 3D leaves the plane most."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final

from harness.effects3d.conditions import amplified, changed_scene
from harness.effects3d.search import peak_g
from harness.model.scene import Scene
from harness.records.effects3d import BASELINE, Amplitude, Departure, ReplayRecord
from harness.scene_run.scene_run import run_scene, write_result
from harness.statics.standstill import motion_sized

PLANAR: Final = "analytic"


def write_replay(
    scene: Scene, rows: Sequence[Amplitude], departures: Sequence[Departure], dt_s: float, folder: Path
) -> ReplayRecord | None:
    """Run the direction whose motion turns most about the vertical, at its overturning amplitude, into `folder`; say what it is.

    None when no 3D engine overturned the statue at any direction.
    """
    if not departures:
        return None
    engine = departures[0].engine
    azimuth = max((row for row in departures if row.engine == engine), key=lambda row: abs(row.yaw_rad)).azimuth_deg
    case = BASELINE, engine, azimuth
    peak = next(row.peak_g for row in rows if (row.condition, row.engine, row.azimuth_deg) == case)
    if peak is None:
        return None
    turned = changed_scene(scene, BASELINE, azimuth)
    shaken = amplified(turned, peak / peak_g(turned))
    shaken = shaken.but(title=f"{scene.title}, shaken towards {azimuth:g}° with {peak:.3g} g")
    result = run_scene(shaken, [PLANAR, engine], dt_s=dt_s)
    write_result(result, folder)
    outcomes = {name: run.outcome for name, run in result.runs.items()}
    return ReplayRecord(azimuth, engine, peak, outcomes, folder.name, _command(scene, azimuth, peak, engine, dt_s))


def _command(scene: Scene, azimuth_deg: float, peak: float, engine: str, dt_s: float) -> str:
    """The command that runs the same case by itself; empty where the motion has no single key for its size."""
    given: Mapping[str, Any] = scene.given
    sized = motion_sized(scene, peak / peak_g(scene))
    if not sized or scene.source is None:
        return ""
    turn = float(given["statue"]["mesh"].get("azimuth_deg", 0.0)) - azimuth_deg
    still = "".join(f" --set motion.{axis}=none" for axis in "yz" if axis in given["motion"])
    return (
        f"rockcheck run {shlex.quote(scene.source.name)} -e {PLANAR} -e {engine} --dt {dt_s:g}"
        f" --set statue.mesh.azimuth_deg={turn:g}"
        f" --set {sized}{still}"
    )
