"""The analytic two-block model (docs/model.md) behind the engine contract."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar, Final, cast, final

from analytic.excitation import ZeroExcitation
from harness.engines.base import RELIABLE_RAD, Engine, EngineFailure, Settings, own_settings
from harness.model import (
    SAME_END,
    BaseExcitation,
    Capabilities,
    Finding,
    History,
    Outcome,
    Pattern,
    PatternName,
    Run,
    RunOptions,
    Scene,
    Severity,
    block_of,
    caution,
    changes_answer,
    info,
    keywords,
)

if TYPE_CHECKING:
    from analytic import Certified, CommonKeywords, Solution

ACCURACIES_RAD: Final = (1e-6, 1e-9, 1e-12)
"""The refinement levels: aimed error of the rotation before it is amplified by the problem itself."""
VERIFICATION_STEP_S: Final = 0.02
"""Longest step of the verification run that checks the step's length."""


@dataclass(frozen=True)
class TwoBlockSettings(Settings):
    """Aimed error of the rotation and the longest step (infinite: as the Taylor series allow)."""

    accuracy_rad: float = 1e-12
    step_cap_s: float = float("inf")


@final
class TwoBlock(Engine):
    """Event-driven Taylor integration of the two-block model; rolls over the base profile of a scanned statue."""

    name: ClassVar[str] = "analytic"
    capabilities: ClassVar[Capabilities] = Capabilities(
        dimensions=2,
        certifies=True,
        uses_mesh=True,
        skips=frozenset({"quiet_start", "quiet_end", "no_history"}),
    )
    order: ClassVar[float] = 8.0

    def refinement_levels(self, scene: Scene) -> tuple[Settings, ...]:
        """Three aimed errors; the step's length follows from them."""
        return tuple(TwoBlockSettings(0.0, accuracy, accuracy) for accuracy in ACCURACIES_RAD)

    def settings_for_dt(self, scene: Scene, dt_s: float) -> Settings:
        """The finest aimed error with steps no longer than dt_s."""
        return TwoBlockSettings(dt_s, ACCURACIES_RAD[-1], ACCURACIES_RAD[-1], dt_s)

    def verification_settings(self, scene: Scene, settings: Settings) -> tuple[Settings, ...]:
        """A hundredth of the aimed error, and short steps."""
        accuracy = own_settings(self.name, TwoBlockSettings, settings).accuracy_rad
        return (
            TwoBlockSettings(0.0, accuracy, 0.01 * accuracy),
            TwoBlockSettings(VERIFICATION_STEP_S, accuracy, accuracy, VERIFICATION_STEP_S),
        )

    def simulate(self, scene: Scene, settings: Settings, options: RunOptions) -> Run:
        """Compute the scene and certify the numbers; raises EngineFailure when the model refuses the scene."""
        from analytic import AnalyticInputError, certify, simulate
        from analytic.solver import run as compiled

        chosen = own_settings(self.name, TwoBlockSettings, settings)
        keep = options.history or not options.allows("no_history")
        given: CommonKeywords = {
            **keywords(scene),
            "dt_s": scene.output_dt_s if keep else None,
            "skip_start": options.allows("quiet_start"),
            "skip_rest": options.allows("quiet_end"),
        }
        compiled.loaded()  # compiling is no part of the time of a run
        start = time.perf_counter()
        motion = block_of(scene), scene.base_excitation.x, scene.base_excitation.z
        try:
            # Certifying takes further runs: none where nobody asks what the numbers are worth. Nor are forces looked at then for
            # an outcome alone, which takes a third of its time.
            if not options.stated:
                bare: CommonKeywords = {**given, "events": keep, "validity": keep}
                single = simulate(*motion, accuracy_rad=chosen.accuracy_rad, step_cap_s=chosen.step_cap_s, **bare)
                return _run(scene, chosen, single, time.perf_counter() - start, keep)
            certified = certify(
                *motion,
                accuracy_rad=RELIABLE_RAD,
                base_accuracy_rad=chosen.accuracy_rad,
                step_cap_s=chosen.step_cap_s,
                **given,
            )
        except AnalyticInputError as error:
            raise EngineFailure(str(error)) from error
        run = _run(scene, chosen, certified.solution, time.perf_counter() - start, keep)
        return replace(
            run,
            numerical_uncertainty_rad=certified.uncertainty_rad,
            slip_uncertainty_m=certified.slip_uncertainty_m,
            reliable_until_s=certified.reliable_until_s,
            findings=(*findings_of(certified), *run.findings),
        )


