"""Unseen wide scenes by unmodified engines beside those that locate events: do they agree, does each know its own error?

`python -m tests.measures.plain_scenes [COUNT FIRST] [--out FILE]` computes COUNT seeds of the generator `wide` on one core, keeps
a line of JSON for each scene (a call that was interrupted goes on where it stopped) and renews
docs/measured/plain_scenes.md.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from harness import Run, Scene, engines, simulate
from harness.accuracy import horizon
from harness.accuracy.horizon import horizon_of
from harness.comparison.scores import error_rad
from harness.questions.scene.witness import TARGET_RAD as JOINT_RAD
from harness.records.run import LEAST_S, PLAIN
from tests.measures.coverage import Statement, statement, truth_of
from tests.measures.pages import renew, table
from tests.measures.random_scenes import FINEST_S, counted
from tests.measures.seeded_rows import command_line, measured, seeds_of
from tests.measures.seeded_scenes import wide_scene

NAMES: Final = ("pymunk", "pybullet")
SCENES: Final = 200
FIRST_SEED: Final = 770_000
"""Seeds from here on were used for nothing else."""
SHARE: Final = 0.5
"""Of the joint uncertainty that is asked, for each of both engines."""
PERTURBED: Final = 1e-3
"""A start or motion that is known no better than this is predictable until the horizon: plain engines err by about as much."""
MODULE: Final = "tests.measures.plain_scenes"


@dataclass(frozen=True)
class Beside:
    """A plain engine beside the event-located one, while both are bounded: how far apart, and the sum of their uncertainties.

    `known_s`: the horizon, at most until there is no return from a fall. `limits_rad`: how far much finer runs of both are apart
    while both are bounded, where the plain one's was made.
    """

    until_s: float
    known_s: float
    apart_rad: float
    joint_rad: float
    limits_rad: float | None = None

    @property
    def agree(self) -> bool:
        """Whether they are within their joint uncertainty."""
        return self.apart_rad <= self.joint_rad

    @property
    def whole(self) -> bool:
        """Whether the joint uncertainty that is asked holds as long as anybody could predict."""
        return self.joint_rad <= JOINT_RAD * (1.0 + 1e-9) and self.until_s >= self.known_s - LEAST_S


@dataclass(frozen=True)
class PlainRow:
    """One scene: each engine's statement, each pair of engines."""

    seed: int
    engines: dict[str, Statement]
    pairs: dict[str, Beside]


def row_of(seed: int) -> PlainRow:
    """One scene: what each engine stated and was off by, and how far each plain one is from its event-located one."""
    scene = wide_scene(seed)
    statements: dict[str, Statement] = {}
    pairs: dict[str, Beside] = {}
    for name in NAMES:
        if engines.load(name).missing() is None:
            both, pairs[name] = _beside(scene, name)
            statements |= both
    return PlainRow(seed, statements, pairs)


def _beside(scene: Scene, name: str) -> tuple[dict[str, Statement], Beside]:
    located, plain = (simulate(scene, each, accuracy_rad=SHARE * JOINT_RAD) for each in (name, name + PLAIN))
    until_s = min(located.bounded_until_s, plain.bounded_until_s)
    engine = engines.load(name)
    truth = truth_of(engine, scene, located, max(located.bounded_until_s, plain.bounded_until_s), FINEST_S)
    # A plain engine's own finer run takes minutes; the event-located one's stands for it where it lies within the statement.
    stated, limits = statement(plain, truth), None
    if not (stated.rotation_holds and stated.slip_holds and truth.end_s >= plain.bounded_until_s):
        finer = truth_of(engines.load(plain.engine), scene, plain, plain.bounded_until_s, FINEST_S)
        stated, limits = statement(plain, finer), error_rad(truth, finer, until_s)
    joint = (located.numerical_uncertainty_rad or 0.0) + (plain.numerical_uncertainty_rad or 0.0)
    apart = error_rad(located, plain, until_s)
    beside = Beside(until_s, _known_s(scene, located, plain, until_s), apart, joint, limits)
    return {name: statement(located, truth), plain.engine: stated}, beside


def _known_s(scene: Scene, located: Run, plain: Run, until_s: float) -> float:
    """Until when the scene can be predicted at all; not looked for where it is bounded to the end, or past all return."""
    last_s = horizon.last_s(located)
    if plain.outcome is located.outcome:
        # Nothing is stated of a fall past its instant of no return, which each knows but for its error: the earlier ends both.
        last_s = min(last_s, horizon.last_s(plain))
    if until_s >= last_s - LEAST_S:
        return last_s
    engine = engines.load(located.engine)
    settings = engine.settings_for_dt(scene, min(float(located.settings["dt_s"]), PERTURBED))
    return min(last_s, horizon_of(engine, scene, settings, perturbations=(PERTURBED,)).intrinsic_s)


def tables(rows: Sequence[PlainRow]) -> str:
    """Statements by engine; agreement by pair."""
    names = [name + kind for name in NAMES for kind in ("", PLAIN)]
    heads = [
        "engine",
        "scenes counted",
        "rotation held",
        "slip held",
        "held for, of the run's length",
        "runs for a scene",
    ]
    items = {name: [row.engines[name] for row in rows if name in row.engines] for name in names}
    by_engine = [[f"`{name}`", *counted(each)] for name, each in items.items() if each]
    beside = ["engine", "scenes", "within their joint uncertainty", f"that at most {JOINT_RAD:g} rad until the horizon"]
    by_pair = []
    for name in NAMES:
        pairs = [row.pairs[name] for row in rows if name in row.pairs]
        agree, whole = sum(pair.agree for pair in pairs), sum(pair.whole for pair in pairs)
        shares = [f"{count} ({100.0 * count / max(len(pairs), 1):.3g} %)" for count in (agree, whole)]
        by_pair.append([f"`{name}` and `{name}{PLAIN}`", str(len(pairs)), *shares])
    return f"{table(heads, by_engine)}\n\n{table(beside, by_pair)}"


def _exceptions(row: PlainRow) -> list[str]:
    texts = []
    for name, item in row.engines.items():
        for word, error, stated, held in (
            ("rotation", item.error_rad, item.stated_rad, item.rotation_holds),
            ("slip", item.error_m, item.stated_m, item.slip_holds),
        ):
            if not held:
                off = "no history" if error is None else f"off by {error:.2g}, stated {stated:.2g}"
                texts.append(f"seed {row.seed}, `{name}`: {word} {off}")
    for name, pair in row.pairs.items():
        if not pair.agree:
            limits = "" if pair.limits_rad is None else f"; much finer runs of both: {pair.limits_rad:.2g}"
            apart = f"{pair.apart_rad:.2g} rad apart until {pair.until_s:.3g} s, joint uncertainty {pair.joint_rad:.2g}"
            texts.append(f"seed {row.seed}, `{name}` and `{name}{PLAIN}`: {apart}{limits}")
    return texts


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure; print each scene on which a statement failed or a pair disagreed, and write the tables into the page."""
    given = command_line(MODULE, __doc__, SCENES, FIRST_SEED).parse_args(arguments)
    seeds = seeds_of(given)
    rows = measured(given.out, PlainRow, [(seed,) for seed in seeds], row_of)
    print(*(text for row in rows for text in _exceptions(row)), sep="\n", flush=True)
    sentence = f"Wide scenes, seeds {seeds[0]} to {seeds[-1]}, target {SHARE * JOINT_RAD:g} rad for each engine:"
    renew("measured/plain_scenes.md", MODULE, f"{sentence}\n\n{tables(rows)}")


if __name__ == "__main__":
    main()
