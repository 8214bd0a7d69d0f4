"""Which way is up: busts, columns, vases and slabs of known truth, however they lie, stand right or are refused."""

from collections.abc import Callable, Sequence

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from meshes import MeshError, Solid
from meshes.mesh import Array, Doubt, RawMesh
from meshes.orientation import find_orientation, turn_axis, up_doubted
from meshes.prepare import Wanted, prepare_mesh
from meshes.repair import Part
from tests.budgets_meshes import LEVELLED_RAD, NAMED_UP_RAD
from tests.meshes.loft import loft
from tests.meshes.shapes import box, prism

AROUND = 72


def turned(profile: Sequence[tuple[float, float]], open_below: bool = False, open_above: bool = False) -> Part:
    """A body of revolution about z of a profile (radius, height) from below, densely meshed, its ends as well."""
    corners = np.array(profile)
    along = np.r_[0.0, np.cumsum(np.hypot(*np.diff(corners, axis=0).T))]
    fine = np.unique(np.r_[along, np.linspace(0.0, along[-1], 60)])
    radius, height = (np.interp(fine, along, column) for column in corners.T)
    shares = np.linspace(0.02, 1.0, 10)[:-1]
    below = [] if open_below else [(share * radius[0], height[0]) for share in shares]
    above = [] if open_above else [(share * radius[-1], height[-1]) for share in shares[::-1]]
    angle = 2.0 * np.pi * np.arange(AROUND) / AROUND
    rings = [
        np.column_stack([r * np.cos(angle), r * np.sin(angle), np.full(AROUND, z)])
        for r, z in [*below, *zip(radius, height, strict=True), *above]
    ]
    vertices, faces = loft(np.stack(rings))
    ends = [(0, AROUND)] * open_below + [(len(vertices) - AROUND, len(vertices))] * open_above
    kept = np.ones(len(faces), dtype=bool)
    for begin, end in ends:
        kept &= ~((faces >= begin) & (faces < end)).all(axis=1)
    return vertices, faces[kept]


def bust(ragged_m: float, crown: float = 1.0, tilt_deg: float = 0.0, seed: int = 0) -> Part:
    """A head on a neck, cut below with bumps of `ragged_m`; flattened above a share `crown`, bent forward by `tilt_deg`."""
    turn = np.linspace(-0.6, np.pi / 2, 24)
    head = [(0.12 * np.cos(a) + 0.004, 0.30 + 0.15 * np.sin(a)) for a in turn if np.sin(a) <= crown]
    vertices, faces = turned([(0.11, 0.0), (0.10, 0.04), (0.075, 0.10), (0.07, 0.16), *head])
    random, low = np.random.default_rng(seed), vertices[:, 2] < 1e-9
    waves, phase = random.normal(size=(12, 2)) * np.pi / 0.055, random.uniform(0.0, 2.0 * np.pi, 12)
    vertices = vertices * np.array([0.85, 1.0, 1.0])
    vertices[low, 2] += ragged_m * np.sin(vertices[low, :2] @ waves.T + phase).sum(axis=1) / 6.0**0.5
    bend = np.deg2rad(tilt_deg) * np.clip((vertices[:, 2] - 0.2) / 0.25, 0.0, 1.0)
    y, z = vertices[:, 1].copy(), np.maximum(vertices[:, 2] - 0.2, 0.0)
    vertices[:, 1] = y * np.cos(bend) - z * np.sin(bend)
    vertices[:, 2] += y * np.sin(bend) + z * np.cos(bend) - z
    return vertices, faces


def column(below: float, above: float, open_below: bool = False) -> Part:
    return turned([(below, 0.0), (above, 2.0)], open_below=open_below)


def slab() -> Part:
    vertices, faces = box(0.7, 0.2, 1.5)
    return vertices, faces


OUTSIDE = [(0.08, 0.0), (0.2, 0.22), (0.085, 0.42), (0.12, 0.5)]
INSIDE = [(0.108, 0.5), (0.073, 0.42), (0.188, 0.22), (0.068, 0.03)]

