"""What a scene does not know, drawn, and the analytic model or the exact body over many draws, for the outcome alone."""

import copy
import math
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import JsonValue, ValidationError

from analytic.excitation import Harmonic, ZeroExcitation
from harness import engines
from harness.accuracy.horizon import amplified
from harness.engines import stands_alone
from harness.input.tables import assumption
from harness.model import InputError, Mistake, Run, RunOptions, Scene, Uncertain, require, written
from harness.model import two_block as twoblock

# What a scene does not know, and seeded draws of it.

Array = NDArray[np.float64]

MOST: Final = {"contact.restitution": 1.0}
"""Draws above this are drawn again: no impact gives energy."""
LEAST_SHARE: Final = 1e-3
"""Draws of a positive number below this share of it are drawn again: a friction or a mass has no tail through zero."""


def uncertain_inputs(scene: Scene) -> tuple[Uncertain, ...]:
    """The scene's own `[uncertainty]`, or the assumed one: friction on the floor, strength and a harmonic motion's frequency.

    Which of two coefficients acts at an impact is drawn too, where it matters and the scene does not choose.
    """
    if scene.uncertainty:
        return tuple(scene.uncertainty)
    assumed = [] if scene.pedestal is None else [_assumed("contact.floor", scene.contact.floor_static)]
    contact, chosen = scene.contact, written(scene, "contact", "floor_impact")
    matters = contact.floor_kinetic < contact.floor_static and scene.form.pedestal_at_impact == "momentum"
    axes = {"x": scene.base_excitation.x, "y": scene.base_excitation.y, "z": scene.base_excitation.z}
    if not all(isinstance(item, ZeroExcitation) for item in axes.values()):
        assumed.append(_assumed("motion.scale", file_scale(scene)))
    assumed += [
        _assumed(f"motion.{axis}.frequency_hz", item.frequency_hz)
        for axis, item in axes.items()
        if isinstance(item, Harmonic)
    ]
    if scene.pedestal is None and assumed:
        assumed.append(_assumed("contact.statue", scene.contact.statue))
    # The last, so that the others' draws are the same with it and without.
    if scene.pedestal is not None and matters and chosen is None:
        assumed.append(_assumed(IMPACT, 0.5))
    return tuple(item for item in assumed if item.value > 0.0)


def _assumed(key: str, value: float) -> Uncertain:
    given = assumption(key)
    assert given is not None
    return Uncertain(key, given.kind, value, given.width)


def draw(inputs: Sequence[Uncertain], count: int, seed: int) -> dict[str, Array]:
    """Values (count,) of every input by its key; more draws of one seed begin with the same values."""
    linked = {name for group in groups(inputs) if len(group) > 1 for name in group}
    values: dict[str, Array] = {}
    scores: dict[str, Array] = {}
    for k, item in enumerate(inputs):
        random = np.random.default_rng([seed, k])
        if item.key not in linked:
            values[item.key] = _values(item, count, random)
            continue
        own = random.standard_normal(count)
        other = scores.get(item.correlated_with or "")
        scores[item.key] = own if other is None else item.rho * other + math.sqrt(1.0 - item.rho**2) * own
        values[item.key] = _of_score(item, scores[item.key])
    return values


def groups(inputs: Sequence[Uncertain]) -> list[list[str]]:
    """The keys that depend on each other, each group independent of all others."""
    by_key: dict[str, list[str]] = {}
    for item in inputs:
        by_key[item.key] = by_key.get(item.correlated_with or "", [])
        by_key[item.key].append(item.key)
    return [group for key, group in by_key.items() if group[0] == key]


