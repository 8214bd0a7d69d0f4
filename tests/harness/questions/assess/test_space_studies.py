"""Options and fragility in space: a statue turned is one whose shaking is turned; draws without an end prove nothing."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic import Pulse
from harness import Outcome, assess, load_scene, simulate
from harness.model import BaseExcitation, Scene
from harness.questions.assess.options import AS_IT_IS, OptionDraws, difference_of, options_of
from harness.questions.assess.probability import ModelDraws, draw, row, space_draws, uncertain_inputs, varied
from harness.records.assess import TURNED
from tests.scenes_for_tests import block, rectangle, scene

DRAWS = 24


def lopsided() -> Scene:
    """A block whose four edges are at four distances, pushed both ways, across harder."""
    statue = block(
        mass_kg=300.0,
        corner_left_m=0.15,
        corner_right_m=0.25,
        centroid_height_m=0.7,
        inertia_kg_m2=60.0,
        height_m=1.4,
        depth_m=0.36,
    )
    return both_ways(scene(statue, mu_statue=0.8, duration_s=3.0), 0.23, 0.33)


def both_ways(given: Scene, along_g: float, across_g: float) -> Scene:
    along, across = (Pulse("one_sine", strength * 9.81, 0.7) for strength in (along_g, across_g))
    return replace(given, base_excitation=BaseExcitation(x=along, y=across))


def scan(tmp_path: Path) -> Scene:
    """A scanned wedge, no two sides alike."""
    import trimesh

    base = [[0.0, 0.0, 0.0], [0.26, 0.0, 0.0], [0.24, 0.24, 0.0], [0.0, 0.2, 0.0]]
    top = [[0.0, 0.02, 1.4], [0.28, 0.02, 1.4], [0.2, 0.24, 1.4]]
    trimesh.convex.convex_hull(np.array(base + top)).export(tmp_path / "wedge.ply")
    text = """title = "wedge"\nduration_s = 3.0\n[statue]
mesh = { file = "wedge.ply", unit = "m", up = "z", density_kg_m3 = 2700.0 }\n[contact]\nstatue = 0.8
[motion.x]\nkind = "pulse"\nshape = "one_sine"\namplitude_g = 0.2\nduration_s = 0.7\n"""
    (tmp_path / "wedge.toml").write_text(text)
    return both_ways(load_scene(tmp_path / "wedge.toml"), 0.18, 0.26)


@pytest.mark.parametrize("kind", ["block", "scan"])
def test_a_turned_statue_is_one_whose_shaking_is_turned(kind: str, tmp_path: Path) -> None:
    given = lopsided() if kind == "block" else scan(tmp_path)
    values = draw(uncertain_inputs(given), DRAWS, seed=4)
    turned = next(item for item in options_of(given)[0] if item.name == TURNED)
    ends = space_draws(given, values, change=turned.change)
    motion = given.base_excitation
    other_way = replace(given, base_excitation=BaseExcitation(x=motion.y, y=motion.x.scaled(-1.0)))
    expected, as_it_is = (space_draws(each, values) for each in (other_way, given))
    assert ends.decided.tolist() == expected.decided.tolist()
    assert ends.overturned.tolist() == expected.overturned.tolist()
    assert 0.0 < ends.probability < 1.0, "the draws should be of both kinds"
    assert ends.overturned.tolist() != as_it_is.overturned.tolist()


def test_a_draw_that_ends_in_its_fall_ends_as_a_run_of_its_own_says() -> None:
    """Cut off in mid-fall no draw had an end, though every run tells what follows."""
    push = Pulse("rectangular", 0.8 * 9.81, 0.5)
    cut_off = scene(rectangle(0.4, 1.4, depth_m=0.3), mu_statue=0.6, duration_s=0.6)
    shaken = replace(cut_off, base_excitation=BaseExcitation(y=push))
    values = draw(uncertain_inputs(shaken), DRAWS, seed=4)
    ends = space_draws(shaken, values)
    assert ends is not None
    assert ends.overturned.all()
    assert simulate(varied(shaken, row(values, 0)), "spatial").outcome is Outcome.OVERTURNED_FRONT


def test_options_and_fragility_of_a_scene_in_space_are_the_exact_bodys() -> None:
    record = assess(lopsided(), ["analytic"], draws=60).record
    assert record.options.model == record.fragility.model == "spatial"
    assert not record.options.plane_only
    assert [item.name for item in record.options.options] == [AS_IT_IS, "base_widened", TURNED]
    assert record.options.as_it_is.probability_overturned > 0.1, "the plane never moves it"
    assert record.options.options[1].helps
    assert record.fragility.probability_overturned[0] == 0.0
    assert record.fragility.probability_overturned[-1] > 0.9
    assert record.indices == {}, "sixty draws are too few for one"


def test_draws_without_an_end_show_nothing() -> None:
    none, all_ = np.zeros(300, dtype=bool), np.ones(300, dtype=bool)
    ends = ((all_, all_), (all_, none), (none, none))
    falls, stands, open_ = (OptionDraws(ModelDraws(known, fell, none, none, none, none)) for known, fell in ends)
    shown = difference_of(stands, falls)
    assert shown.high < -0.9
    for ends, own in ((open_, falls), (stands, open_), (open_, open_)):
        interval = difference_of(ends, own)
        assert interval.low < 0.0
        assert interval.high >= 0.0
