"""Scans inspected, prepared and made into a first scene, as the command does."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

from harness import InputError, load_scene, simulate
from harness.input.mesh_statue import steps_of
from harness.input.motions.recordfile import STANDARD_GRAVITY_M_S2, Layout
from harness.input.new_scene import QUIET_AFTER_S
from reports.cli.app import ScanOptions, SupportOptions
from reports.cli.scans import MARBLE_KG_M3, inspect, new, prepare
from reports.messages import ENGLISH
from reports.terminal import scan_lines
from tests.doubles import codes
from tests.harness.input.motions import writers
from tests.meshes import toadstool
from tests.scenes_for_tests import rectangle
from tests.scenes_for_tests import scene as scene_of

MARBLE_MASS_KG = 0.32 * MARBLE_KG_M3
"""Of the body's plinth, stem and cap: 0.072, 0.008 and 0.24 m³."""


@pytest.fixture(scope="module")
def scan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A body of known boxes as a file without units."""
    file = tmp_path_factory.mktemp("scan") / "toadstool.obj"
    toadstool.write(file)
    return file


@pytest.fixture(scope="module")
def motion(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short record of three channels in m/s², the second horizontal one the stronger."""
    file = tmp_path_factory.mktemp("motion") / "pulse.csv"
    t = np.arange(0.0, 2.0, 0.01)
    rows = np.column_stack([t, np.sin(t), 3.0 * np.sin(2.0 * t), 0.5 * np.sin(3.0 * t)])
    lines = ["t_s,a_0_ms2,a_90_ms2,a_UP_ms2", *(",".join(f"{value:.6f}" for value in row) for row in rows)]
    file.write_text("\n".join(lines) + "\n")
    return file


def test_inspect_says_what_the_statue_is(scan: Path) -> None:
    found = inspect(scan, ScanOptions(unit="m", up="z"))
    assert found.solid.density_kg_m3 == MARBLE_KG_M3
    record = found.as_dict()
    assert record["solid"]["corner_right_m"] == pytest.approx(toadstool.PLINTH_M, rel=1e-5)
    assert len(record["rose"]) == 36
    assert json.loads(json.dumps(record))["solid"]["mass_kg"] == pytest.approx(MARBLE_MASS_KG, rel=1e-6)


def test_a_weighed_mass_sets_the_density(scan: Path) -> None:
    found = inspect(scan, ScanOptions(unit="m", up="z", mass_kg=800.0))
    assert found.solid.density_kg_m3 == pytest.approx(2700.0 * 800.0 / MARBLE_MASS_KG, rel=1e-6)


@pytest.mark.parametrize(
    ("option", "known"),
    [
        ("--density", {"density_kg_m3": 0.0}),
        ("--density", {"density_kg_m3": 1e-5}),
        ("--density", {"density_kg_m3": math.nan}),
        ("--mass", {"mass_kg": -5.0}),
        ("--contact-tolerance", {"contact_tolerance_m": 0.5}),
        ("--contact-tolerance", {"contact_tolerance_m": math.nan}),
    ],
)
def test_what_no_scene_takes_is_a_mistake_of_its_option(scan: Path, option: str, known: dict[str, float]) -> None:
    with pytest.raises(InputError) as error:
        inspect(scan, ScanOptions(unit="m", up="z", **known))  # type: ignore[arg-type]
    assert [mistake.where for mistake in error.value.mistakes] == [option]


def test_prepare_writes_the_mesh_and_its_account(scan: Path, tmp_path: Path) -> None:
    found, account = prepare(scan, tmp_path / "made" / "statue.ply", ScanOptions(unit="m", up="z"))
    assert (tmp_path / "made" / "statue.ply").is_file()
    written = json.loads(account.read_text())
    assert written["known"]["unit"] == "m"
    assert written["solid"]["mass_kg"] == pytest.approx(found.solid.mass_kg if found.solid else 0.0)


@pytest.mark.parametrize(
    ("known", "said"),
    [
        (ScanOptions(up="z"), "without units"),
        (ScanOptions(unit="km"), "between"),
        (ScanOptions(unit="m", density_kg_m3=2700.0, mass_kg=700.0), "both"),
        (ScanOptions(unit="m", up="w"), "up axis"),
        (ScanOptions(unit="m", up="x"), "statue that stands"),
    ],
)
def test_mistakes_are_input_errors_and_nothing_is_written(
    scan: Path, tmp_path: Path, known: ScanOptions, said: str
) -> None:
    with pytest.raises(InputError, match=said):
        prepare(scan, tmp_path / "statue.ply", known)
    assert list(tmp_path.iterdir()) == []


def test_a_refusal_reads_as_one_sentence(scan: Path) -> None:
    with pytest.raises(InputError) as caught:
        inspect(scan, ScanOptions(up="z"))
    (found,) = caught.value.mistakes
    assert found.where == str(scan)
    assert found.wanted == "a scale"
    assert " 0.6 " in found.got
    assert re.search("--unit.*--height", found.advice)


