"""Numbers of the contact engines for `rockcheck bench`: kinds of scene, the model's answer, cost of the harness."""

import time
from dataclasses import replace
from typing import Final

from harness import Run, RunOptions, Scene, engines
from harness.engines.base import Settings
from harness.engines.pymunk.settings import MunkSettings
from harness.engines.pymunk.world import build
from harness.engines.stepping.trajectory import Schedule, step_count
from harness.questions.bench.standard_scenes import PAESTUM, PEDESTAL, harmonic, scene_of

BEST_OF: Final = 5
KINDS: Final = (
    ("no pedestal", False, 0.15, None),
    ("pedestal", True, 0.15, None),
    ("two frictions", True, 0.20, None),
    ("imposed 0.85", True, 0.20, 0.85),
    ("imposed 0.90", True, 0.20, 0.90),
)
"""Kinds of scene: pedestal, static friction, imposed ratio."""
PAPER: Final = ((0.429, 3.0), (0.334, 3.0), (0.429, 2.0), (0.334, 2.0))
"""Amplitude in g and frequency in Hz of the paper's cases that contact settings are measured on."""


def paper_scene(
    amplitude_g: float,
    frequency_hz: float,
    *,
    pedestal: bool = True,
    static: float = 0.15,
    ratio: float | None = None,
    duration_s: float = 1.0,
) -> Scene:
    """The surveyed statue as a block under a sine, μ_k = 0.15; an impact ratio where one is imposed."""
    contact = {"floor_static": static, "floor_kinetic": 0.15, "statue": 1.0}
    content = {"duration_s": duration_s, "statue": PAESTUM, "motion": harmonic(amplitude_g, frequency_hz)}
    content |= {"contact": contact if ratio is None else {**contact, "restitution": ratio}}
    title = f"{amplitude_g:g} g, {frequency_hz:g} Hz"
    return scene_of(title, content | {"pedestal": PEDESTAL} if pedestal else content)


def analytic_run(scene: Scene) -> Run:
    """The analytic model's run that contact engines are compared with."""
    model = engines.load("analytic")
    return model.simulate(scene, model.refinement_levels(scene)[1], RunOptions())


def overhead(duration_s: float = 10.0, dt_s: float = 2.5e-4) -> dict[str, float]:
    """Cost of a whole pymunk run (split steps, record, reduction) over a baseline loop with the same settings and read-outs."""
    engine = engines.load("pymunk")
    ratios: dict[str, float] = {}
    for kind, pedestal in (("no_pedestal", False), ("pedestal", True)):
        # Small enough that the statue does not fall: both loops then make the same steps.
        scene = paper_scene(0.2, 5.0, pedestal=pedestal, static=0.15, duration_s=duration_s)
        settings: Settings = engine.settings_for_dt(scene, dt_s)
        if not isinstance(settings, MunkSettings):
            raise TypeError("pymunk's settings are wanted")
        own, baseline = [], []
        for _ in range(BEST_OF):
            own.append(engine.simulate(scene, settings, RunOptions(skips=frozenset())).wall_s)
            baseline.append(baseline_loop(scene, replace(settings))[0])
        ratios[f"{kind}_bare_s"], ratios[f"{kind}_run_s"] = min(baseline), min(own)
        ratios[f"{kind}_ratio"] = min(own) / min(baseline)
    return ratios


def baseline_loop(scene: Scene, settings: MunkSettings) -> tuple[float, list[tuple[float, ...]]]:
    """Seconds and read-outs of a plain loop: pymunk's own step and properties, same bodies, settings and motion. Places go on by
    one more move to a step's end.

    No friction that switches, no split steps, no reduction. The motion's accelerations are computed within the time.
    """
    world = build(scene, settings)
    space, bodies = world.space, [body for body in (world.statue, world.pedestal) if body is not None]
    dt = settings.dt_s
    rows: list[tuple[float, ...]] = []
    for body in bodies:
        # Chipmunk moves places before it finds contacts.
        body.position -= dt * body.velocity
        body.angle -= dt * body.angular_velocity
    begin = time.perf_counter()
    for x, _, z in Schedule(scene, dt, 0, step_count(scene.duration_s, dt)).coarse:
        space.gravity = (x, z)
        space.step(dt)
        row: list[float] = []
        for body in bodies:
            place, velocity = body.position, body.velocity
            row += (place.x, place.y, body.angle, velocity.x, velocity.y, body.angular_velocity)
        rows.append(tuple(row))
    return time.perf_counter() - begin, rows
