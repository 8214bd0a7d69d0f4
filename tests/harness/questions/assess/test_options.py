"""What would help: options with common random numbers, intervals that cover, advice only where a difference is shown."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from analytic import Pulse
from harness import InputError, assess, load_scene
from harness.model import BaseExcitation, Pedestal, Scene, Uncertain, Wall
from harness.questions.assess import options as made
from harness.questions.assess.assessment import best_option, of_options
from harness.questions.assess.options import PAIRS, OptionDraws, common, compare, in_plane, paired_difference
from harness.questions.assess.probability import draw, draws_of, model_draws, uncertain_inputs
from harness.records.assess import FLOOR, OptionAnswer, OptionsRecord
from harness.records.scores import Interval
from harness.statics.plan import as_one, sliding, turned_block
from tests import budgets_assess as budget
from tests.scenes_for_tests import SCENES, paestum, rectangle, scene

DRAWS = 400


def compared(scene: Scene, draws: int = DRAWS) -> OptionsRecord:
    options, left_out = made.options_of(scene)
    return by_draws(scene, options, draws, left_out)


def by_draws(
    scene: Scene, options: list[made.Option], draws: int, left_out: dict[str, str] | None = None
) -> OptionsRecord:
    inputs = uncertain_inputs(scene)
    values = draws_of(scene, inputs, draws, 0)
    ask = in_plane(scene, options, inputs, values)
    return compare(options, left_out or {}, OptionDraws(model_draws(scene, values)), ask)


def test_statue_and_pedestal_as_one_body_by_hand() -> None:
    """Two boxes of the same width and density are one box of both heights: its centroid and moment are known."""
    statue, pedestal = rectangle(0.4, 1.0, mass_kg=500.0, depth_m=0.4), Pedestal(250.0, 0.4, 0.4, 0.5)
    one = as_one(statue, pedestal)
    assert one.mass_kg == 750.0
    assert one.centroid_height_m == pytest.approx(0.75, rel=budget.ADDED)
    assert one.inertia_kg_m2 == pytest.approx(750.0 * (0.4**2 + 1.5**2) / 12.0, rel=budget.ADDED)
    assert (one.corner_left_m, one.corner_right_m) == pytest.approx((0.2, 0.2), rel=budget.ADDED)
    # Off its centre by 10 cm: the common centroid lies a third of that from the statue's; both keep their moments.
    aside = as_one(statue, replace(pedestal, offset_m=0.1))
    assert aside.corner_right_m == pytest.approx(0.1 + 0.2 - 0.1 / 3.0, rel=budget.ADDED)
    assert aside.inertia_kg_m2 == pytest.approx(one.inertia_kg_m2 + 0.1**2 * 500.0 * 250.0 / 750.0, rel=budget.ADDED)


def test_a_turned_block_has_its_other_side_in_the_plane() -> None:
    statue = rectangle(0.4, 1.0, mass_kg=600.0, depth_m=0.6)
    turned = turned_block(replace(statue, inertia_tensor_kg_m2=np.diag([68.0, statue.inertia_kg_m2, 26.0])))
    assert (turned.corner_left_m, turned.corner_right_m, turned.depth_m) == (0.3, 0.3, 0.4)
    assert turned.inertia_kg_m2 == 68.0


@pytest.mark.parametrize(("distance_m", "there"), [(0.1, False), (1.5, True)])
def test_an_option_that_would_reach_the_wall_is_left_out(distance_m: float, there: bool) -> None:
    """A pedestal half as wide again reaches some 0.15 m further."""
    stand = Wall("right", distance_m)
    wider = "pedestal_wider"
    options, left_out = made.options_of(replace(paestum(0.429, 3.0), wall=stand))
    assert (wider in {each.name for each in options}, wider in left_out) == (there, not there)


def test_an_option_that_some_draw_would_put_into_the_wall_is_left_out() -> None:
    """As it is it stands 3 mm before it, its place known to 10 mm: the whole assessment ended in a crash."""
    given = load_scene(SCENES / "paestum_block.toml", ["duration_s=1.0", 'wall.side="right"', "wall.distance_m=0.24"])
    inputs = [Uncertain("pedestal.offset_m", "uniform", 0.0, 0.01)]
    options, left_out = made.options_of(given)
    assert "pedestal_wider" not in left_out
    values = draw(inputs, 8, seed=0)
    own = OptionDraws(model_draws(given, values))
    found = compare(options, left_out, own, in_plane(given, options, inputs, values))
    assert found.left_out["pedestal_wider"] == "reaches_wall"
    assert "pedestal_heavier" in [item.name for item in found.options]


def test_draws_are_common() -> None:
    """An option that changes nothing is the scene as it is in every single draw, the others differ by what they change alone."""
    scene = paestum(0.429, 3.0, duration_s=3.0)
    inputs = uncertain_inputs(scene)
    values = draw(inputs, DRAWS, seed=4)
    unchanged = made.Option("same", lambda given: given)
    same = in_plane(scene, [unchanged], inputs, values)(unchanged).model
    np.testing.assert_array_equal(same.overturned, model_draws(scene, values).overturned)
    lower = [replace(inputs[0], value=0.5 * inputs[0].value), *inputs[1:]]
    moved = common(inputs, values, lower, seed=4)
    np.testing.assert_allclose(moved["contact.floor"], 0.5 * values["contact.floor"], rtol=budget.ROUNDING)
    np.testing.assert_array_equal(moved["motion.scale"], values["motion.scale"])


def test_swept_draws_of_an_option_are_those_of_each_scene_changed() -> None:
    """The one sweep, and each drawn scene changed by itself, agree for every option."""
    scene = load_scene(SCENES / "paestum_block.toml", ["duration_s=3.0"])
    inputs = uncertain_inputs(scene)
    by_scene = [*inputs, Uncertain("pedestal.height_m", "uniform", 0.2, 1e-9)]
    values = draw(inputs, 12, seed=1)
    single = {**values, "pedestal.height_m": np.full(12, 0.2)}
    options = made.options_of(scene)[0]
    asked = in_plane(scene, options, inputs, values), in_plane(scene, options, by_scene, single)
    for option in options:
        swept, slow = (ask(option).model for ask in asked)
        np.testing.assert_array_equal(swept.overturned, slow.overturned, err_msg=option.name)
        np.testing.assert_allclose(swept.peak_slip_m, slow.peak_slip_m, atol=budget.ADDED, err_msg=option.name)


def test_other_friction_is_drawn_by_the_factor_of_the_friction_as_it_is() -> None:
    """Whatever its distribution: a normal one's width is that of the scene's own coefficient, not of PTFE's."""
    scene = load_scene(SCENES / "paestum_block.toml", ["duration_s=3.0"])
    own, factor = scene.contact, np.array([0.5, 1.3])
    values = {"contact.floor_static": own.floor_static * factor, "contact.floor_kinetic": own.floor_kinetic * factor}
    inputs = [Uncertain(key, "normal", column.mean(), 0.1) for key, column in values.items()]
    ptfe = next(item for item in made.options_of(scene)[0] if item.name == "less_friction_ptfe")
    found = in_plane(scene, [ptfe], inputs, values)(ptfe).model
    alone = ptfe.change(scene)
    each = [replace(alone, contact=alone.contact.with_floor(0.04 * by, 0.04 * by)) for by in factor]
    wanted = [model_draws(other, {}).peak_slip_m[0] for other in each]
    np.testing.assert_allclose(found.peak_slip_m, wanted, rtol=budget.ADDED)


