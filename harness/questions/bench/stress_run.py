"""The stress run: hard scenes and stability maps, on all cores and in parts; one record."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Final

import numpy as np

from harness import engines
from harness.accuracy.horizon import by_model
from harness.accuracy.refinement import run_to_accuracy
from harness.comparison.scores import error_rad as difference_rad
from harness.engines.base import Engine, EngineFailure, Settings
from harness.input.motions.recordfile import STANDARD_GRAVITY_M_S2
from harness.model import SKIPS, Outcome, Run, RunOptions, Scene, number
from harness.questions.bench.parts import Measurement, Part
from harness.questions.bench.standard_scenes import COLUMN, EQUAL, PAESTUM, PEDESTAL, harmonic, scene_of
from harness.records.bench import HardRow, KnownFailure, Measure, StabilityCell, StressRecord, answer_of, findings_of

# What must hold in any run of a hard scene; every check gives its number and how much is allowed.

AGREES_RAD: Final = 1e-3
"""Error that is allowed of any scene: the accuracy that a run aims at unless told otherwise."""
AGREES_SHARE: Final = 0.05
"""Share of the exact peak that the error may be, where this is less: else a statue that never moved would agree."""
CREEP_RAD: Final = 1e-6
"""Rotation that a statue at rest may gather in its whole scene, of a minute or of ten."""
CREEP_M: Final = 1e-6
TREMBLE_RAD: Final = 1e-4
"""Range of rotation within which contacts at rest may tremble: a depth of contact over half the base, at 4 ms."""
ENERGY_SHARE: Final = 2e-3
"""Energy that contacts may seem to add, of what the run exchanges: half a step's work of the weight at 1 ms."""
TABLE_STEPS: Final = 2.0
"""Steps of the table's period by which a first-order engine may misplace the table's work."""
LEAST_ENERGY_J: Final = 1e-9
UPRIGHT_RAD: Final = 1e-5
"""Rotation that loads below the limit of rest may cause: what the depths of the two corners' contacts differ by."""
DEPTH_SHARE: Final = 2e-3
"""Greatest penetration, of the base's width: a contact that is held stays a hundred times below it."""
REST_RAD: Final = 2e-4
"""Rotation below which a rocking that has died out counts as rest: what the engines' contact depths can leave."""


Check = Callable[[Scene, Run], list[Measure]]


def within(check: str, value: float, allowed: float, until_s: float | None = None) -> Measure:
    """What was measured, which holds where it is no more than is allowed."""
    return Measure(check, value <= allowed, value, allowed, until_s=until_s)


def all_hold(measures: Iterable[Measure]) -> bool:
    """Whether every check holds."""
    return all(each.holds for each in measures)


def barrier_j(scene: Scene) -> float:
    """Energy, J, that lifts the centroid over the nearer corner."""
    s = scene.statue
    corner = min(s.corner_left_m, s.corner_right_m)
    return float(s.mass_kg * scene.gravity_m_s2 * (np.hypot(corner, s.centroid_height_m) - s.centroid_height_m))


def exchanged_j(scene: Scene, run: Run) -> float:
    """Energy, J, that the run exchanges: to lift the centroid over the nearer corner, and what it falls from there."""
    s = scene.statue
    # A largest rotation has no side; only of a fall is what lies beyond the balance angle much.
    corner = s.corner_m(-1 if run.outcome is Outcome.OVERTURNED_LEFT else 1)
    beyond = max(run.peak_theta_rad - float(np.arctan2(corner, s.centroid_height_m)), 0.0)
    fallen = float(np.hypot(corner, s.centroid_height_m)) * (1.0 - float(np.cos(beyond)))
    return barrier_j(scene) + s.mass_kg * scene.gravity_m_s2 * fallen


