"""One case of an effects study run with histories, to be watched: where 3D leaves the plane most."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from harness.effects3d.conditions import amplified, changed_scene
from harness.effects3d.search import EXACT, peak_g
from harness.model.scene import Scene
from harness.model.written import scan_azimuth_deg, written
from harness.records.effects3d import BASELINE, SOLID, Amplitude, Departure, ReplayRecord
from harness.scene_run.scene_run import run_scene, write_result
from harness.statics.standstill import motion_sized

PLANAR: Final = "analytic"


def write_replay(
    scene: Scene, rows: Sequence[Amplitude], departures: Sequence[Departure], dt_s: float, folder: Path
) -> ReplayRecord | None:
    """Run the direction whose motion turns most about the vertical, at its overturning amplitude, into `folder`; say what it is.

    By a contact engine where one was asked: there the exact model may slide for a million steps. None when no engine
    overturned the statue in any direction whose motion was followed.
    """
    yaw_rad = {row.azimuth_deg: abs(row.yaw_rad) for row in departures}
    overturned = [row for row in rows if row.condition == BASELINE and row.peak_g and row.azimuth_deg in yaw_rad]
    chosen = max(
        (row for row in overturned if row.engine in SOLID),
        key=lambda row: (row.engine != EXACT, yaw_rad[row.azimuth_deg]),
        default=None,
    )
    if chosen is None or chosen.peak_g is None:
        return None
    engine, azimuth, peak = chosen.engine, chosen.azimuth_deg, chosen.peak_g
    turned = changed_scene(scene, BASELINE, azimuth)
    shaken = amplified(turned, peak / peak_g(turned))
    shaken = replace(shaken, title=f"{scene.title}, shaken towards {azimuth:g}° with {peak:.3g} g")
    result = run_scene(shaken, [PLANAR, engine], dt_s=dt_s)
    write_result(result, folder)
    outcomes = {name: run.outcome for name, run in result.runs.items()}
    return ReplayRecord(azimuth, engine, peak, outcomes, folder.name, _command(scene, azimuth, peak, engine, dt_s))


def _command(scene: Scene, azimuth_deg: float, peak: float, engine: str, dt_s: float) -> str:
    """The command that runs the same case by itself; empty where the motion has no single key for its size."""
    sized = motion_sized(scene, peak / peak_g(scene))
    if not sized or scene.source is None:
        return ""
    turn = scan_azimuth_deg(scene) - azimuth_deg
    still = "".join(f" --set motion.{axis}=none" for axis in "yz" if written(scene, "motion", axis) is not None)
    return (
        f"rockcheck run {shlex.quote(scene.source.name)} -e {PLANAR} -e {engine} --dt {dt_s:g}"
        f" --set statue.mesh.azimuth_deg={turn:g}"
        f" --set {sized}{still}"
    )