def test_friction_of_a_pedestal_that_is_gone_is_nothing_to_a_statue_on_the_floor() -> None:
    """Drawn alone, the kinetic coefficient was more than the static one of no pedestal: the whole assessment ended in a crash."""
    inputs = (
        Uncertain("contact.floor_kinetic", "lognormal", 0.15, 0.2),
        Uncertain("motion.scale", "lognormal", 1.0, 0.1),
    )
    given = replace(paestum(0.429, 3.0, duration_s=2.0), uncertainty=inputs)
    options, _ = made.options_of(given)
    values = draws_of(given, inputs, 20, 0)
    (floor,) = (option for option in options if option.name == FLOOR)
    alone = in_plane(given, [floor], inputs, values)(floor)
    assert alone is not None
    expected = model_draws(floor.change(given), {"motion.scale": values["motion.scale"]})
    assert alone.model.overturned.tolist() == expected.overturned.tolist()


def test_the_floor_s_friction_bears_a_fixed_body_not_the_joint_in_it() -> None:
    scene = load_scene(SCENES / "paestum_block.toml", ["duration_s=3.0", "contact.floor_static=0.9"])
    fixed = next(item for item in made.options_of(scene)[0] if item.name == made.FIXED)
    inputs = [Uncertain("contact.floor_static", "normal", 0.9, 0.1)]
    # On the second the body slides; on the first it rocks, which the joint above it would not bear.
    values = {"contact.floor_static": np.array([0.9, 0.05])}
    loose = replace(scene, contact=replace(scene.contact, statue=0.01))
    firm, joint = (in_plane(given, [fixed], inputs, values)(fixed).model for given in (scene, loose))
    np.testing.assert_array_equal(firm, joint)
    assert firm.decided.all()
    assert firm.peak_slip_m[0] == 0.0 < firm.peak_slip_m[1]