def beyond_plane_j(scene: Scene, run: Run) -> float:
    """Largest kinetic energy, J, of motion out of the rocking plane, which the energy of the planar motion does not hold."""
    if run.history is None or "yaw_rad" not in run.history.extra or run.history.t_s.size < 3:
        return 0.0
    extra, t_s = run.history.extra, run.history.t_s
    roll, yaw, across = (np.gradient(extra[name], t_s) for name in ("roll_rad", "yaw_rad", "statue_y_m"))
    tensor, mass = scene.statue.inertia_tensor_kg_m2, scene.statue.mass_kg
    return float(np.max(0.5 * (tensor[0, 0] * roll**2 + tensor[2, 2] * yaw**2 + mass * across**2)))


def finite(scene: Scene, run: Run) -> list[Measure]:
    """Every number of the run is finite (a history with another cannot be made)."""
    numbers = [run.peak_theta_rad, run.peak_slip_m, run.end_s]
    return [Measure("finite", bool(np.all(np.isfinite(numbers))) and run.history is not None)]


def energy(scene: Scene, run: Run) -> list[Measure]:
    """Contacts add no energy but what comes back from motion out of the plane."""
    gained = number(run.validity, "energy_gained_j", 0.0)
    frequency_hz = float(getattr(scene.base_excitation.x, "frequency_hz", 0.0))
    share = ENERGY_SHARE + TABLE_STEPS * number(run.settings, "dt_s", 0.0) * frequency_hz
    allowed = max(share * exchanged_j(scene, run), LEAST_ENERGY_J) + beyond_plane_j(scene, run)
    return [within("energy_gained_j", gained, allowed)]


def depth(scene: Scene, run: Run) -> list[Measure]:
    """No tunnelling: bodies stay within a share of the base's width of each other's surfaces, where a model has such a depth."""
    if "penetration_m" not in run.validity:
        return []
    width_m = scene.statue.corner_left_m + scene.statue.corner_right_m
    return [within("penetration_m", number(run.validity, "penetration_m"), DEPTH_SHARE * width_m)]


def creep(scene: Scene, run: Run, share: float = 1.0) -> list[Measure]:
    """At rest nothing drifts: the means of the second and the last tenth are the same, though contacts may tremble.

    `share` of the scene's time is what was run: so much of the drift is allowed.
    """
    if run.history is None:
        return [Measure("finite", holds=False)]
    t_s, end = run.history.t_s, run.end_s
    early, late = (t_s >= 0.1 * end) & (t_s < 0.2 * end), t_s >= 0.9 * end
    turned_rad, slid_m = (
        abs(float(np.mean(values[late]) - np.mean(values[early])))
        for values in (run.history.theta_rad, run.history.slip_m)
    )
    return [
        within("creep_rad", turned_rad, share * CREEP_RAD),
        within("creep_m", slid_m, share * CREEP_M),
        within("tremble_rad", float(np.ptp(run.history.theta_rad[t_s >= 0.1 * end])), TREMBLE_RAD),
    ]


def holds_until_s(exact: Run) -> float:
    """Until when the analytic solution is sure and the two-block model inside its domain, s."""
    return min(exact.bounded_until_s, number(exact.validity, "left_domain_s", exact.end_s))


def error_rad(run: Run, exact: Run, until_s: float = math.inf) -> float:
    """Largest difference from the exact rotation, rad, while that holds; infinite without numbers to compare."""
    if run.history is None or exact.history is None or not np.all(np.isfinite(run.history.theta_rad)):
        return math.inf
    return difference_rad(run, exact, min(holds_until_s(exact), until_s))


def allowed_rad(exact: Run) -> float:
    """Error that a scene allows, rad: a share of what there is to see, above what the depths of contacts leave."""
    return max(min(AGREES_RAD, AGREES_SHARE * abs(exact.peak_theta_rad)), UPRIGHT_RAD)