def by_other_impact(scene: Scene) -> tuple[Run, float | None]:
    """The model's run with another coefficient at impacts (static, or kinetic where the scene takes that), no error stated, and
    when it leaves the run with the scene's own.

    Raises `EngineFailure` where the model refuses the scene.
    """
    from analytic import AnalyticInputError, simulate

    own: CommonKeywords = {**keywords(scene), "dt_s": scene.output_dt_s}
    static = scene.contact.at_impact == scene.contact.floor_static
    others: CommonKeywords = {**own, "floor_impact": "kinetic" if static else "static"}
    motion = block_of(scene), scene.base_excitation.x, scene.base_excitation.z
    try:
        usual, other = simulate(*motion, **own), simulate(*motion, **others)
    except AnalyticInputError as error:
        raise EngineFailure(str(error)) from error
    # Both compute the same numbers up to there.
    parts = (min(a.time_s, b.time_s) for a, b in zip(usual.events, other.events, strict=False) if a != b)
    return _run(scene, TwoBlockSettings(0.0, ACCURACIES_RAD[-1]), other, 0.0, keep=True), next(parts, None)


def _validity(scene: Scene, solution: Solution) -> dict[str, object]:
    limits = solution.validity
    share = solution.peak_theta_rad / scene.statue.slenderness_rad(1 if solution.peak_signed_rad > 0.0 else -1)
    values: dict[str, object] = {
        "peak_over_slenderness": share,
        "impact_ratios": solution.impact_ratios.tolist(),
        "several_joint_states_s": solution.ambiguous_times_s.tolist(),
        "energy_gained_j": solution.energy_gained_j,
        "energy_lost_j": solution.energy_lost_j,
    }
    # Of a wall that is yet to be touched at the run's end the time is not known.
    if solution.outcome.value == "touches_wall" and solution.peak_time_s is not None:
        values["wall_touch_time_s"] = solution.end_s
    if limits is None:
        return values
    values |= {
        "statue_friction_needed": limits.pivot_friction_needed,
        "statue_friction_needed_at_impact": limits.pivot_friction_needed_at_impact,
        "statue_normal_least_n": limits.least_pivot_force_n,
        "floor_normal_least_n": limits.least_floor_force_n,
        "left_domain_s": limits.left_domain_s,
        "left_domain_by": limits.left_domain_by,
    }
    if scene.pedestal is not None:
        values["pedestal_tipping_margin_m"] = limits.pedestal_tipping_margin_m
        values["pedestal_tipping_margin_at_impact_m"] = limits.pedestal_tipping_margin_at_impact_m
    return values


def skipped(solution: Solution, keep: bool) -> dict[str, float | None]:
    """What a run left out, by skip (`Run.skipped`); `keep`: its history was asked."""
    rest_s = solution.results.skipped_s
    known = [
        ("quiet_rest", rest_s > 0.0, rest_s),
        ("no_history", not keep, None),
        ("stop_at_overturn", solution.overturn_time_s is not None, None),
    ]
    return {name: seconds for name, holds, seconds in known if holds}


def left_out(motion: BaseExcitation) -> tuple[Finding, ...]:
    """What of a motion the model cannot be given."""
    return () if isinstance(motion.y, ZeroExcitation) else (changes_answer("motion_across_left_out"),)