def _of_score(item: Uncertain, score: Array) -> Array:
    """The input at normal scores (n,): the same distribution as `_values` draws, by its quantiles."""
    from scipy.special import ndtr, ndtri

    least, most = _limits(item)
    if item.kind == "lognormal":
        return np.minimum(item.value * np.exp(math.sqrt(math.log1p(item.width**2)) * score), most)
    if item.kind == "uniform":
        low, high = max(item.value - item.width, least), min(item.value + item.width, most)
        return np.asarray(low + (high - low) * ndtr(score))
    below, up_to = ndtr((least - item.value) / item.width), ndtr((most - item.value) / item.width)
    return np.asarray(item.value + item.width * ndtri(below + (up_to - below) * ndtr(score)))


def _limits(item: Uncertain) -> tuple[float, float]:
    """Between which values a draw is kept."""
    return LEAST_SHARE * item.value if item.value > 0.0 else -math.inf, MOST.get(item.key, math.inf)


def _values(item: Uncertain, count: int, random: np.random.Generator) -> Array:
    least, most = _limits(item)
    if item.kind == "lognormal":
        # The median is the scene's value; cov² = exp(s²) − 1.
        s = math.sqrt(math.log1p(item.width**2))
        return np.minimum(item.value * np.exp(s * random.standard_normal(count)), most)
    values = np.empty(0)
    while values.size < count:
        unit = random.standard_normal(count) if item.kind == "normal" else random.uniform(-1.0, 1.0, count)
        drawn = item.value + item.width * unit
        values = np.concatenate([values, drawn[(drawn >= least) & (drawn <= most)]])
    return values[:count]


def row(draws: Mapping[str, Array], number: int) -> dict[str, float]:
    """The values of one draw by key."""
    return {key: float(values[number]) for key, values in draws.items()}


# A scene with other values of what it does not know.

AXES: Final = ("x", "y", "z")
STATIC: Final = "contact.floor_static"
KINETIC: Final = "contact.floor_kinetic"
"""The floor's two coefficients drawn apart: where one in motion would be more than the one at rest, it is that."""
IMPACT: Final = "contact.floor_impact"
"""Which of the two, or what between them, acts at an impact: drawn by its place between them, 0 the kinetic one, 1 the static."""
TIME_SCALE: Final = "motion.time_scale"
"""The factor τ on the motion's axis of time, by which its step, its periods and its duration grow, and the run's with it.

In the time t/τ every acceleration is τ² times as large and every place is the same: gravity and shaking times τ², rates times τ,
computed in the scene's own time.
"""


def varied(scene: Scene, values: Mapping[str, float]) -> Scene:
    """The scene with those values by dotted key. Raises `InputError` where a value makes no scene.

    Friction, strength and frequency are changed in place; any other key is written into the scene's own file content, which is
    then read again as a whole.
    """
    other = {key: value for key, value in values.items() if not _direct(scene, key)}
    if other:
        scene = reread(scene, other, f"{scene.source or 'the scene'}: uncertainty")
    # What is at rest first: friction in motion is at most that, and what acts at an impact lies between them.
    for key in sorted(values, key=lambda key: (key == KINETIC, key == IMPACT)):
        if key not in other:
            scene = _changed(scene, key, values[key])
    return scene


def _direct(scene: Scene, key: str) -> bool:
    if key in ("contact.floor", STATIC, KINETIC, IMPACT, "contact.statue", "motion.scale", TIME_SCALE):
        return True
    parts = key.split(".")
    if len(parts) == 3 and parts[0] == "motion" and parts[2] == "frequency_hz":
        return isinstance(getattr(scene.base_excitation, parts[1]), Harmonic)
    return False