def agrees(scene: Scene, run: Run, exact: Run) -> list[Measure]:
    """The rotation is the exact one, and on a pedestal its slip too, while the two-block model holds."""
    until_s = holds_until_s(exact)
    told_s = until_s if until_s < 0.99 * exact.end_s else None
    found = [within("error_rad", error_rad(run, exact), allowed_rad(exact), told_s)]
    if scene.pedestal is not None and run.history is not None and exact.history is not None:
        t_s = run.history.t_s[run.history.t_s <= until_s]
        slip = np.interp(t_s, exact.history.t_s, exact.history.slip_m)
        slid_m = float(np.max(np.abs(run.history.slip_m[: t_s.size] - slip)))
        found.append(within("slip_error_m", slid_m, AGREES_SHARE * exact.peak_slip_m + CREEP_M, told_s))
    return found


def upright(scene: Scene, run: Run) -> list[Measure]:
    """Below every limit of rest the statue does not rock."""
    return [within("largest_rotation_rad", abs(run.peak_theta_rad), UPRIGHT_RAD)]


def ends_at_rest(scene: Scene, run: Run) -> list[Measure]:
    """The rocking has died out."""
    last = abs(float(run.history.theta_rad[-1])) if run.history is not None else math.inf
    return [within("last_rotation_rad", last, REST_RAD)]


BASIC: Final[tuple[Check, ...]] = (finite, energy, depth)


# The catalogue: every hard scene that a file can describe.

ALL: Final = ("analytic", "pymunk", "pybullet")
CONTACT: Final = ("pymunk", "pybullet")
ALPHA_RAD: Final = math.atan(0.2)
"""Slenderness of the column."""


@dataclass(frozen=True)
class Hard:
    """One hard scene: content as in a scene file, the outcome that it must have by every engine named, what is checked.

    `dt_s` is the contact engines' step; `skips` off makes them integrate what they could leave out; `exact` compares every run
    with the analytic solution. Where a check fails, `converged_s` seconds with far more iterations a step (`converged`) tell
    whether it is a known failure of a solver that ends its steps early.
    """

    name: str
    content: Mapping[str, object]
    wanted: str
    engines: Sequence[str] = ALL
    checks: Sequence[Check] = BASIC
    dt_s: float = 1e-3
    skips: bool = True
    note: str = ""
    exact: bool = True
    converged_s: float | None = None


def body(width_m: float, height_m: float) -> dict[str, float]:
    """A homogeneous block of marble."""
    mass = 2700.0 * width_m * height_m * 0.5 * height_m
    return {
        "mass_kg": mass, "centroid_height_m": 0.5 * height_m, "corner_left_m": 0.5 * width_m,
        "corner_right_m": 0.5 * width_m, "inertia_kg_m2": mass * (width_m**2 + height_m**2) / 12.0,
        "height_m": height_m, "depth_m": 0.5 * height_m,
    }  # fmt: skip


def leaning(statue: Mapping[str, float], share: float, duration_s: float, **more: Any) -> dict[str, object]:
    """Released from a share of its slenderness."""
    alpha = math.atan(statue["corner_right_m"] / statue["centroid_height_m"])
    return {"duration_s": duration_s, "statue": statue, "initial": {"theta_rad": share * alpha}, **more}


SHAKEN: Final = {"statue": COLUMN, "contact": {"statue": 10.0}, "motion": harmonic(5.0, 100.0)}
"""5 g at 100 Hz on a statue that cannot slide off, which it would at once with less friction."""


