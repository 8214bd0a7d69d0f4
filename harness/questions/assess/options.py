"""What might be done for a statue: each option is its scene, changed; the user's own come from a file; compared with common
random numbers.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from statistics import NormalDist
from typing import Annotated, Final, NamedTuple

import numpy as np
from pydantic import Field

from harness.accuracy.horizon import MODEL
from harness.input.mistakes import UserTable
from harness.input.scene_file import check_wall
from harness.input.tables import read_model
from harness.model import Array, Contact, InputError, Mistake, Scene, Uncertain, require, scan_azimuth_deg, written
from harness.questions.assess.probability import (
    KINETIC,
    LEAST_SHARE,
    LEVEL,
    NONE_SAMPLED,
    SLOW_DRAWS,
    STATIC,
    End,
    Flags,
    ModelDraws,
    Outside,
    draw,
    joined,
    model_draws,
    probability_of,
    repeated,
    reread,
    row,
    sampled,
    space_draws,
    sweepable,
    uncertain_inputs,
    varied,
)
from harness.records.assess import FLOOR, TURNED, OptionAnswer, OptionsRecord
from harness.records.scores import Interval
from harness.statics.plan import as_one, sliding, turned_block, widened

HEAVIER: Final = 2.0
"""Factor on the pedestal's mass: what a denser stone, or lead in its core, may give."""
WIDER: Final = 1.5
"""Factor on the pedestal's width, and with it, of the same stone, on its mass."""
BASE: Final = 0.125
"""By how much of its narrower way a plate widens the statue's base on each side: what is hardly seen, 5 cm of 40."""
SAME_FRICTION: Final = 0.1
"""A pair whose static coefficient is this near to the scene's own, as a share of it, is no option."""
AS_IT_IS: Final = "as_it_is"
FIXED: Final = "fixed_to_pedestal"


@dataclass(frozen=True)
class Option:
    """One option: `change` makes its scene of the scene as it is, whatever is drawn of that; a `user` option sets keys of the
    file, and draws are made of its scene. A body that `slides` does so where friction is too small to tip it. `name` is a code
    with its words in the catalogue, which `values` fill; of the user's own it is the name given.
    """

    name: str
    change: Callable[[Scene], Scene]
    values: Mapping[str, float | str] = field(default_factory=dict)
    source: str = ""
    slides: bool = False
    user: bool = False


UNCHANGED: Final = Option(AS_IT_IS, lambda scene: scene)


def options_of(scene: Scene) -> tuple[list[Option], dict[str, str]]:
    """What can be done in this scene, and the reasons for which other options are left out."""
    options, left_out = _of_pedestal(scene) if scene.pedestal is not None else [], {}
    if scene.wall is not None:
        left_out["another_base"] = "changes_wall_distance"
        left_out |= {each.name: "reaches_wall" for each in options if not _before_wall(each.change(scene))}
        return [each for each in options if each.name not in left_out], left_out
    statue = scene.statue
    # To one digit, as a plate is made, and of the scene as it is, whatever base is drawn.
    plate_m = float(f"{BASE * min(statue.corner_left_m + statue.corner_right_m, statue.depth_m):.0e}")
    options.append(Option("base_widened", lambda given: _base_widened(given, plate_m), {"plate_m": plate_m}))
    if scene.pedestal is not None:
        options.append(Option(FIXED, _fixed, slides=True))
    try:
        _turned(scene)
    except InputError as error:
        left_out[TURNED] = "; ".join(mistake.wanted for mistake in error.mistakes)
    else:
        options.append(Option(TURNED, _turned))
    return options, left_out


def _before_wall(scene: Scene) -> bool:
    try:
        check_wall(scene, scene.source or Path())
    except InputError:
        return False
    return True


