"""How probable a fall is over what a scene does not know: by a model on every draw, by an engine from few runs of its own.

Here are the draws, what the models say of each, and the probability, the room and the sensitivity that follow.

The model's answer to a draw costs nothing beside an engine's, and tells much of it. The draws are divided by the model's answer
into strata of known weight; the engine is run on some draws of each; P = Σ w_h p_h (Cochran, Sampling Techniques, ch. 5). The
estimate is unbiased whatever the model says: a wrong model costs runs, not truth. Runs go where w_h √(p_h (1 − p_h)) is largest
(Neyman).
"""

import copy
import math
import os
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from statistics import NormalDist
from typing import Final, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import JsonValue, ValidationError

from analytic import AnalyticInputError, Harmonic, ZeroExcitation, ensemble
from harness import engines
from harness.accuracy.horizon import MODEL, amplified
from harness.accuracy.refinement import first_level
from harness.comparison.statistics import wilson
from harness.engines import stands_alone
from harness.engines.base import Engine, EngineFailure
from harness.input.mistakes import mistakes_of
from harness.input.scene_file import resolve
from harness.input.tables import IMPACT, SceneFile, assumption, put
from harness.model import (
    Array,
    Finding,
    InputError,
    Mistake,
    Outcome,
    Run,
    RunOptions,
    Scene,
    Uncertain,
    caution,
    info,
    require,
    written,
)
from harness.model import two_block as twoblock
from harness.records.assess import CONTRADICTED, Assessment, FragilityRecord, Index, worst

# What a scene does not know, and seeded draws of it.

FREQUENCIES: Final = {f"motion.{axis}.frequency_hz": axis for axis in ("x", "y", "z")}
"""The axis of each key that is the frequency of a harmonic motion."""
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
    assumed = {} if scene.pedestal is None else {"contact.floor": scene.contact.floor_static}
    contact, chosen = scene.contact, written(scene, "contact", "floor_impact")
    matters = contact.floor_kinetic < contact.floor_static and scene.form.pedestal_at_impact == "momentum"
    moving = {key: getattr(scene.base_excitation, axis) for key, axis in FREQUENCIES.items()}
    if not all(isinstance(item, ZeroExcitation) for item in moving.values()):
        assumed["motion.scale"] = file_scale(scene)
    assumed |= {key: item.frequency_hz for key, item in moving.items() if isinstance(item, Harmonic)}
    if scene.pedestal is None and assumed:
        assumed["contact.statue"] = scene.contact.statue
    # The last, so that the others' draws are the same with it and without.
    if scene.pedestal is not None and matters and chosen is None:
        assumed[IMPACT] = 0.5
    return tuple(
        Uncertain(key, spread.kind, value, spread.width)
        for key, value in assumed.items()
        if value > 0.0 and (spread := assumption(key)) is not None
    )


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
        # The median is the scene's value; cov² = exp(s²) − 1.
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
        return _of_score(item, random.standard_normal(count))
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

STATIC: Final = "contact.floor_static"
KINETIC: Final = "contact.floor_kinetic"
"""The floor's two coefficients drawn apart: where one in motion would be more than the one at rest, it is that."""
TIME_SCALE: Final = "motion.time_scale"
"""The factor τ on the motion's axis of time, by which its step, its periods and its duration grow, and the run's with it.

In the time t/τ every acceleration is τ² times as large and every place is the same: gravity and shaking times τ², rates times τ,
computed in the scene's own time.
"""


DIRECT: Final = frozenset(
    ("contact.floor", STATIC, KINETIC, IMPACT, "contact.statue", "motion.scale", TIME_SCALE),
)
"""Keys that are changed in place, as is a harmonic motion's frequency."""


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
    axis = FREQUENCIES.get(key)
    return key in DIRECT or (axis is not None and isinstance(getattr(scene.base_excitation, axis), Harmonic))


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
    axis = FREQUENCIES[key]
    harmonic = replace(getattr(base_excitation, axis), frequency_hz=value)
    return replace(scene, base_excitation=replace(base_excitation, **{axis: harmonic}))