def catalogue() -> list[Hard]:
    """All hard scenes that a file can describe."""
    still = {"duration_s": 600.0, "output": {"dt_s": 0.1}}
    on_pedestal = {"duration_s": 60.0, "statue": PAESTUM, "pedestal": PEDESTAL, "output": {"dt_s": 0.05}}
    far = {
        "duration_s": 48.0, "table": "moving", "statue": COLUMN, "output": {"dt_s": 0.01},
        "motion": {"x": {"kind": "pulse", "shape": "rectangular", "amplitude_g": 0.1, "duration_s": 100.0}},
    }  # fmt: skip
    creeping = (*BASIC, creep)
    # A column's limit of rest is 0.2 g.
    tangent = {"duration_s": 2.0, "statue": COLUMN, "motion": harmonic(0.2 * (1.0 + 1e-6), 2.0)}
    below = {"duration_s": 2.0, "statue": COLUMN, "motion": harmonic(0.2 * (1.0 - 1e-3), 2.0)}
    halfway = {f"{slender:g}": leaning(body(1.0 / slender, 1.0), 0.5, 3.0) for slender in (1.0, 10.0, 50.0)}
    # Times go with the root of the height.
    scaled = {
        height: leaning(body(0.2 * height, height), 0.5, 3.0 * math.sqrt(height), output={"dt_s": 1e-3 * math.sqrt(height)})
        for height in (0.01, 100.0)
    }  # fmt: skip
    pushed = {"duration_s": 1.0, "statue": PAESTUM, "motion": harmonic(0.429, 3.0)}
    light, heavy = ({**PEDESTAL, "mass_kg": PAESTUM["mass_kg"] * ratio} for ratio in (1e-3, 1e3))
    equal = {**pushed, "contact": EQUAL}
    # The g of a motion's amplitude: with it as weight, −1 g leaves none.
    drop = {
        "duration_s": 2.0, "gravity_m_s2": STANDARD_GRAVITY_M_S2, "statue": COLUMN,
        "motion": {
            "z": {"kind": "pulse", "shape": "rectangular", "amplitude_g": -1.0, "duration_s": 0.1, "start_s": 0.2}
        },
    }  # fmt: skip
    unmoved = (*BASIC, upright)
    return [
        Hard(
            "600 s at rest", {**still, "statue": COLUMN}, "stands", checks=creeping, dt_s=2e-3, skips=False, exact=False
        ),
        Hard("60 s at rest on a pedestal", on_pedestal, "stands", checks=creeping, skips=False, exact=False),
        Hard(
            "1.1 km from the origin", far, "stands", CONTACT, creeping, skips=False,
            note="a table that moves away at 0.1 g for 48 s, below every limit of rest",
        ),
        Hard("released 1e-6 rad below balance", leaning(COLUMN, 1.0 - 1e-6 / ALPHA_RAD, 12.0), "stands"),
        Hard("released 1e-3 rad below balance", leaning(COLUMN, 1.0 - 1e-3 / ALPHA_RAD, 8.0), "stands"),
        Hard("released 1e-3 rad beyond balance", leaning(COLUMN, 1.0 + 1e-3 / ALPHA_RAD, 8.0), "overturned_right"),
        Hard("uplift touched by one part in a million", tangent, "stands"),
        Hard("uplift missed by one part in a thousand", below, "stands", checks=unmoved),
        Hard("impacts without number (Zeno)", leaning(COLUMN, 0.5, 20.0), "stands", checks=(*BASIC, ends_at_rest), skips=False),
        *(Hard(f"height to width {slender}", content, "stands", dt_s=5e-4) for slender, content in halfway.items()),
        *(Hard(f"{m:g} m high", content, "stands", dt_s=2.5e-4 * math.sqrt(m)) for m, content in scaled.items()),
        Hard(
            "pedestal 0.001 times the statue's mass", {**equal, "pedestal": light}, "stands", dt_s=2.5e-4, converged_s=1.0
        ),
        Hard("pedestal 1000 times the statue's mass", {**equal, "pedestal": heavy}, "stands"),
        *(
            Hard(
                f"floor friction {friction:g}",
                {**pushed, "pedestal": PEDESTAL, "contact": {"floor_static": friction, "floor_kinetic": friction}},
                "stands",
            )
            for friction in (0.0, 5.0)
        ),
        Hard("5 g at 100 Hz", {"duration_s": 0.5, **SHAKEN}, "stands", dt_s=1e-4),
        Hard("floor falls at 1 g: the two-block model", drop, "lift_off", ("analytic",), exact=False),
        Hard("floor falls at 1 g: the engines", drop, "stands", CONTACT, unmoved, exact=False),
    ]  # fmt: skip


# What each engine says of each hard scene, and what the checks found.