def _changed(scene: Scene, key: str, value: float) -> Scene:
    contact, base_excitation = scene.contact, scene.base_excitation
    static, kinetic = contact.floor_static, contact.floor_kinetic
    if key == "contact.statue":
        return replace(scene, contact=replace(contact, statue=value))
    floors: dict[str, tuple[float, ...]] = {
        "contact.floor": (value, kinetic * (value / static if static > 0.0 else 1.0)),
        STATIC: (value, kinetic),
        KINETIC: (static, value),
        IMPACT: (static, kinetic, value),
    }
    if key in floors:
        return replace(scene, contact=contact.with_floor(*floors[key]))
    if key == "motion.scale":
        return amplified(scene, value / file_scale(scene))
    if key == TIME_SCALE:
        start = scene.initial
        return replace(
            scene,
            gravity_m_s2=scene.gravity_m_s2 * value**2,
            base_excitation=base_excitation.scaled(value**2),
            initial=replace(start, theta_rate_rad_s=start.theta_rate_rad_s * value),
        )
    axis = key.split(".")[1]
    return replace(
        scene,
        base_excitation=replace(base_excitation, **{axis: replace(getattr(base_excitation, axis), frequency_hz=value)}),
    )


def file_scale(scene: Scene) -> float:
    """The factor that the scene's file puts on all axes, which its excitations hold already."""
    scale = written(scene, "motion", "scale")
    return float(scale) if isinstance(scale, int | float) else 1.0


def reread(scene: Scene, values: Mapping[str, object], place: str) -> Scene:
    """The scene of its own file's content with other values by dotted key (`"none"` removes one), read again as a whole.

    `place` is where a mistake is: raises `InputError` for values that make no scene, and for a scene made in Python.
    """

    from harness.input.mistakes import mistakes_of
    from harness.input.scene_file import resolve
    from harness.input.tables import SceneFile, put

    require(scene.given, place, "a scene read from a file", "one made in Python", key=", ".join(values))
    content: dict[str, JsonValue] = copy.deepcopy(dict(scene.given))
    values_text = ", ".join(
        f"{key} = {value:.6g}" if isinstance(value, float) else f"{key} = {value}" for key, value in values.items()
    )
    for key, value in values.items():
        put(content, place, key, value)
    try:
        return resolve(SceneFile.model_validate(content), scene.source, content)
    except (ValidationError, InputError) as error:
        mistakes = error.mistakes if isinstance(error, InputError) else mistakes_of(error, SceneFile, place)
        reasons = "; ".join(str(replace(item, where=item.key, key="")) for item in mistakes)
        raise InputError(Mistake(place, ", ".join(values), "values that make a scene", values_text, reasons)) from error


Flags = NDArray[np.bool_]

START: Final = "initial.theta_rad"
SWEPT: Final = {
    "statue.mass_kg": "mass_kg",
    "statue.inertia_kg_m2": "inertia_kg_m2",
    "statue.centroid_height_m": "centroid_height_m",
    "statue.corner_left_m": "corner_left_m",
    "statue.corner_right_m": "corner_right_m",
    "pedestal.mass_kg": "pedestal_mass_kg",
    START: "theta0_rad",
    "initial.theta_rate_rad_s": "theta_rate0_rad_s",
    "contact.restitution": "restitution",
    STATIC: "floor_static",
    KINETIC: "floor_kinetic",
    IMPACT: "floor_impact",
}
"""Keys that the compiled sweep takes as they are."""
FACTORS: Final = ("scale", "vertical_scale")
"""Columns that several keys multiply."""
SHAPES: Final = ("statue.centroid_height_m", "statue.corner_left_m", "statue.corner_right_m")
"""Of these more changes than a column beside a wall (where its silhouette touches), and of corners on a pedestal (its place)."""
ENGINE_ERROR_RAD: Final = 1e-3
"""A single run's expected error: an outcome changes by it only where a draw lies that near the boundary."""
SLOW_DRAWS: Final = 300
"""Most draws where a key needs the scene to be read again for each: some milliseconds instead of a tenth of one."""


class ModelDraws(NamedTuple):
    """What the model says of each draw, shape (n,): whether it decides, whether the statue overturns, peak |θ| over α, peak slip.

    A draw that is not decided (still beyond α at the end, or `left`) did not overturn in the time computed. `left`: the model
    left its domain before a fall was decided (the pedestal tips, contact is lost, the statue slips on its support). `wall`: the
    run ended at the wall, whose impact the model does not know.
    """

    decided: Flags
    overturned: Flags
    peak_share: Array
    peak_slip_m: Array
    left: Flags
    wall: Flags

    @property
    def probability(self) -> float:
        """Share of the draws that overturn."""
        return float(self.overturned.mean())


