"""The page of two histories from files: the verdict, both curves and their difference, the scores in words."""

from pathlib import Path

from harness.input.history_file import read_history
from harness.records.scores import FILES, CompareRecord
from harness.records.scores import Verdict as ScoredVerdict
from reports.blocks import Block, Chart, Table, Verdict, command_line, repeat, section
from reports.charts.curve_figures import compare_figure
from reports.messages import Language
from reports.source import check_files
from reports.text.wording import score_rows


def blocks(folder: Path, record: CompareRecord, say: Language) -> list[Block]:
    """The blocks of the page; raises `InputError` for a history that is lost or was changed."""
    paths = [folder / name for name in FILES]
    check_files(paths, record)
    a, b = map(read_history, paths)
    scores = record.scores
    # Both may have the same name, in two folders.
    names = (scores.a, scores.b) if scores.a != scores.b else (f"{scores.a} (1)", f"{scores.b} (2)")
    tone = "agree" if scores.verdict is ScoredVerdict.AGREE else "differ"
    return [
        Verdict(scores.verdict_sentence, tone, [each.text for each in scores.findings[1:]]),
        *section(
            say, "histories", Chart("histories", say("text.compare_chart"), compare_figure(names, a, b, say), 1060)
        ),
        *section(
            say,
            "scores",
            Table(say("table.compare"), ["", say("label.value")], score_rows({record.title: scores}, say)),
        ),
        *repeat(say, record, command_line("compare", scores.a, scores.b, *(record.asked or ()), out=folder.name)),
    ]
