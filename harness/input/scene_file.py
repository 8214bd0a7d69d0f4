"""From a scene file to a scene: meshes and records are read, numbers reconciled, assumptions written down."""

from __future__ import annotations

import copy
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Final, cast

import numpy as np
from pydantic import JsonValue

from analytic.block import AnalyticInputError
from analytic.excitation import Excitation, ZeroExcitation
from harness.input import motions, tables
from harness.input.tables import (
    InitialTable,
    Overrides,
    PedestalTable,
    SceneFile,
    StatueTable,
    plain,
    replacements,
    uncertain_inputs,
)
from harness.model import (
    Array,
    BaseExcitation,
    Contact,
    Finding,
    Form,
    Initial,
    InputError,
    Mistake,
    Pedestal,
    Pose,
    Scene,
    Statue,
    Wall,
    base_end,
    block_of,
    caution,
    info,
    pedestal_of,
    refuse,
    require,
    translated,
    wall_of,
)

LARGEST_GYRATION: Final = 2.0
"""No body's radius of gyration exceeds its size; twice it leaves room for arms that the numbers do not show."""
LARGEST_M: Final = 1e4
"""No statue is longer; beyond it squares of lengths overflow."""
BELOW_M: Final = 1e-6
"""A body in contact may be this far below the floor: what rounding of a printed place leaves."""
TOLERANCE_STEP_M: Final = 1e-4
"""To which a contact tolerance is proposed."""
LIGHTEST_KG_M3: Final = 200.0
"""Cork's density; one in g/cm³ or pounds per cubic foot, and a mass in tonnes, make stone lighter."""
HEAVIEST_KG_M3: Final = 25_000.0
"""No metal is denser."""
HIGHEST_FRICTION: Final = 2.0
"""Of rubber on rough stone it is about one."""
OF_PEDESTAL: Final = ("contact.floor_impact", "model.preset", "model.friction_normal", "model.pedestal_at_impact")
"""Keys that say nothing of a statue on the floor."""
PRESETS: Final = {"consistent": Form("dynamic", "momentum"), "paper": Form("static", "unchanged")}


UNNAMED: Final = Path("scene")
"""What names a scene of no file in messages; what it names is looked for from the working directory."""


def load_scene(path: Path | str, overrides: Overrides = ()) -> Scene:
    """Read, validate and resolve a scene file.

    >>> scene = harness.load_scene("scenes/paestum_floor.toml")

    `overrides` replace keys before validation: `{"motion.x.amplitude_g": 0.4}`, or texts `KEY=VALUE` as on the command line;
    None removes a key. Raises `InputError` with every mistake found.
    """
    require(
        isinstance(path, str | os.PathLike),
        "load_scene",
        "the path of a scene file",
        type(path).__name__,
        "harness.scene(mapping) takes a scene's tables",
        key="path",
    )
    path = Path(path)
    model, content = tables.parse(tables.read(path), str(path), replacements(overrides))
    return resolve(model, path, content)


def scene(mapping: Mapping[str, object]) -> Scene:
    """A scene from the tables of a scene file as nested mappings; numbers and arrays of numpy are taken too.

    >>> scene = harness.scene({
    ...     "title": "a block", "duration_s": 5.0,
    ...     "statue": {
    ...         "mass_kg": 500.0, "centroid_height_m": 0.5, "corner_left_m": 0.1, "corner_right_m": 0.1, "inertia_kg_m2": 43.3,
    ...     },
    ...     "motion": {"x": {"kind": "harmonic", "amplitude_g": 0.3, "frequency_hz": 2.0}},
    ... })

    Files are looked for from the working directory. Raises `InputError` with every mistake found, as for a file.
    """
    require(
        isinstance(mapping, Mapping),
        "scene",
        "the tables of a scene as a mapping",
        type(mapping).__name__,
        "harness.load_scene(path) reads a file",
        key="mapping",
    )
    model, content = tables.checked(_from_here(cast(dict[str, JsonValue], plain(mapping))), str(UNNAMED))
    return resolve(model, None, content)


