"""The text of a first scene from a scan and a record: every line that was assumed says so."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from analytic.block import GRAVITY_M_S2
from harness.input.mesh_statue import findings_of, steps_of
from harness.input.motions.recordfile import Channel, RecordFile
from harness.input.motions.records import AZIMUTH_TOLERANCE_DEG, LEAST_CROSSING_DEG, crossing_deg
from harness.model import Finding, Say, caution, info
from meshes.footprint import slenderness_rose_rad, weakest_azimuth_deg
from meshes.prepare import Inspection
from meshes.solid import CONTACT_TOLERANCE_M

QUIET_AFTER_S = 5.0
"""Time left after the record in which the statue may still rock, at least."""
RESTS: Final = 21.0
"""Times 1/p (p² = 3g/4h) in which a block of slenderness 15° comes to rest from nine tenths of its balance, of any size."""
STONE_ON_STONE = 0.6
"""Friction assumed where nothing is said: stone on stone, dry."""

Part = tuple[Sequence[str | Finding], Mapping[str, object]]
"""Comments, what is assumed among them, and the keys that stand under them."""


def first_scene(
    inspection: Inspection,
    scan: Path,
    mesh: Path,
    shaking: RecordFile,
    motion: Path,
    say: Say,
    *,
    density_kg_m3: float | None = None,
    mass_kg: float | None = None,
    pedestal: Mapping[str, float] | None = None,
    friction: float | None = None,
    scale: float | None = None,
    read_as: Mapping[str, object],
) -> tuple[str, list[Finding]]:
    """A commented scene (TOML), and what it assumes: the weakest direction towards +x, the strongest horizontal channel along x,
    the others kept.

    What a user does not say beside scan and record is None: it is assumed, and said so. `read_as` are keys of a component that
    tell how the record's file is read.
    """
    import tomli_w

    channels = _by_axis(shaking)
    end = max(float(channel.t_s[-1] - channel.t_s[0]) for channel in channels.values())
    height_m = 0.0 if inspection.solid is None else inspection.solid.centroid_height_m
    quiet_s = max(QUIET_AFTER_S, RESTS * math.sqrt(height_m / (0.75 * GRAVITY_M_S2)))
    duration_s = float(np.ceil(end + quiet_s))
    top = {"title": f"{scan.stem} under {motion.stem}", "duration_s": duration_s}
    parts: list[Part] = [
        (
            [
                f"{scan.stem} under {motion.name}: a first scene, to be read and corrected.",
                "Lines marked ASSUMED are choices made for you.",
                info("assumed_duration", record_s=end, after_s=duration_s - end),
            ],
            top,
        ),
        _statue(inspection, scan, mesh, mass_kg, say, assumed=density_kg_m3 is None and mass_kg is None),
        *_support(pedestal, friction),
        *_motion(channels, shaking, motion, mesh.parent, scale, read_as),
    ]

    def line(comment: str | Finding) -> str:
        return f"# {comment if isinstance(comment, str) else f'ASSUMED: {say(comment)}'}\n"

    text = "\n".join("".join(map(line, comments)) + tomli_w.dumps(keys) for comments, keys in parts)
    return text, [each for comments, _ in parts for each in comments if isinstance(each, Finding)]


def _statue(inspection: Inspection, scan: Path, mesh: Path, mass_kg: float | None, say: Say, *, assumed: bool) -> Part:
    """The scan, and its mass as weighed or by a density that may be assumed."""
    solid = inspection.solid
    if solid is None:
        raise ValueError("a scene needs a statue that stands")
    weakest = weakest_azimuth_deg(solid.footprint_m)
    slender = float(slenderness_rose_rad(solid.footprint_m, solid.centroid_height_m, weakest)[0])
    told = [info("assumed_placing", slenderness_rad=slender)]
    density = f"{solid.density_kg_m3:g} kg/m³"
    if assumed:
        told = [caution("assumed_density", density_kg_m3=solid.density_kg_m3), *told]
    placing = {"file": mesh.name, "unit": "m", "up": "z", "azimuth_deg": round(-weakest, 2) + 0.0}
    if solid.contact_tolerance_m != CONTACT_TOLERANCE_M:
        placing["contact_tolerance_m"] = solid.contact_tolerance_m
    keys: dict[str, object] = {"mesh": placing | {"density_kg_m3": solid.density_kg_m3}}
    if mass_kg is not None:
        density, keys = f"from the weighed {mass_kg:g} kg", {"mass_kg": mass_kg, "mesh": placing}
    comments: list[str | Finding] = [
        f"Prepared from {scan.name}; what was changed stands in {mesh.with_suffix('.account.json').name}.",
        *(f"  {step}" for step in steps_of(inspection.prepared.log, say)),
        *(f"  FOUND: {say(each)}" for each in findings_of(inspection.prepared.log.found)),
        f"{solid.mass_kg:.5g} kg, {solid.height_m:.4g} m high, centroid at {solid.centroid_height_m:.4g} m;"
        f" density: {density}.",
        *told,
    ]
    return comments, {"statue": keys}


def _support(pedestal: Mapping[str, float] | None, friction: float | None) -> Iterator[Part]:
    """What the statue stands on, and the friction there."""
    mu = STONE_ON_STONE if friction is None else friction
    comments: list[str | Finding] = [
        "The analytic model takes the statue not to slip and reports what friction that needed.",
        caution("assumed_friction", friction=mu) if friction is None else "As given.",
    ]
    contact = {"statue": mu}
    if pedestal is not None:
        yield ["As given."], {"pedestal": dict(pedestal)}
        comments.append(caution("assumed_floor_friction", friction=mu))
        contact |= {"floor_static": mu, "floor_kinetic": mu}
    yield comments, {"contact": contact}


def _by_axis(shaking: RecordFile) -> dict[str, Channel]:
    """The strongest horizontal channel as x, the next as y, the vertical one as z."""
    vertical = list(shaking.verticals)
    level = [channel for channel in shaking.channels if channel not in vertical]
    level.sort(key=lambda channel: float(np.abs(channel.accel_m_s2).max()), reverse=True)
    return dict(zip("xy", level, strict=False)) | dict(zip("z", vertical, strict=False))


ACROSS: Final = "The other horizontal channel across it (3D engines only)"


def _across(along: Channel, other: Channel, shaking: RecordFile) -> tuple[str, dict[str, object]]:
    """What of a record shakes to the left of `along`, as y lies of x: else the earthquake would be its mirror image.

    The other channel as it is where nobody knows how the two lie.
    """
    x, y = along.orientation.azimuth_deg, other.orientation.azimuth_deg
    taken: dict[str, object] = {"column": other.name}
    if x is None or y is None or len(shaking.horizontals) > 2:
        return ACROSS, taken
    clockwise = (y - x) % 360.0
    if abs(clockwise % 180.0 - 90.0) > AZIMUTH_TOLERANCE_DEG and crossing_deg(along, other) >= LEAST_CROSSING_DEG:
        return "Both horizontal channels, turned to what lies across it (3D engines only)", {
            "azimuth_deg": (x - 90.0) % 360.0
        }
    if clockwise < 180.0:
        return f"{ACROSS}; it points to the right of x, and y to the left", taken | {"sign": -1}
    return ACROSS, taken


def _motion(
    channels: Mapping[str, Channel],
    shaking: RecordFile,
    motion: Path,
    folder: Path,
    scale: float | None,
    read_as: Mapping[str, object],
) -> Iterator[Part]:
    """The components of the floor's motion, and which channels of the record make them."""
    comments: list[str | Finding] = []
    unused = [channel.name for channel in shaking.channels if channel not in channels.values()]
    if unused:
        comments.append(caution("assumed_not_needed", file=motion.name, channels=unused))
    if "x" not in channels:
        comments.append(caution("assumed_no_level"))
    unknown = [c.name for c in channels.values() if c.orientation.azimuth_deg is None and not c.orientation.vertical]
    if len(shaking.channels) > 1 and unknown:
        comments.append(caution("assumed_level", channels=unknown))
    if scale is not None:
        yield (
            [*comments, "As given: every component is this many times the record."],
            {"motion": {"scale": scale}},
        )
        comments = []
    why: Mapping[str, str | Finding] = {
        "x": info("assumed_strongest", channel=next(iter(channels.values())).name),
        "z": "The vertical channel",
    }
    for axis, channel in channels.items():
        file = os.path.relpath(motion.resolve(), folder.resolve())
        taken: dict[str, object] = {"column": channel.name}
        comment = why.get(axis, "")
        if axis == "y":
            comment, taken = _across(channels["x"], channel, shaking)
        keys = {"kind": "record", "file": file, **taken}
        keys |= {key: value for key, value in read_as.items() if value is not None}
        peak = float(np.abs(channel.accel_m_s2).max())
        yield [*comments, comment, f"Peak {peak:.3g} m/s²."], {"motion": {axis: keys}}
        comments = []
        if any(each.code == "record_drifts" and each.values["channel"] == channel.name for each in shaking.findings):
            # A key to be uncommented stands after the others of its table.
            yield ['baseline = "linear"  # integrated, the record drifts: take the first # away to take that off'], {}