def _of_pedestal(scene: Scene) -> list[Option]:
    own = scene.contact
    static = own.floor_static
    pairs = [name for name, (new, *_) in PAIRS.items() if static == 0.0 or abs(new / static - 1.0) > SAME_FRICTION]
    return [
        Option(FLOOR, lambda given: replace(given, pedestal=None)),
        *(_with_friction(pair, own) for pair in pairs),
        Option("pedestal_heavier", lambda given: _pedestal(given, mass=HEAVIER), {"times": HEAVIER}),
        Option("pedestal_wider", lambda given: _pedestal(given, mass=WIDER, width=WIDER), {"times": WIDER}),
    ]


def _with_friction(pair: str, own: Contact) -> Option:
    new_static, new_kinetic, source = PAIRS[pair]
    higher = "more" if new_static > own.floor_static else "less"
    values: dict[str, float | str] = {"static": new_static, "kinetic": new_kinetic, "pair": pair}

    def change(scene: Scene) -> Scene:
        # What is drawn of the friction as it is moves the new friction by the same factor.
        drawn = scene.contact
        static = new_static * (drawn.floor_static / own.floor_static if own.floor_static > 0.0 else 1.0)
        kinetic = new_kinetic * (drawn.floor_kinetic / own.floor_kinetic if own.floor_kinetic > 0.0 else 1.0)
        return replace(scene, contact=drawn.with_floor(static, kinetic))

    return Option(f"{higher}_friction_{pair}", change, values, source)


def _pedestal(scene: Scene, mass: float, width: float = 1.0) -> Scene:
    given = scene.pedestal
    assert given is not None
    return replace(scene, pedestal=replace(given, mass_kg=mass * given.mass_kg, width_m=width * given.width_m))


def _base_widened(scene: Scene, plate_m: float) -> Scene:
    statue = widened(scene.statue, plate_m)
    if scene.pedestal is None:
        return replace(scene, statue=statue)
    # Where the plate would reach over the pedestal's edge, that grows by as much: its width decides nothing in the model.
    over = statue.corner_left_m + statue.corner_right_m + 2.0 * abs(scene.pedestal.offset_m)
    return replace(scene, statue=statue, pedestal=replace(scene.pedestal, width_m=max(scene.pedestal.width_m, over)))


def _fixed(scene: Scene) -> Scene:
    assert scene.pedestal is not None
    # The one body stands on the pedestal's base, whose friction bears it.
    contact = replace(scene.contact, statue=scene.contact.floor_static)
    return replace(scene, statue=as_one(scene.statue, scene.pedestal), pedestal=None, contact=contact)


def _turned(scene: Scene) -> Scene:
    """The statue, and the pedestal under it, turned about the vertical; raises `InputError` where the other side is not known."""
    pedestal = scene.pedestal
    if pedestal is not None:
        pedestal = replace(pedestal, width_m=pedestal.depth_m, depth_m=pedestal.width_m, offset_m=0.0)
    if scene.statue.solid is not None:
        azimuth = scan_azimuth_deg(scene) + 90.0
        statue = reread(scene, {"statue.mesh.azimuth_deg": azimuth, "pedestal": "none"}, TURNED).statue
    elif scene.given and written(scene, "statue", "depth_m") is None:
        raise InputError(Mistake(str(scene.source), "statue.depth_m", "statue.depth_m, or a mesh", "nothing"))
    else:
        statue = turned_block(scene.statue)
    require(
        pedestal is None or statue.corner_left_m + statue.corner_right_m <= pedestal.width_m,
        str(scene.source),
        "a pedestal under the whole turned base",
        "less",
        key="pedestal.depth_m",
    )
    return replace(scene, statue=statue, pedestal=pedestal)


class _OptionTable(UserTable):
    """`[[option]]`: a name, and keys of the scene with their values there."""

    name: Annotated[str, Field(min_length=1, max_length=80)]
    set: Annotated[dict[str, object], Field(min_length=1)]


class _OptionsFile(UserTable):
    """A file of the user's own options."""

    option: Annotated[list[_OptionTable], Field(min_length=1, max_length=50)]


