"""Whole and valid files of every kind, from which the mutated ones are made, and how each kind is used."""

import gzip
import struct
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Final

import numpy as np

from tests.fuzz import records, use
from tests.fuzz.mutate import BINARY, PACKED, RECORD, STEPPED, STL, TEXT, TITLED, Mutation
from tests.stores_for_tests import put


@dataclass(frozen=True)
class Kind:
    """One kind of file: its name on disk, its valid content, how it is used, how it is damaged."""

    name: str
    file: str
    content: bytes
    read: Callable[[Path], None]
    ways: tuple[Mutation, ...] = TEXT


SCENE: Final = b"""title = "a block"
duration_s = 2.0
gravity_m_s2 = 9.81
[statue]
mass_kg = 707.0
centroid_height_m = 0.774
corner_left_m = 0.3585
corner_right_m = 0.0682
inertia_kg_m2 = 152.4
height_m = 1.46
depth_m = 0.72
[pedestal]
mass_kg = 250.0
width_m = 0.60
depth_m = 0.80
height_m = 0.20
[contact]
floor_static = 0.20
floor_kinetic = 0.15
statue = 1.0
restitution = "momentum"
[motion.x]
kind = "record"
file = "motion.csv"
column = "a"
unit = "m/s2"
[motion.z]
kind = "pulse"
shape = "one_sine"
amplitude_g = 0.1
duration_s = 0.5
[wall]
side = "left"
distance_m = 0.7
[output]
dt_s = 0.001
"""
STUDY: Final = b"""title = "a grid"
scene = "good.toml"
seed = 1
samples = 3
[[vary]]
key = "motion.z.amplitude_g"
start = 0.1
stop = 0.5
count = 4
[[vary]]
key = "contact.restitution"
values = [0.85, "momentum"]
[[scatter]]
key = "statue.mass_kg"
distribution = "normal"
relative = 0.1
[[variant]]
name = "own"
engines = ["analytic"]
[accuracy]
analytic = 1e-6
[ask]
cases = "all"
"""
EFFECTS: Final = b"""kind = "effects3d"
title = "by direction"
scene = "stone.toml"
engines = ["analytic", "pybullet"]
directions = 8
every = 2
conditions = ["with the vertical component", "centroid 3 % higher"]
samples = 20
share = 0.95
[search]
most_g = 1.2
resolution = 0.002
dt_s = 0.001
"""
STONE: Final = b"""title = "a stone"
duration_s = 1.0
[statue]
mesh = { file = "stone.ply", unit = "m", density_kg_m3 = 2700.0 }
[motion.x]
kind = "pulse"
shape = "one_sine"
amplitude_g = 0.3
duration_s = 0.5
[motion.z]
kind = "pulse"
shape = "one_sine"
amplitude_g = 0.2
duration_s = 0.2
"""
EXPERIMENTS: Final = b"""test,mesh,unit,density_kg_m3,azimuth_deg,friction,motion,column,motion_unit,scale,observed
a,stone.ply,m,2700,0;10,0.4;0.6,motion.csv,a,m/s2,1.0,stands
b,stone.ply,m,2700,90,0.5,motion.csv,a,m/s2,2.0,overturned_left
c,stone.ply,cm,2600,0,0.5,motion.csv,a,m/s2,3.0,overturned
"""


UNCERTAIN: Final = (
    SCENE
    + b"""[uncertainty]
"contact.floor" = { kind = "lognormal", cov = 0.15 }
"motion.z.amplitude_g" = { kind = "uniform", half_width = 0.05 }
"statue.centroid_height_m" = { kind = "normal", sd = 0.01 }
"""
)
OPTIONS: Final = b"""[[option]]
name = "lower pedestal"
set = { "pedestal.height_m" = 0.10, "pedestal.mass_kg" = 125.0 }
[[option]]
name = "waxed floor"
set = { "contact.floor_static" = 0.15, "contact.floor_kinetic" = 0.12 }
"""
THROWN: Final = b"""title = "a square"
duration_s = 0.8
[statue]
mass_kg = 0.1
centroid_height_m = 0.03
corner_left_m = 0.03
corner_right_m = 0.03
inertia_kg_m2 = 6.0e-5
inertia_xyz_kg_m2 = [6.0e-5, 6.0e-5, 6.0e-5]
height_m = 0.06
depth_m = 0.06
[contact]
statue = 0.15
restitution = 0.5
[initial]
position_m = [0.0, 0.0, 0.15]
velocity_m_s = [-0.6, 0.0, -1.7]
angular_velocity_rad_s = [0.0, 3.0, 0.0]
"""
RATIOS: Final = b"""group,trial,width_m,height_m,depth_m,mass_kg,ratio_measured
a,1,0.100,0.300,0.200,15.0,0.852
a,2,0.100,0.300,0.200,15.0,0.861
b,1,0.150,0.300,0.200,22.5,0.701
"""