def sweepable(scene: Scene, keys: Iterable[str]) -> bool:
    """Whether the compiled sweep takes every key of this scene."""
    return all(_sweep_of(scene, key, np.ones(1)) is not None for key in keys)


def draws_of(scene: Scene, inputs: Sequence[Uncertain], count: int, seed: int) -> dict[str, Array]:
    """Draws (count,) of a scene's inputs, fewer where each is a scene read again."""
    values = draw(inputs, count, seed)
    return values if sweepable(scene, values) else draw(inputs, min(count, SLOW_DRAWS), seed)


def model_draws(scene: Scene, draws: Mapping[str, Array]) -> ModelDraws:
    """Run the model on every draw: in one compiled sweep, or scene by scene where a key needs the scene read again."""
    if not draws or sweepable(scene, draws):
        return _swept(scene, draws)
    size = len(next(iter(draws.values())))
    return joined([_swept(varied(scene, row(draws, k)), {}) for k in range(size)])


def joined(parts: Sequence[ModelDraws]) -> ModelDraws:
    """Draws one after another."""
    return ModelDraws(*map(np.concatenate, zip(*parts, strict=True)))


def as_coefficients(scene: Scene, draws: Mapping[str, Array]) -> dict[str, Array]:
    """Draws by key as a scene takes them: what acts at an impact is drawn as a share of the way to static friction."""
    acts = {IMPACT: _sweep(scene, draws)["floor_impact"]} if IMPACT in draws else {}
    return {**draws, **acts}


def _sweep(scene: Scene, draws: Mapping[str, Array]) -> dict[str, Array]:
    """The draws of what a sweep takes, by its names for them."""
    sweep: dict[str, Array] = {}
    for key, values in draws.items():
        for name, column in (_sweep_of(scene, key, values) or {}).items():
            sweep[name] = sweep.get(name, 1.0) * column if name in FACTORS else column
    contact = scene.contact
    static, kinetic = sweep.get("floor_static", contact.floor_static), sweep.get("floor_kinetic", contact.floor_kinetic)
    if sweep.keys() & {"floor_static", "floor_kinetic"}:
        sweep["floor_kinetic"] = kinetic = np.minimum(kinetic, static)
    share: float | Array | None = sweep.get("floor_impact")
    if share is None and not isinstance(contact.floor_impact, str):
        apart = contact.floor_static - contact.floor_kinetic
        share = (contact.floor_impact - contact.floor_kinetic) / apart if apart > 0.0 else 0.0
    if share is not None and sweep.keys() & {"floor_static", "floor_kinetic", "floor_impact"}:
        sweep["floor_impact"] = np.clip(kinetic + np.asarray(share) * (static - kinetic), kinetic, static)
    return sweep


def _swept(scene: Scene, draws: Mapping[str, Array]) -> ModelDraws:
    from analytic import Outcome, ensemble

    sweep = _sweep(scene, draws)
    _check_starts(scene, draws.get(START))
    options: dict[str, Any] = dict(twoblock.keywords(scene))
    swept = ensemble(
        twoblock.block_of(scene),
        scene.base_excitation.x,
        scene.base_excitation.z,
        sweep=sweep or {"mass_kg": [scene.statue.mass_kg]},
        domain=True,
        **options,
    )
    # Past its instant of no return a statue that falls falls, whatever its pedestal does then.
    # (One that begins beyond its balance, or is yet to pass it as the run ends, has no such instant.)
    falls = swept.overturned & np.isfinite(swept.no_return_time_s)
    left = swept.left_domain_s < np.where(falls, swept.no_return_time_s, np.inf)
    stands, over = ~left & (swept.outcomes == Outcome.STANDS), ~left & swept.overturned
    left |= np.isin(swept.outcomes, (Outcome.LIFT_OFF, Outcome.FRICTION_PARADOX))
    height = sweep.get("centroid_height_m", scene.statue.centroid_height_m)
    to_left = sweep.get("corner_left_m", scene.statue.corner_left_m)
    alpha = np.arctan(np.minimum(to_left, sweep.get("corner_right_m", scene.statue.corner_right_m)) / height)
    wall = ~left & (swept.outcomes == Outcome.TOUCHES_WALL)
    decided = np.asarray(stands | over, dtype=bool)
    answers = ModelDraws(decided, np.asarray(over), swept.peak_theta_rad / alpha, swept.peak_slip_m, left, wall)
    return repeated(answers, len(next(iter(draws.values()), (0,))))


