"""The text of a first scene from a scan and a record: every line that was assumed says so."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from harness.input.motions.check import DRIFTS
from harness.input.motions.recordfile import Channel, RecordFile

if TYPE_CHECKING:
    from meshes.inspection import Inspection

QUIET_AFTER_S = 5.0
"""Time left after the record for the statue to come to rest."""


def scene_text(
    found: Inspection,
    scan: Path,
    mesh: Path,
    shaking: RecordFile,
    motion: Path,
    density_kg_m3: float | None,
    mass_kg: float | None,
    unit_of_motion: str | None,
) -> str:
    """A commented scene (TOML): the weakest direction towards +x, the strongest horizontal channel along x, the
    others kept."""
    from meshes import footprint as base

    solid = found.solid
    if solid is None:
        raise ValueError("a scene needs a statue that stands")
    weakest = base.weakest_azimuth_deg(solid.footprint_m)
    slender = float(np.rad2deg(base.slenderness_rose_rad(solid.footprint_m, solid.centroid_height_m, weakest)[0]))
    channels = _by_axis(shaking)
    end = max(float(channel.t_s[-1] - channel.t_s[0]) for channel in channels.values())
    said = (
        f"{density_kg_m3:g} kg/m³, as given" if density_kg_m3 else f"from the weighed {mass_kg:g} kg" if mass_kg else ""
    )
    density = said or f"ASSUMED: marble, {solid.density_kg_m3:g} kg/m³; give --density or --mass for another"
    lines = [
        f"# {scan.stem} under {motion.name}: a first scene, to be read and corrected.",
        "# Lines marked ASSUMED are choices made for you.",
        f"title = {json.dumps(f'{scan.stem} under {motion.stem}', ensure_ascii=False)}",
        f"duration_s = {np.ceil(end + QUIET_AFTER_S):.1f}  # the record's {end:.4g} s and {QUIET_AFTER_S:g} s to"
        f" come to rest",
        "",
        "[statue]",
        f"# Prepared from {scan.name}; what was changed stands in {mesh.with_suffix('.account.json').name}.",
        *(f"#   {change}" for change in found.prepared.account.changes),
        f"# {solid.mass_kg:.5g} kg, {solid.height_m:.4g} m high, centroid at {solid.centroid_height_m:.4g} m;"
        f" density: {density}.",
        f"# ASSUMED: turned so that its weakest direction ({slender:.1f}°) lies along +x: the least favourable"
        f" placing.",
    ]
    if mass_kg is not None:
        lines.append(f"mass_kg = {mass_kg!r}")
    given = "" if mass_kg is not None else f", density_kg_m3 = {solid.density_kg_m3!r}"
    lines += [
        f'mesh = {{ file = {json.dumps(mesh.name)}, unit = "m", up = "z", azimuth_deg = {-weakest:.2f}{given} }}',
        "",
        "[contact]",
        "# ASSUMED: stone on stone, dry; the analytic model takes the statue not to slip and reports what friction"
        " that needed.",
        "statue = 0.6",
    ]
    unused = [channel.name for channel in shaking.channels if channel not in channels.values()]
    if unused:
        lines += [
            "",
            f"# LEFT OUT of {motion.name}: {', '.join(unused)}; give a channel as [motion.z] if it is the vertical one.",
        ]
    unknown = [c.name for c in channels.values() if c.orientation.azimuth_deg is None and not c.orientation.vertical]
    if len(shaking.channels) > 1 and unknown:
        lines += ["", f"# ASSUMED: level, for the file does not say where they point: {', '.join(unknown)}."]
    for axis, channel in channels.items():
        lines += ["", *_motion_lines(axis, channel, shaking, motion, mesh.parent, unit_of_motion)]
    return "\n".join(lines) + "\n"


def _by_axis(shaking: RecordFile) -> dict[str, Channel]:
    """The strongest horizontal channel as x, the other as y, the vertical one as z; a lone channel is x."""
    vertical = list(shaking.verticals)
    level = [channel for channel in shaking.channels if channel not in vertical] or list(shaking.channels)
    level.sort(key=lambda channel: float(np.abs(channel.accel_m_s2).max()), reverse=True)
    found = {"x": level[0]}
    if len(level) > 1:
        found["y"] = level[1]
    if vertical:
        found["z"] = vertical[0]
    return found


def _motion_lines(
    axis: str, channel: Channel, shaking: RecordFile, motion: Path, folder: Path, unit_of_motion: str | None
) -> list[str]:
    """One component of the floor's motion."""
    why = {
        "x": "ASSUMED: the strongest horizontal channel in the rocking plane",
        "y": "the other horizontal channel across it (3D engines only)",
        "z": "the vertical channel",
    }[axis]
    peak = float(np.abs(channel.accel_m_s2).max())
    lines = [
        f"[motion.{axis}]  # {why}; peak {peak:.3g} m/s²",
        'kind = "record"',
        f"file = {json.dumps(os.path.relpath(motion.resolve(), folder.resolve()), ensure_ascii=False)}",
        f"column = {json.dumps(channel.name)}",
    ]
    if unit_of_motion is not None:
        lines.append(f"unit = {json.dumps(unit_of_motion)}")
    if any(said.startswith(f"{channel.name}{DRIFTS}") for said in shaking.warnings):
        lines.append('# baseline = "linear"  # integrated, the record drifts: take the first # away to take that off')
    return lines