ITERATIONS: Final = 3000
"""Solver iterations a step: ten times those of the finest levels, which leaves a bench scene's error to the step alone."""
IMPACT_ITERATIONS: Final = 9000
RESIDUAL: Final = 1e-16
"""Squared change of velocity, (m/s)², at which a solver that watches it may end before."""
MANY: Final = {
    "iterations": ITERATIONS, "impact_iterations": IMPACT_ITERATIONS,
    "event_iterations": IMPACT_ITERATIONS, "residual": RESIDUAL,
}  # fmt: skip
"""By the name of a field of settings; an engine has some of them."""


def converged(settings: Settings) -> Settings:
    """The same settings with as many iterations as converge. Raises `ValueError` where the engine counts none."""
    known = settings.as_dict()
    if "iterations" not in known:
        raise ValueError(f"{type(settings).__name__} has no iterations")
    return replace(settings, **{name: value for name, value in MANY.items() if name in known})


QUICK: Final = ("released 1e-3 rad below balance", "height to width 50", "floor friction 5")


def simulate(engine: Engine, scene: Scene, dt_s: float, skips: bool) -> Run:
    """One run with a fixed step (a certifying model chooses its own). Raises `EngineFailure`."""
    options = RunOptions(skips=frozenset(SKIPS) if skips else frozenset())
    if engine.capabilities.certifies:
        return run_to_accuracy(engine, scene, 1e-3, options)
    return engine.simulate(scene, engine.settings_for_dt(scene, dt_s), options)


def scene_tasks(quick: bool) -> list[str]:
    """The hard scenes by name, the longest first."""
    return [hard.name for hard in catalogue() if not quick or hard.name in QUICK]


def scene_rows(task: str) -> list[HardRow]:
    """The row of one hard scene."""
    return [row_of(next(hard for hard in catalogue() if hard.name == task))]


def lost_scene(task: str) -> list[HardRow]:
    """The row of a hard scene that took its process with it."""
    return [HardRow(task, "", {"*": "crashed"}, holds=False)]


def row_of(hard: Hard) -> HardRow:
    """A hard scene by every engine that it names and that is here."""
    scene = scene_of(hard.name, hard.content)
    exact = solution(scene) if hard.exact else None
    got: dict[str, str] = {}
    measured: dict[str, list[Measure]] = {}
    known: dict[str, KnownFailure] = {}
    for name in hard.engines:
        engine = engines.load(name)
        if engine.missing() is not None:
            continue
        try:
            run = simulate(engine, scene, hard.dt_s, hard.skips)
        except EngineFailure as failure:
            got[name] = str(failure)
            continue
        got[name], measured[name] = run.outcome.value, judged(hard, scene, run, exact)
        if hard.converged_s is not None and not all_hold(measured[name]):
            avoided = _known_failure(engine, scene, hard, exact, hard.converged_s)
            known |= {} if avoided is None else {name: avoided}
    row = HardRow(hard.name, hard.wanted, got, True, measured, hard.note, known)
    return replace(row, holds=bool(got) and all(row.right(name) for name in got))


def solution(scene: Scene) -> Run:
    """The analytic solution on its finest level, with nothing left out."""
    return by_model(scene, options=RunOptions(skips=frozenset()))


def judged(hard: Hard, scene: Scene, run: Run, exact: Run | None, share: float = 1.0) -> list[Measure]:
    """What the checks of a hard scene measure in a run of `share` of its time."""
    found = [creep(scene, run, share) if check is creep else check(scene, run) for check in hard.checks]
    found += [] if exact is None else [agrees(scene, run, exact)]
    return [each for of_check in found for each in of_check]


def _known_failure(
    engine: Engine, scene: Scene, hard: Hard, exact: Run | None, converged_s: float
) -> KnownFailure | None:
    """What avoids a failure: the same step with far more iterations, where every check then holds."""
    shorter = replace(scene, duration_s=converged_s)
    settings = converged(engine.settings_for_dt(shorter, hard.dt_s))
    run = engine.simulate(shorter, settings, RunOptions(skips=frozenset()))
    measured = judged(hard, shorter, run, exact, shorter.duration_s / scene.duration_s)
    if run.outcome.value != hard.wanted or not all_hold(measured):
        return None
    return KnownFailure(hard.dt_s, round(number(settings.as_dict(), "iterations")), shorter.duration_s, measured)