NEAR_TIE: Final = 1e-3
"""An energy that decides the outcome is a near tie within this share of the barrier's."""


def findings_of(certified: Certified) -> tuple[Finding, ...]:
    """What is to be known of a run and its own numerical error."""
    run, until_s = certified.solution, certified.reliable_until_s
    counts, limits, end_s = run.counts, run.validity, run.end_s
    outcomes, margin, gained_j = (
        [each.value for each in certified.outcomes],
        run.results.outcome_margin,
        run.energy_gained_j,
    )
    never = until_s < end_s and run.t_s.size == 0 and until_s <= 0.0
    unbounded = _from(run, until_s, caution("error_not_bounded", until_s=until_s, end_s=end_s))
    said = [
        (not certified.outcome_is_sure, changes_answer("outcome_changes_with_steps", outcomes=outcomes)),
        (never, caution("peak_not_bounded", uncertainty_rad=certified.uncertainty_rad)),
        (not never and until_s < end_s * (1.0 - SAME_END), unbounded),
        (counts.given_up, changes_answer("run_given_up", at_s=end_s, steps=counts.steps)),
        (counts.tangents, caution("near_tangent_events", steps=counts.tangents)),
        (counts.ties, caution("several_joint_states", count=counts.ties)),
        (counts.dropped_rebounds, info("impacts_died_out", count=counts.dropped_rebounds)),
        (margin < NEAR_TIE, changes_answer("near_tie", margin=margin)),
        (gained_j > 1e-9 * max(run.energy_lost_j, 1e-9), caution("impacts_gained_energy", energy_j=gained_j)),
    ]
    if limits is not None and limits.left_domain_s is not None:
        left = changes_answer("left_domain", at_s=limits.left_domain_s, by=limits.left_domain_by)
        said.append((True, _from(run, limits.left_domain_s, left)))
    return tuple(finding for holds, finding in said if holds)


def _from(run: Solution, time_s: float, found: Finding) -> Finding:
    """What is found from then on: nothing to beware of where the statue had passed the point of no return."""
    fell = run.no_return_time_s is not None and run.no_return_time_s <= time_s
    return replace(found, severity=Severity.INFO) if fell else found


def stated_settings(settings: TwoBlockSettings) -> Mapping[str, object]:
    """The settings as a run states them: what is not in use is left out."""
    unused = {"dt_s": 0.0, "step_cap_s": math.inf}
    return {name: value for name, value in settings.as_dict().items() if value != unused.get(name)}


def _run(scene: Scene, settings: TwoBlockSettings, solution: Solution, wall_s: float, keep: bool) -> Run:
    """A run that states no error yet."""
    counts = solution.counts
    return Run(
        engine=TwoBlock.name,
        outcome=Outcome(solution.outcome.value),
        history=(
            History(
                solution.t_s, solution.theta_rad, solution.theta_rate_rad_s, solution.slip_m, solution.slip_rate_m_s
            )
            if keep
            else None
        ),
        settings=stated_settings(settings),
        steps=counts.steps,
        wall_s=wall_s,
        peak_theta_rad=solution.peak_theta_rad,
        peak_time_s=solution.peak_time_s,
        end_s=solution.end_s,
        overturn_time_s=solution.overturn_time_s,
        no_return_time_s=solution.no_return_time_s,
        impact_times_s=tuple(solution.impact_times_s.tolist()),
        uplift_times_s=tuple(solution.uplift_times_s.tolist()),
        peak_slip_m=solution.peak_slip_m,
        residual_slip_m=solution.final_slip_m,
        patterns=tuple(
            Pattern(item.start_s, item.end_s, cast(PatternName, item.pattern)) for item in solution.patterns
        ),
        validity=_validity(scene, solution),
        work={"taylor_coefficients": counts.coefficients, "events": counts.events, "impacts": counts.impacts},
        skipped=skipped(solution, keep),
        findings=left_out(scene.base_excitation),
    )