def test_the_scan_is_never_overwritten(scan: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="another file"):
        prepare(scan, scan, ScanOptions(unit="m"))
    with pytest.raises(InputError, match="ending in"):
        prepare(scan, tmp_path / "statue.txt", ScanOptions(unit="m"))


def test_all_that_was_changed_is_printed_in_sentences(scan: Path) -> None:
    found = inspect(scan, ScanOptions(height_m=1.3, up="z"))
    steps = steps_of(found.prepared.log, ENGLISH.say)
    assert steps
    lines = scan_lines(found, 0, verbose=True)
    assert set(steps) <= set(lines)
    assert not any("ProcessingLog" in line for line in lines)


def test_new_writes_a_scene_that_loads(scan: Path, motion: Path, tmp_path: Path) -> None:
    out, found = new(scan, motion, tmp_path / "first.toml", ScanOptions(unit="m", up="z"))
    assert not {"scan_up", "scan_column", "scan_askew"} & set(codes(found))
    assert {"assumed_density", "assumed_friction", "assumed_placing", "assumed_strongest"} <= set(codes(found))
    text = out.read_text()
    assert text.count("ASSUMED") >= 4
    scene = load_scene(out)
    assert scene.statue.mass_kg == pytest.approx(MARBLE_MASS_KG, rel=1e-6)
    assert scene.statue.corner_right_m == pytest.approx(toadstool.PLINTH_M, rel=1e-5)
    assert scene.base_excitation.x.peak_m_s2 == pytest.approx(3.0, rel=1e-3)
    assert scene.base_excitation.y.peak_m_s2 == pytest.approx(1.0, rel=1e-3)
    assert scene.base_excitation.z.peak_m_s2 == pytest.approx(0.5, rel=1e-3)
    (lasts,) = [each for each in found if each.code == "assumed_duration"]
    assert scene.duration_s == pytest.approx(lasts.values["record_s"] + lasts.values["after_s"])
    assert lasts.values["after_s"] >= QUIET_AFTER_S


def test_a_scene_lasts_as_long_as_a_tall_statue_rocks(scan: Path, motion: Path, tmp_path: Path) -> None:
    """Nine metres were given the five seconds of a figurine; a block as high, let go near its balance, rocks for seventeen."""
    out, found = new(scan, motion, tmp_path / "tall.toml", ScanOptions(height_m=9.0, up="z"))
    (lasts,) = [each for each in found if each.code == "assumed_duration"]
    height_m = load_scene(out).statue.centroid_height_m
    block = rectangle(2.0 * height_m * math.tan(math.radians(15.0)), 2.0 * height_m)
    free = scene_of(block, duration_s=40.0, theta_rad=0.9 * math.radians(15.0))
    history = simulate(free, "analytic").history
    assert history is not None
    rocks_s = history.t_s[np.abs(history.theta_rad) > 0.01 * math.radians(15.0)].max()
    assert 2.0 * QUIET_AFTER_S < rocks_s == pytest.approx(lasts.values["after_s"], rel=0.1)


@pytest.mark.parametrize(
    ("x_deg", "y_deg", "weights"),
    [
        (90, 0, (0.0, 1.0)),
        (0, 90, (0.0, -1.0)),
        (332, 242, (0.0, 1.0)),
        (75, 30, (-1.0, math.sqrt(2.0))),
    ],
)
def test_the_other_channel_shakes_to_the_left_of_the_first(
    scan: Path, tmp_path: Path, x_deg: int, y_deg: int, weights: tuple[float, float]
) -> None:
    """Azimuths turn clockwise, the scene's axes the other way: a channel to the right of x would mirror the earthquake."""
    file, t_s = tmp_path / "level.csv", np.arange(0.0, 2.0, 0.01)
    rows = np.column_stack([t_s, 3.0 * np.sin(2.0 * t_s), np.sin(5.0 * t_s)])
    lines = [f"t_s,a_{x_deg}_ms2,a_{y_deg}_ms2", *(",".join(f"{value:.9f}" for value in row) for row in rows)]
    file.write_text("\n".join(lines))
    scene = load_scene(new(scan, file, tmp_path / "a.toml", ScanOptions(unit="m", up="z"))[0])
    wanted = rows[:, 1:] @ np.array(weights)
    assert scene.base_excitation.y.accel_m_s2(t_s) == pytest.approx(wanted, abs=1e-6)  # of nine decimals, turned


def test_a_record_of_the_vertical_alone_shakes_nothing_sideways(scan: Path, tmp_path: Path) -> None:
    file = tmp_path / "up.csv"
    rows = "\n".join(f"{0.01 * k:.2f},{math.sin(0.1 * k):.6f}" for k in range(200))
    file.write_text(f"t_s,a_UP_ms2\n{rows}\n")
    out, found = new(scan, file, tmp_path / "up.toml", ScanOptions(unit="m", up="z"))
    assert "assumed_no_level" in codes(found)
    assert load_scene(out).base_excitation.axes() == ("z",)