def test_a_fixed_body_on_little_friction_slides_and_on_much_rocks() -> None:
    scene = paestum(0.429, 3.0, duration_s=3.0)
    fixed = next(item for item in made.options_of(scene)[0] if item.name == made.FIXED)
    one = fixed.change(scene).statue
    least = math.tan(min(one.slenderness_rad(side) for side in (1, -1)))
    values = {"contact.floor": np.array([0.9 * least, 1.1 * least])}
    inputs = [Uncertain("contact.floor", "lognormal", scene.contact.floor_static, 0.15)]
    answer = in_plane(scene, [fixed], inputs, values)(fixed).model
    assert answer.peak_slip_m[0] > 0.0
    assert answer.peak_share[1] > answer.peak_share[0]
    assert answer.peak_slip_m[1] == 0.0


def test_a_sliding_body_knows_no_mass() -> None:
    light, heavy = (
        sliding(replace(scene, statue=replace(scene.statue, mass_kg=mass)))
        for scene, mass in ((paestum(0.429, 3.0, duration_s=3.0), 10.0), (paestum(0.429, 3.0, duration_s=3.0), 1000.0))
    )
    paths = [model_draws(scene, {}).peak_slip_m[0] for scene in (light, heavy)]
    assert paths[0] == pytest.approx(paths[1], rel=1e3 * budget.ADDED)
    assert paths[0] > 0.0


@pytest.mark.parametrize("after", [0.4, 0.35, 0.05])
def test_intervals_of_differences_cover(after: float) -> None:
    """Draws of two options that share four of five lots: of repeated intervals at 99 % so many hold the true difference."""
    random, covered = np.random.default_rng(11), 0
    for _ in range(budget.REPETITIONS):
        luck, other = random.random((2, budget.PAIRED_DRAWS))
        common_lot = random.random(budget.PAIRED_DRAWS) < 0.8
        fell = np.where(common_lot, luck, other) < after
        answer = paired_difference(fell, luck < 0.4)
        covered += answer.low <= after - 0.4 <= answer.high
    assert covered / budget.REPETITIONS >= budget.PAIRED_LEAST


def test_what_is_not_shown_is_not_recommended() -> None:
    """A shaking that the statue bears in every draw, and options that change nothing: no advice to do anything."""
    calm = compared(paestum(0.05, 3.0, duration_s=2.0))
    assert not calm.helping
    told = best_option(calm)
    assert (told.code, told.values) == ("no_option_helps", {"needed": False})
    scene = paestum(0.429, 3.0, duration_s=3.0)
    same = [made.Option("same", lambda given: given)]
    idle = by_draws(scene, same, DRAWS)
    assert 0.0 < idle.as_it_is.probability_overturned < 1.0
    assert best_option(idle).values == {"needed": True}
    # Where the statue as it is stands alone nothing was held against it.
    assert best_option(replace(idle, options=idle.options[:1])).values == {"needed": "none_compared"}
    assert not list(of_options(idle))


