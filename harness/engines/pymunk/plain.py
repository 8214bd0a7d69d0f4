"""Unmodified pymunk: bodies, shapes, masses, coefficients, gravity, step and iterations; after the start no body is written to.

What `pymunk` adds to this, events located inside a step, rests on rigid-body formulas of this project; this engine has none of
them, so that where the two agree the contact engine itself has confirmed the answer. Two coefficients of friction are the one
thing that Chipmunk does not know: the floor's follows the pedestal's own velocity (`harness.engines.stepping.coulomb.followed`).
"""

import time
from dataclasses import replace
from typing import ClassVar, Final, final

from harness.engines.base import VERIFICATION_STEP_SHARE, Engine, EngineFailure, Settings, near, own_settings
from harness.engines.pymunk import SLOP_RAD_S, Munk2D, refuse_out_of_plane, resolution_rad
from harness.engines.pymunk.settings import MunkSettings
from harness.engines.stepping.columns import trajectory
from harness.engines.stepping.coulomb import stuck_below_m_s
from harness.engines.stepping.frame import Schedule, step_count
from harness.engines.stepping.loop import WallWatch, Watch, plain_steps, refuse_steering
from harness.engines.stepping.reduce import Report, reduce_trajectory
from harness.engines.stepping.step_log import StepLog
from harness.model import Capabilities, Run, RunOptions, Scene

LEVELS: Final = (
    (2e-3, 200, 1e-2),
    (1e-3, 200, 5e-3),
    (5e-4, 200, 2.5e-3),
    (2.5e-4, 200, 1e-3),
    (1e-4, 200, 5e-4),
    (5e-5, 200, 2.5e-4),
    (2.5e-5, 200, 1e-4),
)
"""(step in s, iterations, error in rad). With 40 iterations a stuck pedestal slides (0.1 rad off); with 200 two of the paper's
cases err at 0.25 ms (8.960e-4 and 2.6428e-3 rad) as with 1000 (8.953e-4, 2.6414e-3), at a quarter of the cost. The error is
assumed: first order, some ten times what the paper's cases with one coefficient show; not measured over random scenes."""


DEPTH_RAD_S: Final = 0.002
"""Depth at which the statue is placed at first over the base's width and the step, so that contacts exist from then on."""


@final
class PlainMunk2D(Engine):
    """Chipmunk's own steps, nothing else."""

    name: ClassVar[str] = "pymunk:plain"
    capabilities: ClassVar[Capabilities] = replace(
        Munk2D.capabilities, moving_table=False, skips=frozenset({"no_history", "stop_at_overturn"})
    )
    order: ClassVar[float] = 1.0

    missing = Munk2D.missing

    def refinement_levels(self, scene: Scene) -> tuple[MunkSettings, ...]:
        """Steps of 2 ms to 0.025 ms."""
        return tuple(_settings(scene, *level) for level in LEVELS)

    def settings_for_dt(self, scene: Scene, dt_s: float) -> MunkSettings:
        """The nearest level's iterations with the given step."""
        return _settings(scene, *near(LEVELS, dt_s))

    def verification_settings(self, scene: Scene, settings: Settings) -> tuple[MunkSettings, ...]:
        """Less than half the step, with the bodies added in the other order."""
        own = own_settings(self.name, MunkSettings, settings)
        finer = self.settings_for_dt(scene, VERIFICATION_STEP_SHARE * own.dt_s)
        return (
            replace(
                finer,
                iterations=max(finer.iterations, own.iterations),
                pedestal_first=not own.pedestal_first,
                expected_error_rad=VERIFICATION_STEP_SHARE * own.expected_error_rad,
            ),
        )

    def step_cost(self, scene: Scene) -> float:
        """On the paper's statue 0.9 on the floor and 1.1 on its pedestal."""
        return 1.25

    def simulate(self, scene: Scene, settings: Settings, options: RunOptions) -> Run:
        """Compute the scene. Raises `EngineFailure` where Chipmunk refuses it, or where it would have to be steered."""
        own = own_settings(self.name, MunkSettings, settings)
        refuse_steering(scene, self.name)
        refuse_out_of_plane(scene, self.name)
        # A push across the plane has no part in what friction must hold.
        scene = replace(scene, base_excitation=scene.base_excitation.in_plane())
        begin = time.perf_counter()
        try:
            record = _integrate(scene, own, options)
        except (AssertionError, ValueError, MemoryError) as error:
            raise EngineFailure(f"pymunk refused the scene: {error}") from error
        report = Report(
            engine=self.name,
            settings=own.as_dict(),
            steps=len(record.t_s) - 1,
            wall_s=0.0,
            resolution_rad=resolution_rad(scene, own),
            stuck_below_m_s=stuck_below_m_s(scene, own.dt_s),
            with_history=options.history or not options.allows("no_history"),
            repeats=False,
        )
        path = trajectory(scene, record, None, own.dt_s)
        return replace(reduce_trajectory(scene, path, report), wall_s=time.perf_counter() - begin)


def _settings(scene: Scene, dt_s: float, most_iterations: float, error_rad: float) -> MunkSettings:
    iterations = round(most_iterations)
    base = scene.statue.corner_left_m + scene.statue.corner_right_m
    depth = DEPTH_RAD_S * base * dt_s
    return MunkSettings(dt_s, error_rad, iterations, depth, SLOP_RAD_S * base * dt_s, impact_iterations=iterations)


def _integrate(scene: Scene, settings: MunkSettings, options: RunOptions) -> StepLog:
    """Samples of a run."""
    from harness.engines.pymunk import world
    from harness.engines.pymunk.backend import ChipmunkBackend

    schedule = Schedule(scene, settings.dt_s, 0, step_count(scene.duration_s, settings.dt_s))
    watch = Watch(
        stop=options.stop, ends_fallen=options.allows("stop_at_overturn"), wall=WallWatch.of(scene, None, settings.dt_s)
    )
    # Without a support the backend holds nothing: it is Chipmunk's own step, read.
    return plain_steps(ChipmunkBackend(world.build(scene, settings), settings), schedule, watch)