NEW: Final = (
    b"--motion motion.csv --motion-unit m/s2 --unit m --up z --density 2700.0\n--pedestal 250.0,0.6,0.8,0.2 --friction 0.35"
    b" --scale 1.5 --contact-tolerance 0.002\n"
)
RUN: Final = (
    b"-e analytic --accuracy 1.0e-4 --set motion.z.amplitude_g=0.30 --set pedestal.offset_m=0.010\n"
    b"--set contact.restitution=0.90 --set 'statue.mass_kg=650.0' --language it\n"
)
OF_ASSESS: Final = (
    b"-e pymunk --seed 3 --half-width 0.10 --most-runs 40 --set contact.restitution=0.90\n"
    b"--set statue.mass_kg=650.0 --no-options\n"
)
DESCRIBED: Final = b"--skip-lines 2 --time-column 1\n--columns 2:N,3:E --unit gal\n"


def _wave() -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    t = np.arange(120) * 0.02
    return np.column_stack([t, 3.0 * np.sin(2.0 * np.pi * t) * np.sin(np.pi * t / t[-1])])


def _csv(header: str, rows: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> bytes:
    lines = [header, *(",".join(f"{value:.9g}" for value in row) for row in rows)]
    return ("\n".join(lines) + "\n").encode()


def _history() -> bytes:
    wave = _wave()
    rate = np.gradient(wave[:, 1], wave[:, 0])
    zero = np.zeros(len(wave))
    return _csv("t_s,theta_rad,theta_rate_rad_s,slip_m,slip_rate_m_s", np.column_stack([wave, rate, zero, zero]))


def _corners() -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return np.array([[x, y, z] for z in (0.0, 0.9) for y in (-0.1, 0.1) for x in (-0.12, 0.12)])


FACES: Final = (
    (0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6),
    (1, 3, 5), (3, 7, 5),
)  # fmt: skip


def obj() -> bytes:
    """A box as OBJ."""
    vertices = [f"v {x:g} {y:g} {z:g}" for x, y, z in _corners()]
    return ("\n".join([*vertices, *(f"f {a + 1} {b + 1} {c + 1}" for a, b, c in FACES)]) + "\n").encode()


def ply() -> bytes:
    """The same box as PLY."""
    head = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n"
    head += "element face 12\nproperty list uchar int vertex_indices\nend_header\n"
    body = [f"{x:g} {y:g} {z:g}" for x, y, z in _corners()] + [f"3 {a} {b} {c}" for a, b, c in FACES]
    return (head + "\n".join(body) + "\n").encode()


def stl() -> bytes:
    """The same box as binary STL."""
    corners = _corners()
    rows = [struct.pack("<12fH", 0.0, 0.0, 0.0, *(float(v) for i in face for v in corners[i]), 0) for face in FACES]
    return b"\0" * 80 + struct.pack("<I", len(rows)) + b"".join(rows)


def drops() -> bytes:
    """Two drops of the square that fly, land and lie still at once."""
    rows = [",".join(("drop", "row", "x_m", "z_m", "theta_rad", "vx_m_s", "vz_m_s", "omega_rad_s"))]
    for name, spin in (("a", 1.5), ("b", -2.5)):
        for k in range(40):
            t = k / 250.0
            z = 0.15 - 0.5 * t - 0.5 * 9.81 * t * t
            flies = z > 0.043
            rows.append(
                f"{name},{k},{0.3 * t:.6f},{z if flies else 0.03:.6f},{spin * t if flies else 0.0:.6f},0.3,-0.5,{spin}"
            )
    return ("\n".join(rows) + "\n").encode()


def tosses() -> bytes:
    """Two tosses of the square that fly and land level, without a turn."""
    place = ("x_m", "y_m", "z_m", "qw", "qx", "qy", "qz")
    rows = [",".join(("toss", "t_s", *place, "vx_m_s", "vy_m_s", "vz_m_s", "wx_rad_s", "wy_rad_s", "wz_rad_s"))]
    for name, speed in (("a", 0.4), ("b", -0.2)):
        for k in range(30):
            t = k / 148.0
            z = max(0.12 - 0.5 * 9.81 * t * t, 0.03)
            rows.append(
                f"{name},{t:.6f},{speed * t:.6f},0.0,{z:.6f},1.0,0.0,0.0,0.0,{speed},0.0,{-9.81 * t:.6f},0.0,0.0,0.0"
            )
    return ("\n".join(rows) + "\n").encode()


def _store() -> bytes:
    """A store with one result and its history."""
    from harness.accuracy.refinement import simulate
    from harness.questions.bench.standard_scenes import COLUMN, harmonic, scene_of
    from harness.runs.store import Store

    scene = scene_of("stored", {"duration_s": 0.5, "statue": COLUMN, "motion": harmonic(0.3, 2.0)})
    run = simulate(scene, "analytic")
    with tempfile.TemporaryDirectory(prefix="rockcheck-fuzz-") as name:
        path = Path(name) / "store.sqlite"
        with Store(path) as store:
            put(store, [("key", run)], histories=True)
        return path.read_bytes()


def _result() -> bytes:
    """The record of a result that was written into a folder, with the checksums of its histories."""
    with tempfile.TemporaryDirectory(prefix="rockcheck-fuzz-") as name:
        folder = Path(name)
        prepare(folder)
        use.write_into(folder / "good.toml", folder / use.WRITTEN)
        return (folder / use.WRITTEN / "result.json").read_bytes()


def prepare(folder: Path) -> None:
    """The files that mutated scenes, studies and tables may still name."""
    (folder / "motion.csv").write_bytes(_csv("t_s,a", _wave()))
    (folder / "stone.ply").write_bytes(ply())
    (folder / "good.toml").write_bytes(SCENE)
    (folder / "stone.toml").write_bytes(STONE)
    (folder / "uncertain.toml").write_bytes(UNCERTAIN)
    (folder / "thrown.toml").write_bytes(THROWN)
    rows = (f"{t:.3f} {100.0 * a:.6f} {40.0 * a:.6f}" for t, a in _wave())
    (folder / "any.txt").write_text("\n".join(["Somewhere", "as found", *rows, ""]))


@lru_cache(maxsize=1)
def kinds() -> tuple[Kind, ...]:
    """Every kind of file that a user can hand in."""
    return (
        Kind("scene", "scene.toml", SCENE, use.scene),
        Kind("study", "study.toml", STUDY, use.study),
        Kind("3D effects", "effects.toml", EFFECTS, use.effects),
        Kind("experiments", "experiments.csv", EXPERIMENTS, use.experiments),
        Kind("validate", "tests.csv", EXPERIMENTS.replace(b",cm,", b",m,"), use.validate),
        Kind("impact ratios", "ratios.csv", RATIOS, use.ratios),
        Kind("drops", "drops.csv", drops(), use.drops),
        Kind("tosses", "tosses.csv", tosses(), use.tosses),
        Kind("assess", "assessed.toml", UNCERTAIN, use.assess),
        Kind("options of the owner", "options.toml", OPTIONS, use.options),
        Kind("options of assess", "assess.txt", OF_ASSESS, use.options_of_assess),
        Kind("trust", "mapped.toml", SCENE, use.trust),
        Kind("options of new", "new.txt", NEW, use.new),
        Kind("options of run", "run.txt", RUN, use.run),
        Kind("options of a text", "described.txt", DESCRIBED, use.described),
        Kind("motion CSV", "mutated_motion.csv", _csv("t_s,a_ms2", _wave()), use.motion),
        *(Kind(f"motion {name}", file, make(), use.motion) for name, (file, make) in records.FORMATS.items()),
        Kind("history", "history.csv", _history(), use.history),
        Kind("mesh OBJ", "mutated.obj", obj(), use.mesh),
        Kind("mesh PLY", "mutated.ply", ply(), use.mesh),
        Kind("mesh STL", "mutated.stl", stl(), use.mesh, STL),
        Kind("store", "store.sqlite", _store(), use.store, BINARY),
        Kind("title", "titled.toml", SCENE, use.title, TITLED),
        Kind("AT2 header", "stepped.at2", records.at2(), use.step, STEPPED),
        Kind("gzip", "packed.at2.gz", gzip.compress(records.at2(), mtime=0), use.packed, PACKED),
        Kind("sister in gzip", "RSN1_B_180.at2", gzip.compress(records.at2(), mtime=0), use.sister, PACKED),
        Kind("record", "record.json", _result(), use.result),
        Kind("output folder", "result.json", _result(), use.folder, RECORD),
    )