RIGHT: dict[str, Callable[[], Part]] = {
    "a bust cut nearly flat": lambda: bust(0.003),
    "a tapered column": lambda: column(0.3, 0.25),
    "a slender tapered column": lambda: column(0.2, 0.15),
    "a column open below": lambda: column(0.3, 0.25, open_below=True),
    "a cylinder": lambda: column(0.3, 0.3),
    "a plinth with a stem": lambda: turned([(0.4, 0.0), (0.4, 0.2), (0.1, 0.25), (0.08, 1.2)]),
}
REFUSED: dict[str, Callable[[], Part]] = {
    "a bust cut roughly": lambda: bust(0.012),
    "a bust with a flat crown": lambda: bust(0.012, crown=0.7),
    "a bust with a tilted crown": lambda: bust(0.008, crown=0.75, tilt_deg=18.8),
    "a column with a wide capital": lambda: turned([(0.25, 0.0), (0.22, 1.7), (0.35, 1.9), (0.35, 2.0)]),
    "a vase": lambda: turned(OUTSIDE + INSIDE),
    "a vase of one sheet, open above": lambda: turned(OUTSIDE, open_above=True),
    "a stele": slab,
    "a cube": lambda: box(1.0, 1.0, 1.0),
}
TURNS = [np.eye(3), turn_axis("y").T, *Rotation.random(3, random_state=4).as_matrix()]


def off_rad(part: Part, turn: Array) -> tuple[float, tuple[Doubt, ...]]:
    found = find_orientation(RawMesh(part[0] @ turn.T, part[1], "body"))
    up = turn.T @ found.rotation[2]
    return float(np.arctan2(np.hypot(up[0], up[1]), up[2])), found.doubts


@pytest.mark.parametrize("name", RIGHT)
def test_what_has_a_base_stands_on_it_however_it_lay(name: str) -> None:
    part = RIGHT[name]()
    for number, turn in enumerate(TURNS):
        off, doubts = off_rad(part, turn)
        either = name == "a cylinder" and number > 1  # askew in its axes it has no upper end
        assert min(off, abs(np.pi - off) if either else off) < LEVELLED_RAD
        assert len(doubts) == ("column" in name or name == "a cylinder") + (number > 1)


@pytest.mark.parametrize("name", REFUSED)
def test_what_may_stand_otherwise_is_refused_and_the_right_way_named(name: str) -> None:
    part = REFUSED[name]()
    for turn in TURNS:
        with pytest.raises(MeshError) as caught:
            off_rad(part, turn)
        named = [each.split(" ")[0] for each in caught.value.got.split("--up ")[1:]]
        ups = np.array([turn.T @ turn_axis(each)[2] for each in named])
        assert ups[:, 2].max() > np.cos(NAMED_UP_RAD)


def test_an_inverted_taper_is_said() -> None:
    off, doubts = off_rad(column(0.25, 0.3), TURNS[0])
    assert off == pytest.approx(np.pi)
    assert [(each.code, each.values["up"]) for each in doubts] == [("scan_column", "z")]


def test_a_figure_on_its_back_does_not_lie_there_silently() -> None:
    figure = prism(np.array([[0.0, 0.0], [0.5, 0.0], [0.4, 0.2], [0.3, 1.6], [0.0, 1.6]]), 0.4)
    with pytest.raises(MeshError, match=r"--up z .* inspect figure --up=\S+ --picture"):
        find_orientation(RawMesh(*figure, "figure"))


def test_a_scene_says_what_speaks_against_its_up_axis(statue: Solid) -> None:
    vertices, faces = np.array(statue.vertices_m), np.array(statue.faces)
    assert up_doubted(RawMesh(vertices, faces, "")) == ()
    upside_down = RawMesh(vertices @ turn_axis("-z").T, faces, "")
    assert len(up_doubted(upside_down)) == 1
    assert len(up_doubted(RawMesh(*bust(0.012, crown=0.7), ""))) == 1


def test_the_direction_named_levels_the_scan() -> None:
    vertices, faces = RIGHT["a tapered column"]()
    turn = TURNS[-1]
    askew = RawMesh(vertices @ turn.T, faces, "askew")
    found = prepare_mesh(askew, Wanted(unit="m"))
    named = ",".join(f"{value:.6f}" for value in turn[:, 2])
    told = prepare_mesh(askew, Wanted(unit="m", up=named))
    assert len(found.log.found) == 2
    assert told.log.found == ()
    for each in (found, told):
        assert each.solid(density_kg_m3=1.0).height_m == pytest.approx(2.0, rel=LEVELLED_RAD)
    for wrong in ("1,2", "0,0,0", "a,b,c", "1,inf,0"):
        with pytest.raises(MeshError):
            turn_axis(wrong)
