"""The analytic model over many draws, for the outcome alone."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from analytic.excitation import Harmonic, ZeroExcitation
from harness.engines import analytic as twoblock
from harness.model.errors import InputError, Mistake
from harness.model.scene import Scene, Uncertain
from harness.questions.assess.inputs import draw, row
from harness.questions.assess.variation import IMPACT, KINETIC, STATIC, file_scale, varied

Array = NDArray[np.float64]
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


def _swept(scene: Scene, draws: Mapping[str, Array]) -> ModelDraws:
    from analytic import Outcome, ensemble

    sweep: dict[str, Array] = {}
    for key, values in draws.items():
        for name, column in (_sweep_of(scene, key, values) or {}).items():
            sweep[name] = sweep.get(name, 1.0) * column if name in FACTORS else column
    _check_starts(scene, draws.get(START))
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
    # (A fall told by energy alone has no such instant: nothing is known past the domain.)
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
        # The axis of time stretched: see harness.questions.assess.variation.
        return own if key == "motion.scale" else {**own, "gravity_m_s2": scene.gravity_m_s2 * factor}
    if key == "motion.x.frequency_hz" and isinstance(base_excitation.x, Harmonic):
        return {"frequency_hz": values}
    if key == "contact.statue":
        return {"statue_friction": values}
    if key == "motion.y.frequency_hz" and isinstance(base_excitation.y, Harmonic):
        # The planar statue does not move across its plane.
        return {}
    return None