def _check_starts(scene: Scene, theta_rad: Array | None) -> None:
    """Raise `InputError` for draws of the start that lie behind the wall."""
    wall, block = twoblock.wall_of(scene), twoblock.block_of(scene)
    if wall is None or theta_rad is None:
        return
    behind = [theta for theta in (float(theta_rad.min()), float(theta_rad.max())) if not wall.gap_m(block, theta) > 0.0]
    if behind:
        wanted = f"starts before the wall, which {scene.wall_rotation_rad:.6g} rad to the {wall.side} reach"
        raise InputError(
            Mistake(str(scene.source or "the scene"), f'uncertainty."{START}"', wanted, f"{behind[0]:.6g}")
        )


def repeated(draws: ModelDraws, size: int) -> ModelDraws:
    """One answer for all draws where nothing that is drawn touches it."""
    if draws.overturned.size == size:
        return draws
    return ModelDraws._make(column.repeat(size) for column in draws)


def _sweep_of(scene: Scene, key: str, values: Array) -> dict[str, Array] | None:
    """Columns of the compiled sweep for one key; None where it has none."""
    contact, base_excitation = scene.contact, scene.base_excitation
    if key in SHAPES and (scene.wall is not None or (scene.pedestal is not None and key != SHAPES[0])):
        return None
    if scene.pedestal is None and key in (STATIC, KINETIC, "contact.floor"):
        return {}
    if key in SWEPT:
        return {SWEPT[key]: values} if scene.statue.solid is None or not key.startswith("statue.") else None
    if key == "contact.floor":
        factor = values / contact.floor_static if contact.floor_static > 0.0 else np.ones_like(values)
        return {"floor_static": contact.floor_static * factor, "floor_kinetic": contact.floor_kinetic * factor}
    if key in ("motion.scale", "motion.time_scale"):
        if key == "motion.time_scale" and scene.initial.theta_rate_rad_s != 0.0:
            return None
        factor = values / file_scale(scene) if key == "motion.scale" else values**2
        own = {"scale": factor} | ({} if isinstance(base_excitation.z, ZeroExcitation) else {"vertical_scale": factor})
        # The axis of time stretched: see harness.questions.assess.model_draws.
        return own if key == "motion.scale" else {**own, "gravity_m_s2": scene.gravity_m_s2 * factor}
    if key == "motion.x.frequency_hz" and isinstance(base_excitation.x, Harmonic):
        return {"frequency_hz": values} if base_excitation.x.amplitude_m_s2 else {}
    if key == "contact.statue":
        return {"statue_friction": values}
    if key == "motion.y.frequency_hz" and isinstance(base_excitation.y, Harmonic):
        # The planar statue does not move across its plane.
        return {}
    return None


# The exact body in three dimensions on the draws of a scene that is shaken across its rocking plane.