def changed(scene: Scene, overrides: Overrides = (), keys: Mapping[str, object] = MappingProxyType({})) -> Scene:
    """A scene with keys of its tables replaced (`Scene.replace`). Raises `InputError`, also for one made of resolved parts."""
    require(
        scene.given,
        scene.title,
        "a scene that was loaded, whose keys are known",
        "one made in Python",
        "use dataclasses.replace",
        key="overrides",
    )
    asked = replacements(overrides, keys)
    model, content = tables.checked(copy.deepcopy(dict(scene.given)), str(scene.source or UNNAMED), asked)
    if scene.source is None and (content := _from_here(content)) != scene.given:
        model, content = tables.checked(content, str(UNNAMED))
    return resolve(model, scene.source, content)


def _from_here(content: dict[str, JsonValue]) -> dict[str, JsonValue]:
    """The content of no file, its paths absolute: where it is computed the working directory may be another."""

    def absolute(key: str, value: JsonValue) -> JsonValue:
        if isinstance(value, dict):
            return _from_here(value)
        return (
            os.path.abspath(os.path.expanduser(value))
            if key == "file" and isinstance(value, str) and value[:1] != "$"
            else value
        )

    return {key: absolute(key, value) for key, value in content.items()}


Statues = dict[str, tuple["Statue", Sequence[Finding]]]
"""Statues by the text of their table, each with its findings."""


def resolve(
    model: SceneFile,
    source: Path | None,
    content: Mapping[str, JsonValue] | None = None,
    statues: Statues | None = None,
) -> Scene:
    """Resolve a validated scene; files it names are relative to the folder of its `source`, None of no file. Raises `InputError`.

    `statues` keeps those of earlier scenes of the same folder: thousands of scenes of one study share one.
    """
    path = source or UNNAMED
    found: list[Finding] = []
    mistakes: list[Mistake] = []
    base_excitation = _base_excitation(model, path, mistakes, found)
    statue = None
    try:
        statue = _statue_once(model.statue, path, found, {} if statues is None else statues)
    except InputError as error:
        mistakes.extend(error.mistakes)
    if mistakes or statue is None:
        raise InputError(mistakes)
    pedestal = _pedestal(model.pedestal, statue, path)
    if pedestal is None:
        given = model.contact.model_fields_set | model.model.model_fields_set
        also = [key for key in OF_PEDESTAL if key.split(".")[1] in given]
        found.append(info("key_not_used", keys=["contact.floor_static", "contact.floor_kinetic", *also]))
        if drawn := [f"uncertainty.{key}" for key in model.uncertainty if key.startswith("contact.floor")]:
            # A probability over it would be one of no doubt at all.
            found.append(caution("key_not_used", keys=drawn))
    preset = PRESETS[model.model.preset]
    scene = Scene(
        title=model.title,
        duration_s=model.duration_s,
        gravity_m_s2=model.gravity_m_s2,
        form=Form(
            model.model.friction_normal or preset.friction_normal,
            model.model.pedestal_at_impact or preset.pedestal_at_impact,
        ),
        statue=statue,
        pedestal=pedestal,
        contact=Contact(
            model.contact.floor_static,
            model.contact.floor_kinetic,
            model.contact.statue,
            None if model.contact.restitution == "momentum" else float(model.contact.restitution),
            model.contact.floor_impact,
        ),
        base_excitation=base_excitation,
        wall=None if model.wall is None else Wall(model.wall.side, model.wall.distance_m),
        initial=_initial(model.initial, statue, path),
        table=model.table,
        output_dt_s=model.output.dt_s,
        source=source,
        given=content or {},
        findings=tuple(found),
        uncertainty=uncertain_inputs(model, model.uncertainty),
        _reader=changed,
    )
    # Of a scan the base is known only now.
    with translated(AnalyticInputError, str(path), "a body that rocks on its base", key="statue"):
        check_wall(scene, path)
    return replace(scene, findings=(*scene.findings, *_odd_numbers(scene), *_beyond_base(scene)))