def test_an_option_whose_draws_come_to_no_end_is_not_recommended(tmp_path: Path) -> None:
    """A wall that the statue strikes before it falls: no draw falls any more, none is shown to stand."""
    scene = load_scene(SCENES / "paestum_block.toml", ["duration_s=3.0", "motion.x.amplitude_g=1.0"])
    path = tmp_path / "mine.toml"
    path.write_text('[[option]]\nname = "wall"\nset = {"wall.side" = "right", "wall.distance_m" = 0.08666}\n')
    record = by_draws(scene, made.read_options(path, scene), 60)
    wall = record.options[-1]
    assert record.as_it_is.probability_overturned > wall.probability_overturned + 0.4
    assert wall.undecided > 0.5
    assert wall.high > wall.probability_overturned + wall.undecided
    assert not wall.tells
    assert record.as_it_is.tells
    assert not wall.helps
    assert best_option(record).code == "no_option_helps"


def test_of_options_that_never_fall_the_one_whose_draws_all_end_is_the_best() -> None:
    """A draw without an end may be a fall: an option with some was named first for 1e-11 m less slip."""
    now, change = OptionAnswer, Interval(-0.2, -0.3, -0.1, 0.99)
    ends = [
        now("as_it_is", {}, "", 300, 0.2, 0.17, 0.25, 0.1, 0.2, None),
        now("open", {}, "", 300, 0.0, 0.0, 0.03, 0.1, 0.10, change, undecided=0.02),
        now("ends", {}, "", 300, 0.0, 0.0, 0.01, 0.1, 0.11, change),
    ]
    told = [best_option(OptionsRecord(some, 300, 0.9, 0.99, {})).values for some in (ends, ends[:2])]
    assert [(each["option"], each["undecided"]) for each in told] == [("ends", None), ("open", 0.02)]
    assert told[0]["now"] == 0.2
    unknown = replace(ends[0], high=0.8)
    assert best_option(OptionsRecord([unknown, *ends[1:]], 300, 0.9, 0.99, {})).values["now"] is None


def test_the_shipped_pedestal_protects_its_statue() -> None:
    record = compared(load_scene(SCENES / "paestum_pedestal.toml"), 200)
    by_name = {item.name: item for item in record.options}
    assert record.as_it_is.name == made.AS_IT_IS
    assert by_name[made.FLOOR].harms
    assert by_name[made.FIXED].helps
    assert by_name[made.TURNED].helps
    best = best_option(record)
    assert (best.code, best.values["option"]) == ("best_option", made.FIXED)
    assert best.values["now"] == record.as_it_is.probability_overturned
    assert pedestal(record) == "protects"
    rough = next(item for name, item in by_name.items() if name.endswith([*PAIRS][-1]))
    assert rough.harms
    assert rough.source == PAIRS["rubber"][-1]


def test_a_pedestal_that_does_not_slide_is_no_example_of_the_claim() -> None:
    held = ["contact.floor_static=5.0", "duration_s=2.0"]
    # Within two seconds most falls of the shaking as it is come to no end.
    for scale, shown in ((0.5, "stuck"), (1.0, "undecided")):
        scene = load_scene(SCENES / "paestum_block.toml", [*held, f"motion.scale={scale}"])
        floor = [option for option in made.options_of(scene)[0] if option.name == made.FLOOR]
        assert pedestal(by_draws(scene, floor, 100)) == shown


def pedestal(record: OptionsRecord) -> str:
    """What the options say of the pedestal."""
    return next(each.values["shown"] for each in of_options(record) if each.code == "pedestal_effect")


