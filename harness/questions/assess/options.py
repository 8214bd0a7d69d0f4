"""What might be done for a statue: each option is its scene, changed; the user's own come from a file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Final

from pydantic import Field

from harness.input.mistakes import Table
from harness.input.scene_file import check_wall
from harness.input.tables import read_model
from harness.model.errors import InputError, Mistake
from harness.model.scene import Scene, scan_azimuth_deg, written
from harness.questions.assess.variation import reread
from harness.statics.bodies import as_one, turned_block, widened

HEAVIER: Final = 2.0
"""Factor on the pedestal's mass: what a denser stone, or lead in its core, may give."""
WIDER: Final = 1.5
"""Factor on the pedestal's width, and with it, of the same stone, on its mass."""
BASE_M: Final = 0.05
"""By how much a plate widens the statue's base on each side: what is hardly seen."""
SAME_FRICTION: Final = 0.1
"""A pair whose static coefficient is this near to the scene's own, as a share of it, is no option."""
AS_IT_IS: Final = "as_it_is"
FLOOR: Final = "floor_alone"
FIXED: Final = "fixed_to_pedestal"
TURNED: Final = "turned_90"


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


def options_of(scene: Scene) -> tuple[list[Option], dict[str, str]]:
    """What can be done in this scene, and the reasons for which other options are left out."""
    options, left_out = _of_pedestal(scene) if scene.pedestal is not None else [], {}
    if scene.wall is not None:
        left_out["another_base"] = "changes_wall_distance"
        left_out |= {each.name: "reaches_wall" for each in options if not _before_wall(each.change(scene))}
        return [each for each in options if each.name not in left_out], left_out
    options.append(Option("base_widened", _base_widened, {"plate_m": BASE_M}))
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
    own = scene.contact.floor_static
    pairs = [pair for pair in PAIRS if own == 0.0 or abs(pair.static / own - 1.0) > SAME_FRICTION]
    return [
        Option(FLOOR, lambda given: replace(given, pedestal=None)),
        *(_with_friction(pair, own) for pair in pairs),
        Option("pedestal_heavier", lambda given: _pedestal(given, mass=HEAVIER), {"times": HEAVIER}),
        Option("pedestal_wider", lambda given: _pedestal(given, mass=WIDER, width=WIDER), {"times": WIDER}),
    ]


def _with_friction(pair: Pair, own: float) -> Option:
    higher = "more" if pair.static > own else "less"
    values: dict[str, float | str] = {"static": pair.static, "kinetic": pair.kinetic, "pair": pair.name}

    def change(scene: Scene) -> Scene:
        # What is drawn of the friction as it is moves the new friction by the same factor.
        factor = scene.contact.floor_static / own if own > 0.0 else 1.0
        return replace(scene, contact=scene.contact.with_floor(factor * pair.static, factor * pair.kinetic))

    return Option(f"{higher}_friction_{pair.name}", change, values, pair.source)


def _pedestal(scene: Scene, mass: float, width: float = 1.0) -> Scene:
    if scene.pedestal is None:
        return scene
    given = scene.pedestal
    return replace(scene, pedestal=replace(given, mass_kg=mass * given.mass_kg, width_m=width * given.width_m))


def _base_widened(scene: Scene) -> Scene:
    statue = widened(scene.statue, BASE_M)
    if scene.pedestal is None:
        return replace(scene, statue=statue)
    # Where the plate would reach over the pedestal's edge, that grows by as much: its width decides nothing in the model.
    over = statue.corner_left_m + statue.corner_right_m + 2.0 * abs(scene.pedestal.offset_m)
    return replace(scene, statue=statue, pedestal=replace(scene.pedestal, width_m=max(scene.pedestal.width_m, over)))


def _fixed(scene: Scene) -> Scene:
    return (
        scene if scene.pedestal is None else replace(scene, statue=as_one(scene.statue, scene.pedestal), pedestal=None)
    )


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
    if pedestal is not None and statue.corner_left_m + statue.corner_right_m > pedestal.width_m:
        raise InputError(
            Mistake(str(scene.source), "pedestal.depth_m", "a pedestal under the whole turned base", "less")
        )
    return replace(scene, statue=statue, pedestal=pedestal)


class _OptionTable(Table):
    """`[[option]]`: a name, and keys of the scene with their values there."""

    name: Annotated[str, Field(min_length=1, max_length=80)]
    set: Annotated[dict[str, object], Field(min_length=1)]


class _OptionsFile(Table):
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
    sets: Sequence[str] = [f"{key} = {value}" for key, value in values.items()]
    return Option(name, lambda _: other, {"set": ", ".join(sets)}, path.name, user=True)


@dataclass(frozen=True)
class Pair:
    """Two materials: the static and kinetic coefficients used, and who published their range, which the catalogues tell."""

    name: str
    static: float
    kinetic: float
    source: str


PAIRS: Final = (
    Pair("ptfe", 0.04, 0.04, "Engineering ToolBox, Friction and friction coefficients"),
    Pair("smooth_stone", 0.4, 0.3, "Monaco et al., Procedia Structural Integrity 29 (2020) 134-141"),
    Pair("rough_stone", 0.75, 0.75, "Statics of drystone walls, stonewalls.ch"),
    Pair(
        "rubber",
        1.0,
        0.8,
        "Serway and Beichner, Physics for Scientists and Engineers, 5th ed., Table 5.2; ranges: hypertextbook.com/facts/2006",
    ),
)
"""A pair's coefficients differ from one surface to the next by a third and more: measure before building."""