def _odd_numbers(scene: Scene) -> Iterator[Finding]:
    """Densities and friction that no material has: a unit is mistaken, or per cent are. Without a scan a statue fills its box."""
    statue, pedestal = scene.statue, scene.pedestal
    box_m3 = (statue.corner_left_m + statue.corner_right_m) * statue.depth_m * statue.height_m
    bodies = {"statue": statue.mass_kg / box_m3 if statue.solid is None else statue.solid.density_kg_m3}
    if pedestal is not None:
        bodies["pedestal"] = pedestal.mass_kg / (pedestal.width_m * pedestal.depth_m * pedestal.height_m)
    for key, density_kg_m3 in bodies.items():
        if not LIGHTEST_KG_M3 <= density_kg_m3 <= HEAVIEST_KG_M3:
            yield caution("odd_density", key=key, density_kg_m3=density_kg_m3)
    for key in ("statue",) if pedestal is None else ("statue", "floor_static", "floor_kinetic"):
        friction = getattr(scene.contact, key)
        if friction > HIGHEST_FRICTION:
            yield caution("odd_friction", key=f"contact.{key}", friction=friction)


def _beyond_base(scene: Scene) -> Iterator[Finding]:
    """What of a scan comes down before its balance and does not count as its base."""
    if scene.statue.solid is None or min((block := block_of(scene)).base_ends_rad) == math.inf:
        return
    for side, name in ((-1, "left"), (1, "right")):
        end, balance_rad = base_end(scene.statue, scene.pedestal, block, side), block.alpha_rad(side)
        if end.lean_rad < math.inf:
            tolerance_m = math.ceil(end.height_m / TOLERANCE_STEP_M) * TOLERANCE_STEP_M
            yield caution(
                "part_beyond_base",
                side=name,
                tolerance_m=round(tolerance_m, 6),
                height_m=end.height_m,
                lean_rad=end.lean_rad,
                balance_rad=balance_rad,
            )


def check_wall(scene: Scene, path: Path) -> None:
    """Raise `InputError` for a wall that the statue, as it begins, or its pedestal reaches."""
    wall, block, pedestal, theta = wall_of(scene), block_of(scene), pedestal_of(scene), scene.initial.theta_rad
    if wall is None:
        return
    mistakes, key, distance = [], "wall.distance_m", wall.distance_m
    if not (gap_m := wall.gap_m(block, 0.0)) > 0.0:
        least = f"more than {distance - gap_m:.6g} beside a statue whose outline reaches as far from its base"
        mistakes.append(Mistake(str(path), key, least, f"{distance:g}"))
    elif not wall.gap_m(block, theta) > 0.0:
        wanted = (
            f"a start before the wall, which a rotation of {scene.wall_rotation_rad:.6g} rad to the {wall.side} reaches"
        )
        mistakes.append(Mistake(str(path), "initial.theta_rad", wanted, f"{theta:g}"))
    if pedestal is not None and not (gap_m := wall.pedestal_gap_m(block, pedestal)) > 0.0:
        least = f"more than {distance - gap_m:.6g} beside a pedestal that reaches as far from the statue's base"
        mistakes.append(Mistake(str(path), key, least, f"{distance:g}"))
    refuse(mistakes)


def _initial(table: InitialTable, statue: Statue, path: Path) -> Initial:
    """The start. Raises `InputError` for a pose in which the body reaches below the floor."""
    if table.position_m is None:
        return Initial(table.theta_rad, table.theta_rate_rad_s)
    w, x, y, z = table.quaternion_wxyz or (1.0, 0.0, 0.0, 0.0)
    norm = math.hypot(w, x, y, z)
    still = (0.0, 0.0, 0.0)
    turn = (w / norm, x / norm, y / norm, z / norm)
    pose = Pose(table.position_m, turn, table.velocity_m_s or still, table.angular_velocity_rad_s or still)
    lowest = table.position_m[2] + float(np.min(statue.outer_points_m @ pose.rotation[2]))
    require(
        lowest >= -BELOW_M,
        str(path),
        f"the whole body above the floor (z = 0): the centroid at least {-lowest:.6g} m higher",
        f"its lowest point at {lowest:.6g} m",
        key="initial.position_m",
    )
    return Initial(pose=pose)


def _base_excitation(model: SceneFile, path: Path, mistakes: list[Mistake], found: list[Finding]) -> BaseExcitation:
    excitations: dict[str, Excitation] = {axis: ZeroExcitation() for axis in ("x", "y", "z")}
    for axis in excitations:
        motion = motions.SceneMotion.of(model, axis, path)
        if motion is None:
            continue
        try:
            prepared = motions.prepare(motion)
            excitations[axis] = prepared.excitation
            found.extend(replace(each, values={"key": motion.key, **each.values}) for each in prepared.findings)
        except InputError as error:
            mistakes.extend(error.mistakes)
    return BaseExcitation(**excitations)