def test_new_takes_pedestal_friction_and_scale(scan: Path, motion: Path, tmp_path: Path) -> None:
    around = SupportOptions(pedestal="250,0.7,0.8,0.2", friction=0.35, scale=2.5)
    out, _ = new(scan, motion, tmp_path / "second.toml", ScanOptions(unit="m", up="z", mass_kg=650.0), around)
    scene = load_scene(out)
    told = scene.pedestal.mass_kg, scene.pedestal.width_m, scene.pedestal.depth_m, scene.pedestal.height_m
    assert told == (250.0, 0.7, 0.8, 0.2)
    assert (scene.contact.statue, scene.contact.floor_static, scene.contact.floor_kinetic) == (0.35, 0.35, 0.35)
    assert scene.statue.mass_kg == pytest.approx(650.0)
    assert scene.base_excitation.x.peak_m_s2 == pytest.approx(2.5 * 3.0, rel=1e-3)
    assert scene.base_excitation.z.peak_m_s2 == pytest.approx(2.5 * 0.5, rel=1e-3)


def test_new_takes_a_record_that_no_reader_knows(scan: Path, tmp_path: Path) -> None:
    """The options that `motion inspect` says fit the file are those of `new`, and stand in the scene."""
    text = tmp_path / "any.txt"
    text.write_text("a logger's file\n" + "".join(f"{0.1 * math.sin(0.3 * k):.5f}\n" for k in range(200)))
    layout = Layout(dt_s=0.01, skip_lines=1, columns="all")
    around = SupportOptions(motion_unit="g")
    scene = load_scene(new(scan, text, tmp_path / "any.toml", ScanOptions(unit="m", up="z"), around, layout)[0])
    assert scene.base_excitation.x.peak_m_s2 == pytest.approx(0.1 * STANDARD_GRAVITY_M_S2, rel=1e-3)


@pytest.mark.parametrize("offset_m_s2", [0.0, 0.02])
def test_new_offers_what_cures_a_record_that_drifts(scan: Path, tmp_path: Path, offset_m_s2: float) -> None:
    record = writers.at2(tmp_path / "a.AT2", writers.wave(2000) + offset_m_s2, 0.01, "090")
    made = new(scan, record, tmp_path / "any.toml", ScanOptions(unit="m", up="z"))[0]
    assert ('baseline = "linear"' in made.read_text(encoding="utf-8")) is (offset_m_s2 > 0.0)


@pytest.mark.parametrize(
    ("around", "said"),
    [
        (SupportOptions(pedestal="250,0.6"), "--pedestal: wanted "),
        (SupportOptions(pedestal="heavy,0.6,0.8,0.2"), "--pedestal: wanted "),
        (SupportOptions(pedestal="250,0.1,0.8,0.2"), "pedestal.width_m: "),
        (SupportOptions(friction=-0.1), "^--friction: contact.statue"),
        (SupportOptions(pedestal="-1,0.6,0.8,0.2"), "^--pedestal: pedestal.mass_kg"),
        (SupportOptions(scale=float("nan")), "^--scale: motion.scale"),
    ],
)
def test_wrong_surroundings_are_told_and_leave_nothing(
    scan: Path, motion: Path, tmp_path: Path, around: SupportOptions, said: str
) -> None:
    with pytest.raises(InputError, match=said):
        new(scan, motion, tmp_path / "first.toml", ScanOptions(unit="m", up="z"), around)
    assert not list(tmp_path.iterdir())


def test_new_refuses_what_exists_and_leaves_nothing_half_written(scan: Path, motion: Path, tmp_path: Path) -> None:
    taken = tmp_path / "taken.toml"
    taken.write_text("")
    for wrong, said in (
        ((scan, motion, taken), "taken.toml"),
        ((scan, motion, tmp_path / "a.txt"), "toml"),
        ((scan, tmp_path / "absent.csv", tmp_path / "a.toml"), "existing file"),
        ((tmp_path / "absent.ply", motion, tmp_path / "a.toml"), "absent.ply: "),
    ):
        with pytest.raises(InputError, match=said):
            new(*wrong, ScanOptions(unit="m"))
    assert [path.name for path in tmp_path.iterdir()] == ["taken.toml"]


def test_new_keeps_the_contact_tolerance_that_its_placing_rests_on(scan: Path, motion: Path, tmp_path: Path) -> None:
    known = ScanOptions(unit="m", up="z", contact_tolerance_m=0.004)
    scene = load_scene(new(scan, motion, tmp_path / "wide.toml", known)[0])
    assert scene.statue.solid.contact_tolerance_m == 0.004


@pytest.mark.parametrize("out", [".", "..", "new"])
def test_an_output_of_no_mesh_format_is_refused(scan: Path, out: str) -> None:
    with pytest.raises(InputError, match="a file ending in"):
        prepare(scan, Path(out), ScanOptions(unit="m"))


def test_links_that_go_round_are_no_scan(tmp_path: Path) -> None:
    (tmp_path / "loop.ply").symlink_to(tmp_path / "loop.ply")
    with pytest.raises(InputError, match="loop"):
        prepare(tmp_path / "loop.ply", tmp_path / "new.ply", ScanOptions(unit="m"))
