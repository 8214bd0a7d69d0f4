"""Models against measured planar drops: what is fitted on a third, how probable what was seen is on the others."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import closing
from functools import partial
from pathlib import Path
from typing import Final

import numpy as np

from harness import engines
from harness.model.errors import InputError, Mistake
from harness.model.finding import Answer, Finding, Say, caution, info
from harness.model.history import Array
from harness.questions.validate.drops import (
    Drop,
    DropTask,
    baselines,
    coefficients,
    computed,
    crps,
    fit,
    forecast,
    log_scores,
    read_drops,
    smoothed,
)
from harness.questions.validate.jobs import parse_model
from harness.questions.validate.measured_set import MeasuredSet, Rows, shares
from harness.records.measured import Cell, MeasuredRecord, MeasuredTable
from harness.runs.progress import progress
from harness.runs.runner import LocalPool

ENGINES: Final = ("spatial", "pymunk", "pymunk:plain", "pybullet:plain")
"""pybullet, which locates plastic impacts alone, takes as long as the others together: who wants it names it."""
SAMPLES: Final = 32
MOST_SAMPLES: Final = 1000
TOLD: Final = 2.0
"""A gain of this many standard errors is told from none."""
SCORES: Final = (
    "model", "log_score", "crps_turns", "gain_all_drops", "error_all", "gain_first_face", "error_face",
    "restitution", "restitution_sd", "friction", "friction_sd", "background", "draws_without_end",
)  # fmt: skip
ROWS: Final = ("drop", "model", "seen_quarter_turn", "probability", "log_score", "crps_quarter_turns")


def validate_drops(
    table: Path,
    folder: Path,
    body: Path,
    *,
    models: Sequence[str] | None = None,
    samples: int = 0,
    seed: int = 0,
    jobs: int | None = None,
    quiet: bool = False,
    say: Say = str,
) -> MeasuredRecord:
    """Score the models on measured planar drops of a scene's body; writes result.json into `folder`.

    Each drop is run in `samples` draws (0: 32) of its measured start and of the two coefficients; how the draws are weighed is
    fitted on a seeded third. Raises `InputError` for a wrong table, scene, model or number.
    """
    if not 0 <= samples <= MOST_SAMPLES:
        raise InputError(Mistake("--samples", "", f"a whole number from 0 to {MOST_SAMPLES}", str(samples)))
    measured, count = MeasuredSet(table, folder, body), samples or SAMPLES
    base = measured.base
    known = [parse_model(name) for name in dict.fromkeys(models or ENGINES)]
    drops, refused = read_drops(table, base)
    if len(drops) < 4:
        raise InputError(Mistake(str(table), "", "four drops that begin in flight and come to rest", str(len(drops))))
    sets = _Sets(drops, seed)
    rows: Rows = []
    each: Rows = []
    failed: list[Finding] = []
    with closing(LocalPool(jobs)) as pool, progress(table.name, quiet) as on_progress:
        for place, model in enumerate(known):
            tasks = [DropTask(base, drop, model, count, seed) for drop in drops]
            answers = computed(pool, tasks, partial(_told, on_progress, place * len(drops), len(known) * len(drops)))
            if isinstance(answers, str):
                failed.append(caution("model_not_run", model=model.name, reason=answers))
                continue
            row, one = sets.scored(model.name, answers, coefficients(count, seed))
            if model.engine in engines.PLASTIC_THROWN:
                row = [None if key.startswith("restitution") else cell for key, cell in zip(SCORES, row, strict=True)]
            rows.append(row)
            each += one
    rows += sets.bare_rows()
    fall = float(np.median([drops[k].fall_m_s2 for k in sets.fitted]))
    found = [
        caution("drops_dragged", fall_m_s2=fall, drag_m_s2=base.gravity_m_s2 - fall),
        *failed,
        *([caution("drops_refused", count=len(refused), names=list(refused))] if refused else []),
    ]
    return measured.written(
        "drops",
        f"{len(drops)} measured planar drops",
        [MeasuredTable("models", SCORES, rows), MeasuredTable("drops", ROWS, each)],
        say,
        answer=_answer(rows, len(sets.rest), len(drops)),
        findings=found,
        samples=count,
        seed=seed,
    )


def _told(on_progress: Callable[[int, int], None], before: int, of: int, done: int) -> None:
    on_progress(before + done, of)


class _Sets:
    """The drops that are fitted on and those that are scored, with what needs no model of each."""

    def __init__(self, drops: Sequence[Drop], seed: int) -> None:
        (self.fitted, self.rest), self.drops = shares(len(drops), seed), drops
        turned = [drops[k].turn - drops[k].face for k in self.fitted]
        self.behind = np.array([smoothed([turn + drop.face for turn in turned]) for drop in drops])
        self.seen = [drops[k].turn for k in self.rest]
        self.bare = {name: values[self.rest] for name, values in baselines(drops).items()}
        self.bare_scores = {name: log_scores(values, self.seen) for name, values in self.bare.items()}

    def scored(self, name: str, answers: dict[str, list[int | None]], drawn: Array) -> tuple[Sequence[Cell], Rows]:
        """A model's row, and one for each scored drop."""
        drops = self.drops
        fitting, rest = ({drops[k].name: answers[drops[k].name] for k in part} for part in (self.fitted, self.rest))
        best = fit(drawn, fitting, self.behind[self.fitted], [drops[k].turn for k in self.fitted])
        likely = forecast(best, drawn, rest, self.behind[self.rest])
        scores, ranked = log_scores(likely, self.seen), crps(likely, self.seen)
        lost = float(np.mean([turn is None for found in answers.values() for turn in found]))
        (e, mu), (e_sd, mu_sd) = best.means, best.widths
        row = [*self._row(name, scores, ranked), e, e_sd, mu, mu_sd, best.background, lost]
        one: Rows = [
            [drop, name, turn, float(np.exp(-score)), float(score), float(rank)]
            for drop, turn, score, rank in zip(rest, self.seen, scores, ranked, strict=True)
        ]
        return row, one

    def bare_rows(self) -> Rows:
        """Rows of the baselines."""
        return [
            [*self._row(name, self.bare_scores[name], crps(values, self.seen)), *[None] * 6]
            for name, values in self.bare.items()
        ]

    def _row(self, name: str, scores: Array, ranked: Array) -> list[Cell]:
        gains: list[Cell] = []
        for bare in self.bare_scores.values():
            gain = bare - scores
            gains += [float(gain.mean()), float(gain.std(ddof=1) / np.sqrt(gain.size))]
        return [name, float(scores.mean()), float(ranked.mean()), *gains]


def _answer(rows: Sequence[Sequence[Cell]], scored: int, count: int) -> Answer:
    """Which model predicts best, and whether it is told from what needs none."""
    models = [dict(zip(SCORES, row, strict=True)) for row in rows if row[SCORES.index("background")] is not None]
    if not models:
        return Answer("no_answer", [info("no_answer")])
    best = min(models, key=lambda row: float(row["log_score"] or 0.0))
    gains = [(float(best[a] or 0.0), float(best[b] or 0.0)) for a, b in zip(SCORES[3:7:2], SCORES[4:7:2], strict=True)]
    least, error = min(gains)
    told = all(gain > TOLD * noise for gain, noise in gains)
    values = {"model": best["model"], "log_score": best["log_score"], "least_gain": least, "error": error, "told": told}
    return Answer("drops_told" if told else "drops_not_told", [info("drops_best", scored=scored, of=count, **values)])