# The stability map: every engine, setting by difficulty, each cell's category computed with its evidence.

STEPS_S: Final = (1.0 / 60.0, 1.0 / 240.0, 1e-3, 2.5e-4, 1e-4, 1e-5)
NONE: Final = RunOptions(skips=frozenset())
CONVERGED_S: Final = 2.5e-4
"""Step of the run with far more iterations, where no step is stable."""


@dataclass(frozen=True)
class Difficulty:
    """One row of a map; `share` of the scene's time is run with the finest step: what grows with small steps shows at once."""

    name: str
    content: Mapping[str, object]
    share: float = 0.3
    at_rest: bool = False


def difficulties() -> tuple[Difficulty, ...]:
    """The rows from easy to hard."""
    pushed = {"duration_s": 1.0, "statue": PAESTUM, "motion": harmonic(0.429, 3.0)}
    stand = {"pedestal": PEDESTAL, "contact": EQUAL}
    light = {"pedestal": {**PEDESTAL, "mass_kg": 0.707}, "contact": EQUAL}
    return (
        Difficulty("at rest", {"duration_s": 2.0, "statue": COLUMN}, at_rest=True),
        Difficulty("free rocking", leaning(COLUMN, 0.5, 1.0)),
        Difficulty("slenderness 50", leaning(body(0.02, 1.0), 0.5, 1.0)),
        Difficulty("harmonic, 0.429 g, 3 Hz", pushed),
        Difficulty("harmonic, on a pedestal", {**pushed, **stand}, share=0.1),
        Difficulty("pedestal of a thousandth of the mass", {**pushed, **light}, share=0.1),
        Difficulty("5 g at 100 Hz", {"duration_s": 0.5, **SHAKEN}),
    )


ENGINES: Final = ("pybullet", "pymunk", "analytic")


def map_tasks(quick: bool) -> list[str]:
    """A row of each engine's map: the difficulty by each engine, the longest first."""
    rows = difficulties()[1:2] if quick else difficulties()
    return [f"{engine}: {row.name}" for engine in ENGINES for row in sorted(rows, key=lambda row: row.share)]


def map_cells(quick: bool, task: str) -> list[StabilityCell]:
    """The cells of one row of one map; none where the engine is not here."""
    name, _, words = task.partition(": ")
    engine = engines.load(name)
    if engine.missing() is not None:
        return []
    row = next(item for item in difficulties() if item.name == words)
    scene = scene_of(row.name, row.content)
    exact = solution(scene)
    cells = list(_cells_of(row, scene, engine, exact, quick))
    return list(explained(cells, partial(_converged, row, scene, engine, exact)))


def lost_map(task: str) -> list[StabilityCell]:
    """A row whose process died: one cell, diverged and not explained."""
    name, _, words = task.partition(": ")
    return [StabilityCell(name, "any", words, "diverged", message="crashed")]


def _cells_of(row: Difficulty, scene: Scene, engine: Engine, exact: Run, quick: bool) -> Iterator[StabilityCell]:
    if engine.capabilities.certifies:
        for settings in engine.refinement_levels(scene):
            cell = StabilityCell(engine.name, f"{settings.expected_error_rad:g} rad", row.name, "")
            yield judge(cell, scene, engine.simulate(scene, settings, RunOptions()), exact, row)
        return
    for step_s in STEPS_S[1:3] if quick else STEPS_S:
        short = step_s == STEPS_S[-1]
        shorter = replace(scene, duration_s=row.share * scene.duration_s) if short else scene
        cell = StabilityCell(engine.name, _step(step_s), row.name, "", short=short)
        yield _of_step(cell, shorter, engine, engine.settings_for_dt(shorter, step_s), exact, row)