def _pedestal(table: PedestalTable | None, statue: Statue, path: Path) -> Pedestal | None:
    if table is None:
        return None
    pedestal = Pedestal(table.mass_kg, table.width_m, table.depth_m, table.height_m, table.offset_m)
    centre = statue.base_centre_m + pedestal.offset_m
    low, high = centre - 0.5 * pedestal.width_m, centre + 0.5 * pedestal.width_m
    left, right = -statue.corner_left_m, statue.corner_right_m
    require(
        low <= left + 1e-9 and high >= right - 1e-9,
        str(path),
        f"a pedestal under the whole base (width {right - left:.4g} m, with the offset)",
        f"one from {low:.4g} to {high:.4g} m under a base from {left:.4g} to {right:.4g} m",
        key="pedestal.width_m",
    )
    return pedestal


def _statue_once(table: StatueTable, path: Path, found: list[Finding], statues: Statues) -> Statue:
    text = table.model_dump_json()
    if text not in statues:
        own: list[Finding] = []
        statues[text] = _statue(table, path, own), own
    statue, said = statues[text]
    found.extend(said)
    return statue


def _statue(table: StatueTable, path: Path, found: list[Finding]) -> Statue:
    if table.mesh is not None:
        # A block loads no reader of meshes.
        from harness.input.mesh_statue import statue_from_mesh

        return statue_from_mesh(table, table.mesh, path, found)
    numbers = [getattr(table, name) for name in tables.NUMBERS]
    # A file that lacks one was refused (`tables.checked`); a study's case or an option may take one away.
    require(None not in numbers, str(path), ", ".join(tables.NUMBERS), "not all of them", key="statue")
    mass, height_c, left, right, inertia = map(float, numbers)
    height = table.height_m
    if height is None:
        height = 2.0 * height_c
        found.append(info("key_assumed", key="statue.height_m", value=height))
    require(
        height > height_c,
        str(path),
        f"more than centroid_height_m = {height_c:g}",
        f"{height:g}",
        key="statue.height_m",
    )
    depth = table.depth_m
    if depth is None:
        depth = left + right
        found.append(info("key_assumed", key="statue.depth_m", value=depth))
    sizes = {"corner_left_m": left, "corner_right_m": right, "height_m": height, "depth_m": depth}
    mistakes = [
        Mistake(str(path), f"statue.{name}", f"a length of at most {LARGEST_M:g} m", f"{value:g}")
        for name, value in sizes.items()
        if value > LARGEST_M
    ]
    gyration, largest = math.sqrt(inertia / mass), LARGEST_GYRATION * max(height, left + right)
    if gyration > largest:
        wanted = (
            f"at most {mass * largest**2:.4g} (radius of gyration {largest:.4g} m: {LARGEST_GYRATION:g} times its size)"
        )
        mistakes.append(Mistake(str(path), "statue.inertia_kg_m2", wanted, f"{inertia:g}"))
    refuse(mistakes)
    section = np.array([[-left, 0.0], [right, 0.0], [right, height], [-left, height]])
    half = 0.5 * depth
    footprint = np.array([[-left, -half, 0.0], [right, -half, 0.0], [right, half, 0.0], [-left, half, 0.0]])
    given = table.inertia_xyz_kg_m2
    tensor = _block_tensor(mass, inertia, left + right, depth) if given is None else np.diag(given)
    return Statue(mass, height_c, left, right, inertia, height, depth, section, footprint, tensor)


def _block_tensor(mass: float, inertia: float, width: float, depth: float) -> Array:
    """Full tensor of a block known by its planar inertia: a homogeneous box of that width, depth and inertia about y.

    The box's height follows from the planar inertia, J = m (w² + H²)/12; where J is less than m w²/12 the mass sits nearer the
    axis and H = 0 is taken. Only the scene's J enters planar motion.
    """
    xx, zz = mass * width**2 / 12.0, max(inertia - mass * width**2 / 12.0, 0.0)
    yy = mass * depth**2 / 12.0
    return np.diag([yy + zz, inertia, min(xx + yy, yy + zz + inertia)])