def test_a_users_options_come_from_a_file(tmp_path: Path) -> None:
    scene = load_scene(SCENES / "paestum_block.toml", ["duration_s=3.0"])
    path = tmp_path / "mine.toml"
    path.write_text(
        '[[option]]\nname = "same"\nset = {"contact.floor_static" = 0.20}\n'
        '[[option]]\nname = "no pedestal"\nset = {pedestal = "none"}\n'
    )
    floor = [option for option in made.options_of(scene)[0] if option.name == made.FLOOR]
    record = by_draws(scene, [*floor, *made.read_options(path, scene)], 100)
    by_name = {item.name: item for item in record.options}
    assert by_name["same"].difference.value == 0.0
    assert by_name["no pedestal"].probability_overturned == by_name[made.FLOOR].probability_overturned


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("[[option]]\n", r"option\.0\.name: "),
        ('[[option]]\nname = "a"\nset = {"contact.flor" = 0.3}\n', "contact.flor"),
        ('[[option]]\nname = "a"\nset = {"contact.floor_static" = "much"}\n', "floor_static.*much"),
        ('[[option]]\nname = "a"\nset = {"title.a" = 1}\n', "a key inside a table"),
        ('[[option]]\nname = "a"\nset = {duration_s = 1.0}\n' * 2, "option.*name: .* got .*a"),
        (f'[[option]]\nname = "{made.FLOOR}"\nset = {{duration_s = 1.0}}\n', "option.*name: "),
        (f'[[option]]\nname = "{made.AS_IT_IS}"\nset = {{duration_s = 1.0}}\n', "option.*name: "),
        ("option = [", "valid TOML"),
    ],
)
def test_a_wrong_file_of_options_is_told(tmp_path: Path, text: str, wanted: str) -> None:
    scene = load_scene(SCENES / "paestum_block.toml")
    path = tmp_path / "mine.toml"
    path.write_text(text)
    with pytest.raises(InputError, match=wanted) as raised:
        made.read_options(path, scene)
    assert "mine.toml" in str(raised.value)


def test_the_scene_as_it_is_has_one_probability() -> None:
    """Headline and first row of the options are the same draws, in the plane and in space."""
    across = BaseExcitation(x=Pulse("one_sine", 0.3 * 9.81, 0.4), y=Pulse("one_sine", 0.65 * 9.81, 0.4))
    in_space = replace(scene(rectangle(0.2, 1.0, depth_m=0.3), mu_statue=0.7, duration_s=2.0), base_excitation=across)
    for given, name in ((paestum(0.429, 3.0, duration_s=3.0), "analytic"), (in_space, "spatial")):
        record = assess(given, ["analytic"], draws=40).record
        whole, row = record.answers[name], record.options.as_it_is
        assert 0.0 < whole.probability_overturned < 1.0
        assert (row.probability_overturned, row.draws) == (whole.probability_overturned, whole.draws)
        assert (row.low, row.high, row.undecided) == pytest.approx((whole.low, whole.high, whole.undecided))


def test_an_engine_answers_an_options_draws_outside_the_domain() -> None:
    """A narrow plinth tips under the statue: of most draws the model says nothing, the engine that every run falls."""
    given = paestum(0.8, 1.0, duration_s=4.0)
    pedestal = Pedestal(60.0, 0.45, 0.8, 1.2)
    narrow = [made.Option("plinth", lambda one: replace(one, pedestal=pedestal))]
    plinth = by_draws(given, narrow, 40).options[-1]
    assert plinth.undecided < 0.3
    assert plinth.probability_overturned > 0.5
    assert plinth.low <= plinth.probability_overturned <= plinth.high
    assert plinth.difference.high - plinth.difference.low < 1.0


@pytest.mark.parametrize(("base_m", "plate_m"), [(0.064, 0.008), (0.4, 0.05), (4.0, 0.5)])
def test_a_plate_is_in_proportion_to_the_base(base_m: float, plate_m: float) -> None:
    """Five centimetres all round nearly trebled the base of a figurine."""
    given = scene(rectangle(base_m, 1.5 * base_m, depth_m=2.0 * base_m))
    (option,) = (item for item in made.options_of(given)[0] if item.name == "base_widened")
    assert option.values == {"plate_m": plate_m}
    wide = option.change(given).statue
    assert wide.corner_left_m + wide.corner_right_m == pytest.approx(base_m + 2.0 * plate_m)
