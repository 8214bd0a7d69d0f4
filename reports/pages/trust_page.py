"""The page of a trust map: one picture of where the analytic model holds, and what each class means."""

import shlex
from pathlib import Path
from typing import Final

from harness.accuracy.horizon import MODEL
from harness.questions.trust import CELLS_NAME
from harness.records.trust import CLASSES, HELD, TrustRecord
from reports.blocks import Block, Chart, Facts, Group, Text, command_line, facts, grid, repeat, section, verdict, words
from reports.charts.map_figures import POINT, point_figure, sets, trust_map
from reports.messages import Language

BASES: Final = ("rest", "runs", "between", "checked")
"""What a point may rest on."""


def blocks(_folder: Path, record: TrustRecord, say: Language) -> list[Block]:
    """The blocks of a trust map's page."""
    kinds = [kind for kind in CLASSES if any(each.shares[kind] for each in record.maps)]
    cells = [cell for each in record.maps for cell in each.cells]
    falls = any(cell["outcomes"].get(MODEL) == "overturned" for cell in cells)
    tone = "failed" if "refuted" in kinds else "agree" if set(kinds) <= HELD and not falls else "differ"
    where = {each.stands_on: f" {say(f'chart.on_{each.stands_on}')}" if record.maps[1:] else "" for each in record.maps}
    shares = {
        kind: say.row([f"{say.percent(each.shares[kind])}{where[each.stands_on]}" for each in record.maps])
        for kind in kinds
    }
    meanings = [(f"{say.word(kind)}, {each}", say(f"text.trust_{kind}")) for kind, each in shares.items()]
    counts = [(say(f"text.basis_{name}"), str(sum(cell["basis"] == name for cell in cells))) for name in BASES]
    spent = {
        "engines": record.engines,
        "points": record.summary.points,
        "cpu_time": say.value(record.summary.cpu_s, "s"),
    }
    command = command_line("run", record.scene.file or "SCENE", e=record.engines, set=record.overrides)
    whole = command_line(
        "trust", record.scene.file or "SCENE", coarse=record.coarse, e=record.engines, set=record.overrides,
        motion=record.motion, seed=record.seed,
    )  # fmt: skip
    *_, floor = record.maps
    run = point_figure(record.maps, say)
    return [
        verdict(record, tone),
        *section(
            say, "map",
            grid(
                Chart(each.stands_on, say(f"text.trust_on_{each.stands_on}"), trust_map(each, floor, command, say))
                for each in record.maps
            ),
            Group("", [Chart(POINT, say("text.trust_point"), run, 1060)], say("text.trust_point")) if run else None,
            words(say, "trust_map", motion=say(f"text.motion_{record.motion}"), name=CELLS_NAME),
        ),
        *section(
            say, "classes", Facts(meanings, ""), Group("", [Facts(counts)], say("text.bases")),
            Text([each.text for each in record.findings], "notes"),
        ),
        *repeat(say, record, whole, f"{command} {shlex.join(sets(record.maps[0].cells[-1]))}", more=[facts(say, spent)]),
    ]  # fmt: skip