def _converged(row: Difficulty, scene: Scene, engine: Engine, exact: Run) -> StabilityCell | None:
    """The whole scene with far more iterations a step; None for a model that has none."""
    if engine.capabilities.certifies:
        return None
    settings = converged(engine.settings_for_dt(scene, CONVERGED_S))
    cell = StabilityCell(engine.name, f"{_step(CONVERGED_S)}, {settings.as_dict()['iterations']} it.", row.name, "")
    return _of_step(cell, scene, engine, settings, exact, row)


def _of_step(
    cell: StabilityCell, scene: Scene, engine: Engine, settings: Settings, exact: Run, row: Difficulty
) -> StabilityCell:
    """The cell of a run with nothing left out; diverged where the engine gives up."""
    try:
        return judge(cell, scene, engine.simulate(scene, settings, NONE), exact, row)
    except EngineFailure as failure:
        return replace(cell, category="diverged", message=str(failure))


def judge(cell: StabilityCell, scene: Scene, run: Run, exact: Run, row: Difficulty) -> StabilityCell:
    """The cell with category, evidence and message of one run against the exact solution."""
    if run.outcome.failed or run.history is None or exact.history is None:
        return replace(cell, category="diverged", message=run.message or run.outcome.value)
    right = agrees(scene, run, exact)
    if not math.isfinite(error_rad(run, exact)):
        return replace(cell, category="diverged", evidence=[Measure("finite", holds=False)])
    drifts = [*energy(scene, run), *depth(scene, run), *(creep(scene, run) if row.at_rest else [])]
    category = "inaccurate" if not all_hold(right) else "stable" if all_hold(drifts) else "drifting"
    return replace(cell, category=category, evidence=[*right, *drifts])


def _step(step_s: float) -> str:
    return f"1/{round(1.0 / step_s)} s" if step_s > 2e-3 else f"{1e3 * step_s:g} ms"


# Why a cell is not stable: the setting of the same row that is, or nothing.


def explained(
    row: Sequence[StabilityCell], converged: Callable[[], StabilityCell | None] = lambda: None
) -> Iterator[StabilityCell]:
    """The cells of one row, from coarse to fine; those that are not stable with the setting that is, where one is known.

    A cell is explained by a whole run with a finer step that is stable. Where there is none, `converged` computes the row with
    far more iterations a step: that cell follows the others, and explains those before it when it is stable.
    """
    finer = [next((each for each in row[k + 1 :] if _explains(each)), None) for k in range(len(row))]
    left = [cell for cell, by in zip(row, finer, strict=True) if cell.category != "stable" and by is None]
    last = converged() if left else None
    for cell, by in zip(row, finer, strict=True):
        if cell.category != "stable" and by is not None:
            yield cell.avoided("step", by)
        elif cell.category != "stable" and last is not None and _explains(last):
            yield cell.avoided("iterations", last)
        else:
            yield cell
    if last is not None:
        yield last


def _explains(cell: StabilityCell) -> bool:
    return cell.category == "stable" and not cell.short


# The record of the whole run.


def assembled(rows: Mapping[str, Sequence[Any]], head: Mapping[str, Any]) -> StressRecord:
    """The record from the rows of all parts; engines of the catalogue that are not here are named with the reason."""
    order = {row.name: place for place, row in enumerate(difficulties())}
    missing = {name: engines.load(name).missing() for name in ALL}
    made = StressRecord(
        absent={name: why for name, why in missing.items() if why is not None},
        scenes=rows["scenes"],
        cells=sorted(rows["maps"], key=lambda cell: (ENGINES.index(cell.engine), order[cell.difficulty])),
        **head,
    )
    return replace(made, answer=answer_of(made), findings=findings_of(made))


def all_parts(quick: bool) -> list[Part]:
    """The parts, the one with the longest tasks first: all are computed side by side."""
    return [
        Part("maps", map_tasks(quick), partial(map_cells, quick), lost_map, StabilityCell),
        Part("scenes", scene_tasks(quick), scene_rows, lost_scene, HardRow),
    ]


STRESS: Final = Measurement("stress", all_parts, assembled)
