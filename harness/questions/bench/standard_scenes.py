"""The standard set: scenes from easy to hard, each with what its error is measured against."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Literal, cast

from harness.input.files import DATA_VARIABLE
from harness.model import InputError, Scene
from harness.questions.effects3d import RAGGED_M, RAGGED_SEED, RAGGED_SPACING_M, with_solid
from harness.questions.study.cases import BaseScene
from harness.records.base import Table
from meshes.survey import ragged

PAESTUM: Final = {
    "mass_kg": 707.0, "centroid_height_m": 0.774, "corner_left_m": 0.3585, "corner_right_m": 0.0682,
    "inertia_kg_m2": 152.4, "height_m": 1.46, "depth_m": 0.72,
}  # fmt: skip
"""The surveyed statue of the paper (docs/model.md, section 1)."""
PEDESTAL: Final = {"mass_kg": 250.0, "width_m": 0.60, "depth_m": 0.80, "height_m": 0.20}
COLUMN: Final = {
    "mass_kg": 300.0, "centroid_height_m": 0.5, "corner_left_m": 0.1, "corner_right_m": 0.1,
    "inertia_kg_m2": 26.0, "height_m": 1.0, "depth_m": 0.2,
}  # fmt: skip
"""A homogeneous block 0.2 m wide, 1 m high (docs/model.md, section 7)."""
RECORDS: Final = "${" + DATA_VARIABLE + "}/records"
MESHES: Final = "${" + DATA_VARIABLE + "}/meshes"
SCENES: Final = Path(__file__).parents[3] / "scenes"
"""The scenes that are shipped."""
STONE: Final = {"mass_kg": 400.0, "width_m": 1.0, "depth_m": 1.0, "height_m": 0.3}
"""A pedestal wide enough for the Maria's base."""


@dataclass(frozen=True)
class Standard:
    """One scene of the set: its name, its content as in a scene file, and its reference.

    `reference`: `analytic` where the two-block model is exact for the scene, `own` for each engine's own finest level.
    `block`: given by numbers alone, so that every engine is asked for its speed. `spatial`: asked of 3D engines alone.
    `ragged_m`: the unevenness given to its flat base.
    """

    name: str
    content: Mapping[str, object]
    reference: Literal["analytic", "own"]
    block: bool = True
    spatial: bool = False
    ragged_m: float = 0.0

    def scene(self) -> Scene:
        """The scene resolved; raises `InputError` where a file that it names is absent."""
        scene = scene_of(self.name, self.content)
        if self.ragged_m == 0.0 or scene.statue.solid is None:
            return scene
        return with_solid(
            scene, ragged(scene.statue.solid, self.ragged_m, spacing_m=RAGGED_SPACING_M, seed=RAGGED_SEED)
        )


def scene_of(title: str, content: Mapping[str, object]) -> Scene:
    """A scene from the content of a scene file (without its title). Raises `InputError`."""
    return BaseScene(Path("scene.toml"), {"title": title, **cast(Table, content)}).scene({})


def harmonic(amplitude_g: float, frequency_hz: float) -> dict[str, object]:
    """A sine from t = 0."""
    return {"x": {"kind": "harmonic", "amplitude_g": amplitude_g, "frequency_hz": frequency_hz}}


def record(file: str, column: str, **more: Any) -> dict[str, object]:
    """A channel of a record in the data folder."""
    return {"kind": "record", "file": f"{RECORDS}/{file}", "column": column, "unit": "m/s2", **more}


EQUAL: Final = {"floor_static": 0.15, "floor_kinetic": 0.15}
TWO: Final = {"floor_static": 0.20, "floor_kinetic": 0.15}


def standard_set() -> Sequence[Standard]:
    """The scenes in the order of the report."""
    free = {"duration_s": 2.0, "statue": COLUMN, "initial": {"theta_rad": 0.0987}}
    pulse = {"kind": "pulse", "shape": "one_sine", "amplitude_g": 0.28, "duration_s": 0.5}
    west = record("coalinga1983_PFZ14.csv", "a_90_ms2", pga_g=0.8, window_s=[5.0, 9.0])
    north = record("coalinga1983_PFZ14.csv", "a_0_ms2", pga_g=0.8, window_s=[5.0, 9.0])
    scan = {"mesh": {"file": f"{MESHES}/maria_acephalous.obj", "unit": "m", "density_kg_m3": 2700.0}}
    shipped = {"mesh": {"file": str(SCENES / "togatus.ply"), "unit": "m", "up": "z", "density_kg_m3": 2700.0}}
    two = {**TWO, "statue": 1.0}
    stands = {"floor_static": 0.7, "floor_kinetic": 0.6, "statue": 1.0}
    centro = record("elcentro1940_NS.csv", "a_NS_ms2")
    return (
        Standard("free rocking", free, "analytic"),
        Standard(
            "one sine pulse",
            {"duration_s": 1.5, "statue": COLUMN, "motion": {"x": pulse}},
            "analytic",
        ),
        Standard(
            "harmonic, no pedestal",
            {"duration_s": 1.0, "statue": PAESTUM, "motion": harmonic(0.429, 3.0)},
            "analytic",
        ),
        Standard(
            "harmonic, pedestal",
            {"duration_s": 1.0, "statue": PAESTUM, "pedestal": PEDESTAL, "contact": EQUAL, "motion": harmonic(0.429, 3.0)},
            "analytic",
        ),
        Standard(
            "harmonic, pedestal, two friction coefficients",
            {"duration_s": 1.0, "statue": PAESTUM, "pedestal": PEDESTAL, "contact": TWO, "motion": harmonic(0.334, 2.0)},
            "analytic",
        ),
        Standard("El Centro 1940, block", {"duration_s": 3.0, "statue": PAESTUM, "motion": {"x": centro}}, "analytic"),
        Standard(
            "Maria (scan), Coalinga 1983, planar",
            {"duration_s": 3.0, "statue": scan, "contact": {"statue": 1.0}, "motion": {"x": west}},
            "own",
            block=False,
        ),
        Standard(
            "Maria (scan), Coalinga 1983, two directions",
            {"duration_s": 3.0, "statue": scan, "contact": {"statue": 1.0}, "motion": {"x": west, "y": north}},
            "own",
            block=False,
            spatial=True,
        ),
        Standard(
            "shipped statue (scan) on its pedestal, harmonic",
            {"duration_s": 2.0, "statue": shipped, "pedestal": PEDESTAL, "contact": two, "motion": harmonic(0.429, 3.0)},
            "own",
            block=False,
        ),
        Standard(
            "Maria (scan) on a pedestal, harmonic",
            {"duration_s": 1.5, "statue": scan, "pedestal": STONE, "contact": stands, "motion": harmonic(0.6, 2.0)},
            "own",
            block=False,
        ),
        Standard(
            "Maria (scan), its base rough by 1 mm, Coalinga 1983",
            {"duration_s": 3.0, "statue": scan, "contact": {"statue": 1.0}, "motion": {"x": west}},
            "own",
            block=False,
            ragged_m=RAGGED_M,
        ),
    )  # fmt: skip


def resolved(items: Sequence[Standard]) -> tuple[list[tuple[Standard, Scene]], dict[str, str]]:
    """The scenes that can be had, and why the others cannot, by name."""
    scenes, absent = [], {}
    for item in items:
        try:
            scenes.append((item, item.scene()))
        except InputError as error:
            absent[item.name] = str(error)
    return scenes, absent