def file_scale(scene: Scene) -> float:
    """The factor that the scene's file puts on all axes, which its excitations hold already."""
    scale = written(scene, "motion", "scale")
    return float(scale) if isinstance(scale, int | float) else 1.0


def reread(scene: Scene, values: Mapping[str, object], place: str) -> Scene:
    """The scene of its own file's content with other values by dotted key (`"none"` removes one), read again as a whole.

    `place` is where a mistake is: raises `InputError` for values that make no scene, and for a scene made in Python.
    """
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
Ints = NDArray[np.int64]

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
    "contact.statue": "statue_friction",
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
    sweep = _sweep(scene, draws)
    _check_starts(scene, draws.get(START))
    swept = ensemble(  # type: ignore[misc]
        twoblock.block_of(scene),
        scene.base_excitation.x,
        scene.base_excitation.z,
        sweep=sweep or {"mass_kg": [scene.statue.mass_kg]},
        domain=True,
        **twoblock.keywords(scene),
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
    where = str(scene.source or "the scene")
    wanted = f"starts before the wall, which {scene.wall_rotation_rad:.6g} rad to the {wall.side} reach"
    for theta in (float(theta_rad.min()), float(theta_rad.max())):
        require(wall.gap_m(block, theta) > 0.0, where, wanted, f"{theta:.6g}", key=f'uncertainty."{START}"')


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
    if key == "motion.scale" or (key == TIME_SCALE and scene.initial.theta_rate_rad_s == 0.0):
        factor = values / file_scale(scene) if key == "motion.scale" else values**2
        own = {"scale": factor} | ({} if isinstance(base_excitation.z, ZeroExcitation) else {"vertical_scale": factor})
        return own if key == "motion.scale" else {**own, "gravity_m_s2": scene.gravity_m_s2 * factor}
    if key == "motion.x.frequency_hz" and isinstance(base_excitation.x, Harmonic):
        return {"frequency_hz": values} if base_excitation.x.amplitude_m_s2 else {}
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

    units = {"motion.scale": ("scale", file_scale(scene)), "contact.statue": ("friction", 1.0)}
    sweep = {name: values[key] / unit for key, (name, unit) in units.items() if key in values}
    if sweep and len(sweep) == len(values):
        swept = spatial.outcomes(problem_of(change(scene)), sweep, most_steps=RUN_STEPS)
        return swept.outcomes, swept.steps

    def alone(number: int) -> spatial.Outcomes:
        drawn = problem_of(change(varied(scene, row(values, number))))
        return spatial.outcomes(drawn, {"scale": [1.0]}, most_steps=RUN_STEPS, threads=1)

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        each = list(pool.map(alone, range(len(next(iter(values.values()))))))
    return np.concatenate([item.outcomes for item in each]), np.concatenate([item.steps for item in each])


SAFE_SHARE: Final = 0.6
"""Peak rotation of the model, over α, below which its statue is far from falling: a stratum of its own."""
PILOT: Final = 10
"""Runs of every stratum before any is judged."""
RUNS_BATCH: Final = 16
"""Runs between two looks at the interval, on however many cores: what is answered is no matter of the machine."""
LEVEL: Final = 0.90
"""Level of every interval: what decides about a statue is asked to ± 0.05 at 90 %."""

End = bool | Outcome | None
"""How an engine's run of a draw ended: whether the statue falls, `TOUCHES_WALL`, None without an answer."""
Runs = Callable[[Sequence[int]], Sequence[End]]
"""From numbers of draws to how the engine's runs of them ended."""


def strata_of(model: ModelDraws) -> Ints:
    """Number of each draw's stratum, shape (n,): far from falling, near it (or not decided), overturned."""
    near = ~model.overturned & ((model.peak_share >= SAFE_SHARE) | ~model.decided)
    return np.where(model.overturned, 2, np.where(near, 1, 0))


def estimate(model: ModelDraws, run: Runs, *, half_width: float, most_runs: int, batch: int = RUNS_BATCH) -> Assessment:
    """Run the engine on draws until the interval's half width is reached, or `most_runs` are made."""
    strata = strata_of(model)
    queues = [np.flatnonzero(strata == h).tolist() for h in range(3)]
    tally = _Tally(np.bincount(strata, minlength=3) / strata.size)
    tally.add(run, [(h, queues[h].pop(0)) for h in range(3) for _ in range(min(PILOT, len(queues[h])))])
    while tally.runs < most_runs and any(queues) and tally.half_width > half_width:
        picks: list[tuple[int, int]] = []
        pending = np.zeros(3)
        while len(picks) < min(batch, most_runs - tally.runs) and any(queues):
            h = tally.neediest(pending, [bool(queue) for queue in queues])
            pending[h] += 1
            picks.append((h, queues[h].pop(0)))
        tally.add(run, picks)
    return tally.estimate(strata.size)


def jeffreys(fell: float, runs: float, level: float = LEVEL) -> tuple[float, float, float]:
    """The share that fell of so many runs (a half of none), and its interval at a level (Jeffreys)."""
    from scipy.special import betaincinv

    tail, missed = 0.5 - 0.5 * level, runs - fell
    low = float(betaincinv(fell + 0.5, missed + 0.5, tail)) if fell else 0.0
    high = float(betaincinv(fell + 0.5, missed + 0.5, 1.0 - tail)) if missed else 1.0
    return fell / runs if runs else 0.5, low, high


class _Tally:
    """Runs and falls of each stratum (3,), of known weights."""

    def __init__(self, weights: Array) -> None:
        self._weights, self.runs = weights, 0
        self._decided, self._fell, self._open, self._walls = np.zeros((4, weights.size))

    def add(self, run: Runs, picks: Sequence[tuple[int, int]]) -> None:
        """Run the engine on these draws and count."""
        for (h, _), fell in zip(picks, run([draw for _, draw in picks]), strict=True):
            self.runs += 1
            if not isinstance(fell, bool):
                self._open[h] += 1
                self._walls[h] += fell is Outcome.TOUCHES_WALL
            else:
                self._decided[h] += 1
                self._fell[h] += fell

    def neediest(self, pending: Array, left: Sequence[bool]) -> int:
        """Of the strata with draws that are left, the one in which one more run takes most off the variance."""
        runs = self._decided + pending + 1.0
        return int(np.argmax(np.where(left, self._weights**2 * self._spread() / (runs * (runs + 1.0)), -1.0)))

    def _spread(self) -> Array:
        """p (1 − p), p drawn towards a half by two runs (Agresti and Coull): never nothing, however few the runs."""
        p = (self._fell + 1.0) / (self._decided + 2.0)
        return np.asarray(p * (1.0 - p))

    @property
    def half_width(self) -> float:
        """Half width at which runs end, of a normal interval: wider than the one told, so what fell so far moves the end less."""
        variance = np.sum(self._weights**2 * self._spread() / np.maximum(self._decided, 1.0))
        return NormalDist().inv_cdf(0.5 + 0.5 * LEVEL) * math.sqrt(variance)

    def estimate(self, draws: int) -> Assessment:
        """The probability so far, of so many draws; no number where every run came to no end.

        Its interval is that of Σ w p_h from those of each p_h (Jeffreys), arms added as squares (Zou, Huang and Zhang 2009).
        """
        known = self._decided > 0.0
        runs = np.maximum(self._open + self._decided, 1.0)
        undecided, wall = (float(self._weights @ (each / runs)) for each in (self._open, self._walls))
        if not known.any():
            return Assessment(math.nan, 0.0, 1.0, LEVEL, draws, self.runs, 1.0, touches_wall=wall)
        share, low, high = np.array([jeffreys(*each) for each in zip(self._fell, self._decided, strict=True)]).T
        p = float(np.sum((self._weights * share)[known]) / np.sum(self._weights[known]))
        middle = float(self._weights @ share)
        below, above = (math.hypot(*(self._weights * arms)) for arms in (share - low, high - share))
        least, most = max(middle - below, 0.0) * (1.0 - undecided), min(middle + above, 1.0)
        high = max(most + undecided * (1.0 - most), p)
        return Assessment(p, min(least, p), high, LEVEL, draws, self.runs, undecided, touches_wall=wall)


# One run of an engine on a draw.


def run_of(engine: Engine, scene: Scene) -> Run | None:
    """An engine's run of a draw, at the coarsest step that is expected to do; None where it fails."""
    try:
        settings, _ = first_level(engine.refinement_levels(scene), ENGINE_ERROR_RAD, 1.0)
        return engine.simulate(scene, settings, RunOptions())
    except EngineFailure:
        return None


def end_of(run: Run | None) -> End:
    """How a run of a draw ended."""
    if run is None:
        return None
    return run.outcome if run.outcome is Outcome.TOUCHES_WALL else run.outcome.fell


# The probability beside every single run: the analytic model's, and in three dimensions the exact body's.
#
# A draw in which the model leaves its domain before a fall is decided is no answer of the model: a contact engine answers a
# sample of such draws, P = Σ fell/n + w q, where w is their share and q what falls of the sample; what neither answers is open,
# and counts as standing in the interval's low end, as falling in its high one.

RUN_DRAWS: Final = 10_000
"""Draws beside every single run: ± 0.8 % at a half, in half a second for a harmonic motion of 10 s."""
SAMPLER: Final = "pymunk"
"""The engine that answers draws outside the model's domain: in the plane, with all that the model leaves out there."""
OPEN: Final = 0.02
"""Share of draws outside the model's domain that needs no answer: it widens the interval by no more."""
SAMPLE_STEPS: Final = 50_000
"""Steps of the engine's runs beside a single run, a count so that an answer is the same wherever it is computed: 20 runs of a
motion of 10 s at 4 ms."""
SAMPLE_S: Final = 2.0
"""What they take of the processor, s, as a forecast tells it."""
MOST_SAMPLED: Final = 60
NONE_SAMPLED: Final[Mapping[int, End]] = {}
TRIAL_SHARE: Final = 0.01
"""Of the draws are timed before all of them are run."""


def assess_models(scene: Scene, draws: int = RUN_DRAWS, *, leaves_plane: bool = False) -> dict[str, Assessment]:
    """The analytic model's own probability, and the exact body's where the scene is shaken across its rocking plane or a run has
    shown that its statue leaves it.

    Empty where nothing of the scene is uncertain, or it begins from a pose in space.
    """
    inputs = uncertain_inputs(scene)
    if not inputs or scene.initial.pose is not None:
        return {}
    values = draws_of(scene, inputs, draws, seed=0)
    model = model_draws(scene, values)
    fell = sampled(model, lambda number: varied(scene, row(values, number)))
    leaves_plane |= shaken_across(scene)
    answers = {MODEL: probability_of(model, fell, plane_only=leaves_plane)}
    space = space_draws(scene, values) if leaves_plane else None
    return answers if space is None else {**answers, SPACE: probability_of(space)}


def assessed_s(scene: Scene) -> float:
    """Processor seconds that `assess_models` is expected to take: timed on a share of its draws."""
    inputs = uncertain_inputs(scene)
    if not inputs or scene.initial.pose is not None:
        return 0.0
    values = draws_of(scene, inputs, RUN_DRAWS, seed=0)
    size = next(iter(values.values())).size
    some = {key: column[: math.ceil(TRIAL_SHARE * size)] for key, column in values.items()}
    try:
        model_draws(scene, some)  # the first time its code is loaded
    except AnalyticInputError:  # the model refuses this scene; its own run says why
        return 0.0
    begin = time.process_time()
    model = model_draws(scene, some)
    seconds = (time.process_time() - begin) * size / model.left.size
    return seconds + SAMPLE_S * bool(model.left.mean() > OPEN) + SPACE_S * shaken_across(scene)


def sampled(model: ModelDraws, scene_of: Callable[[int], Scene]) -> dict[int, End]:
    """How the engine's runs end, by number of the draw, in the first draws outside the model's domain: as many as
    `SAMPLE_STEPS` allows, none where they are few. `scene_of` gives the scene of a draw."""
    engine, fell = engines.load(SAMPLER), dict[int, End]()
    if model.left.size == 0 or model.left.mean() <= OPEN or engine.missing() is not None:
        return fell
    steps = 0
    for number in np.flatnonzero(model.left)[:MOST_SAMPLED].tolist():
        if steps >= SAMPLE_STEPS:
            break
        run = run_of(engine, scene_of(number))
        fell[number] = end_of(run)
        steps += 0 if run is None else run.steps
    return fell


class Outside(NamedTuple):
    """What an engine's sample answers of the draws outside the model's domain, as shares of all draws: what falls, with its
    interval, what nobody answers, and what of that touches the wall.
    """

    falls: float
    low: float
    high: float
    undecided: float
    wall: float = 0.0

    @classmethod
    def of(cls, model: ModelDraws, fell: Mapping[int, End], level: float = LEVEL) -> Self:
        """Of the draws, where `fell` holds the engine's runs by number of the draw."""
        runs = [fell[number] for number in np.flatnonzero(model.left).tolist() if number in fell]
        ends = [each for each in runs if isinstance(each, bool)]
        size, left, unknown = model.decided.size, int(model.left.sum()), int((~model.decided).sum())
        answers = left * len(ends) / len(runs) if runs else 0.0
        answered = answers / size
        falls, low, high = (answered * share for share in jeffreys(sum(ends), len(ends), level))
        walls = left / size * runs.count(Outcome.TOUCHES_WALL) / len(runs) if runs else 0.0
        return cls(falls, low, high, max(unknown - answers, 0.0) / size, walls)


def probability_of(
    model: ModelDraws,
    fell: Mapping[int, End] = NONE_SAMPLED,
    engine: str = SAMPLER,
    *,
    plane_only: bool = False,
) -> Assessment:
    """The share of the draws that overturn, by the model where it answers and by the engine's runs (`fell`, by number of the
    draw) where the model left its domain, with its interval. Raises `ValueError` without draws."""
    size, fallen = model.overturned.size, int(model.overturned.sum())
    outside, runs = Outside.of(model, fell), int(model.left[list(fell)].sum())
    own, most = wilson(fallen, size, LEVEL), wilson(fallen + round(outside.undecided * size), size, LEVEL)
    if own is None or most is None:
        raise ValueError("a probability without draws")
    p = own.value + outside.falls
    below = math.hypot(own.value - own.low, outside.falls - outside.low)
    above = math.hypot(most.high - most.value, outside.high - outside.falls)
    return Assessment(
        probability_overturned=p,
        low=max(p - below, 0.0),
        high=min(p + outside.undecided + above, 1.0),
        level=LEVEL,
        draws=size,
        engine_runs=size,
        undecided=outside.undecided,
        plane_only=plane_only,
        left_domain=float(model.left.mean()),
        sampler=engine if runs else "",
        sampled=runs,
        touches_wall=float(model.wall.mean()) + outside.wall,
    )


def finding_of(answers: Mapping[str, Assessment], *, contradicted: bool = False) -> Finding:
    """How probable a fall is, by the answer in which it is the most probable.

    The interval of one model's draws holds neither another model nor a friction that nobody knows: so a number is `about`; where
    draws have no answer, or an engine answered a sample of them, the interval is told, and where it is wide no number at all.
    `contradicted`: with the values as given a model in space ends otherwise, by what a model in the plane leaves out.
    """
    name = worst(answers)
    item = answers[name]
    values = {
        "share": item.probability_overturned,
        "low": item.low,
        "high": item.high,
        "undecided": max(item.undecided - item.touches_wall, 0.0),
        "touches_wall": item.touches_wall,
        "model": name,
        "planar": [CONTRADICTED if contradicted else "in_plane"] if item.plane_only else [],
        "sampled": item.sampled,
        "sampler": item.sampler,
    }
    if not item.tells:
        return caution("probability_open", **values)
    if item.undecided or item.sampled:
        return caution("probability_between", **values)
    if item.probability_overturned in (0.0, 1.0):
        return info("probability_extreme", none=item.probability_overturned == 0.0, **values)
    return info("probability", **values)


# Which input matters, and how strong a shaking the statue bears: one model on more draws.

MOTION_FACTORS: Final = tuple(float(value) for value in np.geomspace(0.25, 4.0, 25))
"""Factors on the motion at which the probability is found: a sixteenth part of the range from 1/4 to 4 apart, each 12 %."""
FRAGILITY_DRAWS: Final = 1000
"""Draws at each factor: ± 1.6 % at a half."""
FRAGILITY_SPACE_DRAWS: Final = 64
"""Draws at each factor in space: ± 10 % at a half."""
FRAGILITY_SPACE_STEPS: Final = 80_000
"""Steps of the runs in space at one factor together: some three seconds of one core."""
INDEX_DRAWS: Final = 4000
"""Draws of each of the two matrices: a first index is known to about ± 0.03."""
ASKED: Final = (0.05, 0.16, 0.50)
"""Probabilities whose factor is told."""
LEAST_INDEXED: Final = 100
"""Fewer draws tell a first index to ± 0.2 at best."""
RANK_WIDTH: Final = 2.0
"""Half width at 90 % of an index by ranks, over 1/√n: the spread is 1.2/√n at the most where a sum of two normal inputs decides,
whatever their shares, and 100 to 1000 draws are made."""
NORMAL_90: Final = 1.645
NEIGHBOUR_WIDTH: Final = 1.4 * NORMAL_90
"""Half width at 90 % of a total index by neighbours, over that of n independent pairs: most draws stand in two pairs."""
MOST_OTHERS: Final = 3
"""Inputs in which neighbours are sought: 300 draws lie so far apart in three that a total gains up to 0.05, in five 0.19."""
OTHER_SEED: Final = 1_000_003
"""Added to the seed for the second matrix, so that the two are independent."""


def fragility(scene: Scene, inputs: Sequence[Uncertain], seed: int, count: int = FRAGILITY_DRAWS) -> FragilityRecord:
    """Probability of overturning by a factor on all axes together, and the factors at which it is 5, 16 and 50 %.

    Where a draw needs the scene read again, it is read once for all factors.
    """
    draws = draw(inputs, count, seed)
    own = draws.pop("motion.scale", np.full(count, file_scale(scene)))
    if sweepable(scene, draws):
        answers = [model_draws(scene, {**draws, "motion.scale": own * each}) for each in MOTION_FACTORS]
        return fragility_of(MOTION_FACTORS, answers)
    by_draw = [
        model_draws(varied(scene, row(draws, k)), {"motion.scale": own[k] * np.array(MOTION_FACTORS)})
        for k in range(count)
    ]
    by_factor = [np.transpose(column) for column in zip(*by_draw, strict=True)]
    return fragility_of(
        MOTION_FACTORS, [ModelDraws(*(column[k] for column in by_factor)) for k in range(len(MOTION_FACTORS))]
    )


def fragility_in_space(scene: Scene, inputs: Sequence[Uncertain], seed: int) -> FragilityRecord | None:
    """The same by the exact body, at every second factor; None for a scene that it does not know."""
    draws, factors = draw(inputs, FRAGILITY_SPACE_DRAWS, seed), MOTION_FACTORS[::2]
    own = draws.get("motion.scale", np.full(FRAGILITY_SPACE_DRAWS, file_scale(scene)))
    answers = [space_draws(scene, {**draws, "motion.scale": own * each}, FRAGILITY_SPACE_STEPS) for each in factors]
    known = [each for each in answers if each is not None]
    return fragility_of(factors, known, SPACE) if len(known) == len(factors) else None


def fragility_of(factors: Sequence[float], answers: Sequence[ModelDraws], model: str = "analytic") -> FragilityRecord:
    """The fragility by what a model says of the draws at each factor."""
    counts = [(int(each.overturned.sum()), int((~each.decided).sum()), each.decided.size) for each in answers]
    falls = [fell / size for fell, _, size in counts]
    none = [wilson(fell, size, LEVEL) for fell, _, size in counts]
    every = [wilson(fell + undecided, size, LEVEL) for fell, undecided, size in counts]
    low, high = [item.low for item in none if item], [item.high for item in every if item]
    undecided_share = [undecided / size for _, undecided, size in counts]
    factor_at, soonest_at, latest_at = (factors_at(factors, curve) for curve in (falls, high, low))
    size = min(size for *_, size in counts)
    return FragilityRecord(factors, falls, size, factor_at, model, low, high, undecided_share, soonest_at, latest_at)


def factors_at(factors: Sequence[float], probability: Sequence[float]) -> dict[str, float | None]:
    """The factors at which the probability first reaches 5, 16 and 50 %; None where it never does."""
    rising = np.maximum.accumulate(np.nan_to_num(probability)).tolist()
    return {f"{asked:.2f}": crossing(rising, math.nextafter(asked, 0.0), factors) for asked in ASKED}


def crossing(heights: Sequence[float], level: float, at: Sequence[float]) -> float | None:
    """Where a value is first above a level, between two points in proportion on a logarithmic scale (halfway to no number)."""
    above = next((j for j, height in enumerate(heights) if height > level), None)
    if above is None or above == 0:
        return None if above is None else at[0]
    low, high = heights[above - 1], heights[above]
    share = (level - low) / (high - low) if math.isfinite(high) else 0.5
    return float(at[above - 1] * (at[above] / at[above - 1]) ** share)


def indices(scene: Scene, inputs: Sequence[Uncertain], seed: int) -> dict[str, Index]:
    """First and total variance-based index of every input for whether the statue overturns (Saltelli 2010, Jansen 1999).

    Inputs that correlate have one index together: only groups that are independent divide the variance.
    The first is the share of the variance that goes when this input is known; the total the share that stays when all others are.
    """
    a, b = draw(inputs, INDEX_DRAWS, seed), draw(inputs, INDEX_DRAWS, seed + OTHER_SEED)
    fell_a, fell_b = (model_draws(scene, draws).overturned for draws in (a, b))
    variance = float(np.var(np.concatenate([fell_a, fell_b])))
    if variance == 0.0:
        return {}
    result = {}
    for group in groups(inputs):
        fell = model_draws(scene, {**a, **{key: b[key] for key in group}}).overturned
        unlike = [float(np.mean(other != fell)) for other in (fell_b, fell_a)]
        half_width = max(NORMAL_90 * math.sqrt(share * (1.0 - share) / fell.size) for share in unlike) / (
            2.0 * variance
        )
        first, total = 1.0 - unlike[0] / (2.0 * variance), unlike[1] / (2.0 * variance)
        result[" with ".join(group)] = Index(first, half_width, total)
    return result


def indices_of_draws(inputs: Sequence[Uncertain], values: Mapping[str, Array], fell: Flags) -> dict[str, Index]:
    """First and total index of every input that depends on no other, from outcomes (n,) of the first draws alone.

    First: draws are put in the order of the input and each is held against the next (Gamboa, Gremaud, Klein and Lagnoux 2022).
    Total: each is held against the nearest in all other inputs by rank (Broto, Bachoc and Depecker 2020); None beside more than
    `MOST_OTHERS` of these. Empty where draws are too few or end alike.
    """
    size = fell.size
    if size < LEAST_INDEXED or (variance := float(np.var(fell))) == 0.0:
        return {}
    result = {}
    for key in (group[0] for group in groups(inputs) if len(group) == 1):
        ordered = fell[np.argsort(values[key][:size])].astype(np.float64)
        first = (float(np.mean(ordered * np.roll(ordered, -1))) - float(ordered.mean()) ** 2) / variance
        others = [column[:size] for other, column in values.items() if other != key]
        half_width, total = RANK_WIDTH / math.sqrt(size), None
        if 1 <= len(others) <= MOST_OTHERS:
            unlike = float(np.mean(fell != fell[_nearest(others)]))
            total = unlike / (2.0 * variance)
            spread = NEIGHBOUR_WIDTH * math.sqrt(unlike * (1.0 - unlike) / size) / (2.0 * variance)
            half_width = max(half_width, spread)
        result[key] = Index(first, half_width, total)
    return result


def _nearest(columns: Sequence[Array]) -> NDArray[np.int64]:
    """For each draw (n,) the one that is nearest in these columns, each by rank."""
    from scipy.spatial import KDTree

    ranks = np.column_stack([np.argsort(np.argsort(column)) for column in columns]).astype(np.float64)
    return np.asarray(KDTree(ranks).query(ranks, k=[2])[1])[:, 0]