def read_options(path: Path, scene: Scene) -> list[Option]:
    """The user's own options for a scene read from a file. Raises `InputError` with every mistake, also those of their scenes."""
    tables = read_model(_OptionsFile, path).option
    names = [AS_IT_IS, *(item.name for item in options_of(scene)[0]), *(table.name for table in tables)]
    if twice := next((name for name in names if names.count(name) > 1), None):
        raise InputError(Mistake(str(path), "option.name", "a name that no other option has", repr(twice)))
    return [_users(table.name, table.set, path, scene) for table in tables]


def _users(name: str, values: Mapping[str, object], path: Path, scene: Scene) -> Option:
    other = reread(scene, values, f"{path}: option {name!r}")
    sets = ", ".join(f"{key} = {value}" for key, value in values.items())
    return Option(name, lambda _: other, {"set": sets}, path.name, user=True)


PAIRS: Final = {
    "ptfe": (0.04, 0.04, "Engineering ToolBox, Friction and friction coefficients"),
    "smooth_stone": (0.4, 0.3, "Monaco et al., Procedia Structural Integrity 29 (2020) 134-141"),
    "rough_stone": (0.75, 0.75, "Statics of drystone walls, stonewalls.ch"),
    "rubber": (
        1.0, 0.8,
        "Serway and Beichner, Physics for Scientists and Engineers, 5th ed., Table 5.2; ranges: hypertextbook.com/facts/2006",
    ),
}  # fmt: skip
"""Two materials: the static and kinetic coefficients used, and who published their range, which the catalogues tell.

They differ from one surface to the next by a third and more: measure before building.
"""


# Options set against the scene as it is, by one model with common random numbers.

DIFFERENCE_LEVEL: Final = 0.99
"""Level of a difference's interval: of ten options without effect, one table in ten then names one."""
HIGH: Final = 0.95
"""The quantile of the pedestal's slip that is told beside the median."""
ALIKE: Final = ("contact.", "motion.", "initial.")
"""Keys whose draws are the same before and after a statue or a pedestal is changed."""
STATUE: Final = "contact.statue"
HOLDS: Final = 1e3
"""A friction under which nothing slips."""
NEW_KEYS: Final = 2_000_003
"""Added to the seed where an option brings an uncertain number that the scene as it is does not have."""
SPACE_OPTION_DRAWS: Final = 300
"""Draws of each option in space: a difference of 10 points at a half is then shown where half of the falls are the same."""
SPACE_OPTION_STEPS: Final = 400_000
"""Steps of each option's runs in space together: some fifteen seconds of one core."""


class OptionDraws(NamedTuple):
    """What a model says of each draw, and whether the statue falls by an engine in the first of those outside its domain."""

    model: ModelDraws
    fell: Mapping[int, End] = NONE_SAMPLED


Ask = Callable[[Option], OptionDraws | None]
"""What a model answers of an option, on draws that are the same for all; None of one that it does not know."""


def compare(
    options: Sequence[Option],
    left_out: Mapping[str, str],
    own: OptionDraws,
    ask: Ask,
    *,
    model: str = MODEL,
    plane_only: bool = False,
    on_progress: Callable[[str], None] = lambda text: None,
) -> OptionsRecord:
    """Every option's probability of a fall and its slip, and its difference to the scene as it is (`own`), draw by draw."""
    answers, unknown = [answer_of(UNCHANGED, own, None)], dict(left_out)
    for option in options:
        on_progress(f"option {option.name}" if model == MODEL else f"option {option.name}, in space")
        found = ask(option)
        if found is None:
            unknown[option.name] = "reaches_wall" if model == MODEL else "unknown_in_space"
        else:
            answers.append(answer_of(option, found, own))
    return OptionsRecord(answers, own.model.overturned.size, LEVEL, DIFFERENCE_LEVEL, unknown, plane_only, model)