SPACE: Final = "spatial"
MOST_STEPS: Final = 150_000
"""Steps of all runs together after which no draws are begun: some"""
SPACE_S: Final = 3.0
"""seconds of one core, and"""
RUN_STEPS: Final = 20_000
"""steps after which one run is given up: what stands or falls in a record of a minute takes a thousand at the median."""
RUN_COST: Final = 20
"""Steps for which one run is counted at least: what never leaves the floor costs the setting up alone."""
OWN_COST: Final = 5
"""Times a draw's steps what those of a run of its own take, with its history and what follows from that."""
BATCH: Final = 16
"""Draws before the first look at the steps; later batches take at most a quarter of what is left."""


def shaken_across(scene: Scene) -> bool:
    """Whether the scene is shaken across the rocking plane, of which the planar model knows nothing."""
    return not isinstance(scene.base_excitation.y, ZeroExcitation)


def space_draws(
    scene: Scene,
    values: Mapping[str, Array],
    most_steps: int = MOST_STEPS,
    change: Callable[[Scene], Scene] = lambda scene: scene,
) -> ModelDraws | None:
    """What the exact body says of as many of the draws (n,) as the steps allow, each drawn and then changed: how it ends alone.

    None where it does not know all of the scene (a pedestal, a wall, a prescribed impact, a moving table).
    """
    from analytic import AnalyticInputError

    changed = change(scene)
    if not stands_alone(changed) or changed.initial.pose is not None:
        return None
    size, left, runs = len(next(iter(values.values()))), most_steps, 0
    parts: list[NDArray[np.object_]] = []
    batch = BATCH
    while runs < size and left > 0:
        try:
            columns = {key: column[runs : runs + batch] for key, column in values.items()}
            outcomes, steps = _batch(scene, columns, change)
            # Where the end finds it between its balance and the floor, a run of its own tells by energy what follows.
            for k in np.flatnonzero((outcomes == "undecided") & (steps < RUN_STEPS)).tolist():
                run = _in_space(change(varied(scene, row(columns, k))))
                outcomes[k], steps[k] = run.outcome, steps[k] + OWN_COST * run.steps
        except AnalyticInputError:  # a base the exact body does not take
            return None
        runs, left = runs + outcomes.size, left - int(np.maximum(steps, RUN_COST).sum())
        batch = max(BATCH, left * runs // (4 * (most_steps - left)))
        parts.append(outcomes)
    ends = np.concatenate(parts)
    fell, unknown = np.char.startswith(ends.astype(str), "overturned"), np.full(ends.size, np.nan)
    # A run that was given up, or left the exact body's domain, is not decided.
    return ModelDraws(fell | (ends == "stands"), fell, unknown, unknown, *np.zeros((2, ends.size), dtype=bool))


def _in_space(scene: Scene) -> Run:
    """The exact body's run of one scene for its outcome, with the local error of a draw's."""
    engine = engines.load(SPACE)
    return engine.simulate(scene, engine.refinement_levels(scene)[0], RunOptions(history=False, stated=False))


def _batch(
    scene: Scene, values: Mapping[str, Array], change: Callable[[Scene], Scene]
) -> tuple[NDArray[np.object_], NDArray[np.int64]]:
    """Outcome and steps of each draw."""
    from analytic import spatial
    from harness.engines.spatial import problem_of

    sweep = {}
    if "motion.scale" in values:
        sweep["scale"] = values["motion.scale"] / file_scale(scene)
    if "contact.statue" in values:
        sweep["friction"] = values["contact.statue"]
    if sweep and len(sweep) == len(values):
        swept = spatial.outcomes(problem_of(change(scene)), sweep, most_steps=RUN_STEPS)
        return swept.outcomes, swept.steps

    def alone(number: int) -> spatial.Outcomes:
        drawn = problem_of(change(varied(scene, row(values, number))))
        return spatial.outcomes(drawn, {"scale": [1.0]}, most_steps=RUN_STEPS, threads=1)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        each = list(pool.map(alone, range(len(next(iter(values.values()))))))
    return np.concatenate([item.outcomes for item in each]), np.concatenate([item.steps for item in each])