def in_plane(
    scene: Scene, options: Sequence[Option], inputs: Sequence[Uncertain], values: Mapping[str, Array], seed: int = 0
) -> Ask:
    """The analytic model's answers to any of these options on draws (n,) of the scene as it is, where each is a scene read again
    on the first of them."""
    size = len(next(iter(values.values())))
    own = [option for option in options if not option.user]
    swept = {option.name: _swept(scene, option.change(scene), values) for option in own}

    @cache
    def one_by_one() -> dict[str, ModelDraws]:
        """Each draw's scene made first and then changed, for all options that need it: reading a scan costs most."""
        slow = [option for option in own if swept[option.name] is None]
        parts: dict[str, list[ModelDraws]] = {option.name: [] for option in slow}
        for number in range(min(SLOW_DRAWS, size)):
            drawn = varied(scene, row(values, number))
            for option in (option for option in slow if option.name in parts):
                changed = option.change(drawn)
                if _before_wall(changed):
                    parts[option.name].append(_slipping(changed, {}, drawn, 1, option.slides))
                else:
                    del parts[option.name]
        return {name: joined(several) for name, several in parts.items()}

    def ask(option: Option) -> OptionDraws | None:
        other = option.change(scene)
        if option.user:
            drawn = common(inputs, values, uncertain_inputs(other), seed)
            first = None if sweepable(other, drawn) else SLOW_DRAWS
            model = model_draws(other, {key: column[:first] for key, column in drawn.items()})
            return OptionDraws(model, sampled(model, lambda number: varied(other, row(drawn, number))))
        at_once = swept[option.name]
        if at_once is None and option.name not in one_by_one():
            return None
        model = one_by_one()[option.name] if at_once is None else _slipping(other, at_once, scene, size, option.slides)
        return OptionDraws(model, sampled(model, lambda number: option.change(varied(scene, row(values, number)))))

    return ask


def _swept(scene: Scene, other: Scene, values: Mapping[str, Array]) -> dict[str, Array] | None:
    """The draws as draws of an option's own scene; None where drawing and changing do not commute."""
    same_bodies = other.statue is scene.statue and other.pedestal in (scene.pedestal, None)
    if not sweepable(scene, values) or not (same_bodies or all(key.startswith(ALIKE) for key in values)):
        return None
    swept = _moved(scene.contact, other, values)
    return swept if sweepable(other, swept) else None


def in_space(scene: Scene, inputs: Sequence[Uncertain], values: Mapping[str, Array], seed: int) -> Ask:
    """The exact body's answers on the first of the draws (n,) of the scene as it is."""
    first = {key: column[:SPACE_OPTION_DRAWS] for key, column in values.items()}

    def ask(option: Option) -> OptionDraws | None:
        if option.user:
            other = option.change(scene)
            found = space_draws(other, common(inputs, first, uncertain_inputs(other), seed), SPACE_OPTION_STEPS)
        else:
            found = space_draws(scene, first, SPACE_OPTION_STEPS, option.change)
        return None if found is None else OptionDraws(found)

    return ask


def _slipping(other: Scene, values: Mapping[str, Array], scene: Scene, size: int, slides: bool) -> ModelDraws:
    """The draws of a body: of one that may slide, those whose friction is below the least slenderness slide and stand.

    A free body on the floor lifts at g b/h and slides at g μ, whichever comes first (Ishiyama 1982); the model of one body
    knows no sliding, and its domain ends where the floor's friction does.
    """
    if not slides:
        return repeated(model_draws(other, values), size)
    static = np.broadcast_to(values.get("contact.floor", values.get(STATIC, scene.contact.floor_static)), size)
    rocking = model_draws(other, {**values, STATUE: static})
    least = math.tan(min(other.statue.slenderness_rad(side) for side in (1, -1)))
    path, slips = model_draws(sliding(other), {**values, STATUE: np.full(size, HOLDS)}), static < least
    return ModelDraws(*(np.where(slips, slid, rocked) for slid, rocked in zip(path, rocking, strict=True)))


def _moved(own: Contact, other: Scene, values: Mapping[str, Array]) -> dict[str, Array]:
    """The draws as an option leaves them: of another friction by the same factor, of what is gone none."""
    now = other.contact
    static, kinetic = (own.floor_static, now.floor_static), (own.floor_kinetic, now.floor_kinetic)
    friction = {"contact.floor": static, STATIC: static, KINETIC: kinetic}
    moved = {}
    for key, column in values.items():
        before, after = friction.get(key, (1.0, 1.0))
        if other.pedestal is not None or not key.startswith("pedestal."):
            moved[key] = column * (after / before) if before > 0.0 else np.full_like(column, after)
    return moved


def common(
    inputs: Sequence[Uncertain], values: Mapping[str, Array], own: Sequence[Uncertain], seed: int
) -> dict[str, Array]:
    """The draws of an option from those of the scene as it is: moved with a lognormal's median or another's mean.

    Only a number that the scene as it is does not draw, or draws otherwise, has draws of its own.
    """
    known = {(item.key, item.kind, item.width): item for item in inputs}
    size = len(next(iter(values.values())))
    fresh = [item for item in own if (item.key, item.kind, item.width) not in known]
    result = draw(fresh, size, seed + NEW_KEYS)
    for item in own:
        before = known.get((item.key, item.kind, item.width))
        if before is None:
            continue
        column = values[item.key]
        if item.kind == "lognormal":
            result[item.key] = column * (item.value / before.value)
        else:
            moved = column + (item.value - before.value)
            result[item.key] = np.maximum(moved, LEAST_SHARE * item.value) if item.value > 0.0 else moved
    return result


def answer_of(option: Option, answered: OptionDraws, before: OptionDraws | None) -> OptionAnswer:
    """What is told of an option, by its draws and the same ones `before` it, of the scene as it is."""
    model = answered.model
    share = probability_of(*answered)
    followed = bool(np.isfinite(model.peak_slip_m).all())
    median_m, high_m = np.quantile(model.peak_slip_m, (0.5, HIGH)).tolist() if followed else (None, None)
    return OptionAnswer(
        name=option.name,
        values=option.values,
        source=option.source,
        draws=share.draws,
        probability_overturned=share.probability_overturned,
        low=share.low,
        high=share.high,
        slip_median_m=median_m,
        slip_high_m=high_m,
        difference=None if before is None else difference_of(answered, before),
        undecided=share.undecided,
    )


def difference_of(answered: OptionDraws, before: OptionDraws) -> Interval:
    """The probability of a fall less the one before, of the same draws; where one comes to no end it may be either."""
    size = min(answered.model.overturned.size, before.model.overturned.size)
    paired = paired_difference(answered.model.overturned[:size], before.model.overturned[:size])
    now, then = (Outside.of(*each, DIFFERENCE_LEVEL) for each in (answered, before))
    value = paired.value + now.falls - then.falls
    below = math.hypot(paired.value - paired.low, now.falls - now.low, then.high - then.falls) + then.undecided
    above = math.hypot(paired.high - paired.value, now.high - now.falls, then.falls - then.low) + now.undecided
    return Interval(value, max(value - below, -1.0), min(value + above, 1.0), DIFFERENCE_LEVEL)


def paired_difference(fell: Flags, before: Flags) -> Interval:
    """The probability of a fall less the one before, of the same draws, with its interval.

    Half a draw is added to each of the four cells (Agresti and Min, Statistics in Medicine 24, 2005): the interval has a width
    where no draw differs, too. Its middle is the plain difference, so that both numbers of a table agree.
    """
    more, fewer = int(np.sum(fell & ~before)), int(np.sum(before & ~fell))
    size = fell.size + 2.0
    shift = (more - fewer) / size
    variance = ((more + fewer + 1.0) / size - shift**2) / size
    half = NormalDist().inv_cdf(0.5 + 0.5 * DIFFERENCE_LEVEL) * math.sqrt(variance)
    plain = (more - fewer) / fell.size
    return Interval(plain, max(min(shift - half, plain), -1.0), min(max(shift + half, plain), 1.0), DIFFERENCE_LEVEL)
