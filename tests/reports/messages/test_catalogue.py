"""Every code that the program can say has one sentence in each language, which its values fill; no code reads one back."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from harness import Outcome, Verdict
from harness.input.tables import ASSUMPTIONS
from harness.model import SKIPS, Answer, Finding, caution, changes_answer, info, texted, weighed
from harness.questions.assess.options import PAIRS
from harness.questions.bench.standard_scenes import standard_set
from harness.questions.bench.stress_run import catalogue, difficulties
from harness.records.bench import TOGETHER, BenchRecord, StressRecord
from reports.messages import COUNTED, ENGLISH, FIELD, FORMATS, LANGUAGES, OPTIONAL, agreed, language

PACKAGES = ("analytic", "meshes", "harness", "reports")
MAKERS = {"info", "caution", "changes_answer", "Doubt", "Change"}
SAMPLES = {
    "plain": "pymunk", "count": 3, "number": 0.25, "s": 1.25, "rad": 1e-4, "angle": 0.1, "angles": [0.1, 0.2], "m": 0.012,
    "lengths": [0.01, 0.02], "g": 0.3, "j": 2.0, "share": 0.123, "names": ["analytic", "pymunk"], "vector": [1.0, 0.0, 0.0],
    "directions": [0.0, 22.5], "given": 0.0254,
    "choices": {"kinetic": "stands", "static": "overturned_right"},
    "groups": {"stands": ["analytic"], "overturned": ["pymunk"]}, "without": {"products_of_inertia": 0.03},
    "change": -0.02, "adjusted": {"centroid": 0.03},
    "factors": {"0.05": [1.02, 1.1, None]}, "key": "contact.floor", "points": 0.012, "of_points": 0.012,
    "classes": {"confirmed": 0.3, "refuted": 0.01}, "hz": 2.5,
    "counts": {"statue_tips": 3}, "parts": {"rocking": [2, 5]}, "interval": [1.0, 0.9, 1.1],
    "changes": {"planed flat": [-0.057, 0.05]}, "rate": [0.8, 0.7, 0.9], "speeds": [0.3, 0.4],
    "pairs": {"pymunk": "stands"}, "settings": {"pedestal.mass_kg": 250.0}, "side": "left",
}  # fmt: skip
"""A value of each format."""


def emitted(root: Path) -> Iterator[tuple[str, str]]:
    """Codes in calls that make a finding, with the file that each stands in."""
    for package in PACKAGES:
        for path in (root / package).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Call) and getattr(node.func, "id", "") in MAKERS and node.args:
                    first = node.args[0]
                    if isinstance(first, ast.Constant):
                        yield str(first.value), path.name


def sentences(code: str) -> dict[str, dict[str, str]]:
    """The findings' sentences of a language, by code and by the value that chooses one."""
    found: dict[str, dict[str, str]] = {}
    for key, text in language(code).strings.items():
        if key.startswith("finding."):
            name, _, variant = key.removeprefix("finding.").partition(".")
            found.setdefault(name, {})[variant] = text
    return found


def test_every_code_that_is_said_has_a_sentence_and_no_other_has_one(root: Path) -> None:
    said = {code for code, _ in emitted(root)}
    fixed = {"model_says", "models_agree"}
    assert said | fixed == set(sentences("en"))


def test_every_language_says_the_same_of_the_same_values() -> None:
    english = sentences("en")
    for code in LANGUAGES:
        other = sentences(code)
        assert {name: [*texts] for name, texts in other.items()} == {name: [*texts] for name, texts in english.items()}
        for name, texts in english.items():
            for variant, text in texts.items():
                here = other[name][variant]
                fields, theirs = (sorted(FIELD.findall(agreed(each, {}))) for each in (text, here))
                assert theirs == fields, f"{code}: {name}"
                assert {part[0] for part in COUNTED.findall(here)} <= {field for field, _ in fields}, f"{code}: {name}"
                assert len(OPTIONAL.findall(here)) == len(OPTIONAL.findall(text)), f"{code}: {name}"


@pytest.mark.parametrize("code", LANGUAGES)
def test_every_sentence_is_filled_with_all_of_its_values_and_with_the_least(code: str) -> None:
    say = language(code)
    for name, texts in sentences(code).items():
        for variant, text in texts.items():
            if variant == "by":
                continue
            many = agreed(text, {})
            values = {field: SAMPLES[form or "plain"] for field, form in FIELD.findall(many)}
            needed = {field for field, _ in FIELD.findall(OPTIONAL.sub("", many))}
            chosen = {texts["by"]: {"True": True, "False": False}.get(variant, variant)} if "by" in texts else {}
            single = values | {part[0]: 1 for part in COUNTED.findall(text)}
            for filled in (values, single, {key: value for key, value in values.items() if key in needed}):
                told = say.say(info(name, **{**filled, **chosen}))
                assert told.endswith((".", ")", "?")), told
                assert not re.search(r"[{}\[\]]|–\s|None", told), told


def test_what_is_counted_once_is_said_in_the_singular() -> None:
    counts = {"cases": 1, "wanted": 1, "alike": 0, "found": 0, "computed": 1, "not_sent": 0, "failed": 0}
    assert ENGLISH.say(info("study_done", **counts)) == "1 case, 1 run wanted, 1 computed."
    assert (
        ENGLISH.say(info("study_done", **counts | {"cases": 21, "wanted": 0})) == "21 cases, 0 runs wanted, 1 computed."
    )
    assert language("it").say(info("study_done", **counts)) == "1 caso, 1 calcolo richiesto, 1 eseguito."
    assert language("it")("text.further", count=1) == "un altro risultato"
    assert language("it")("text.further", count=2) == "altri 2 risultati"


def test_every_outcome_verdict_and_skip_has_words() -> None:
    for code in LANGUAGES:
        say = language(code)
        for outcome in Outcome:
            assert say.strings[f"word.{outcome.value}"]
            assert say.strings[f"short.{outcome.value}"]
        assert {f"pair.{verdict.name.lower()}" for verdict in Verdict} <= set(say.strings)
        assert {f"skip.{name}" for name in SKIPS} <= set(say.strings)


def test_every_assumed_width_and_pair_of_materials_has_its_source() -> None:
    for code in LANGUAGES:
        strings = language(code).strings
        assert {f"assumed.{item.name}" for item in ASSUMPTIONS} == {
            key for key in strings if key.startswith("assumed.")
        }
        assert {f"published.{pair}" for pair in PAIRS} == {key for key in strings if key.startswith("published.")}


KEY_LETTERS = 40
"""On a telephone of 390 pixels a chart's key has 280 beside its margins and its sign, of seven a letter."""


def test_the_kinds_of_motion_fit_a_telephone() -> None:
    """The page scrolled sideways: the key of its histories was wider than the screen."""
    for code in LANGUAGES:
        strings = language(code).strings
        kinds = [words for key, words in strings.items() if key.startswith("chart.pattern_")]
        assert kinds
        assert max(map(len, kinds)) <= KEY_LETTERS


def test_a_number_is_written_as_the_language_writes_it() -> None:
    finding = info("probability", share=0.394, model="analytic")
    assert "39\u00a0%" in language("en").say(finding)
    assert "5,1\u00a0%" in language("it").say(info("probability", share=0.051, model="analytic"))
    assert language("en").value(None, "s") == "–"
    assert [language(code).plain(True) for code in ("en", "it")] == ["yes", "sì"]
    told = [language("it").plain(each) for each in ([0.5, 1.25], ["statue_slides", "spatial"])]
    assert told == ["0,5000; 1,250", "la statua scivola sul suo appoggio, spatial"]
    # What a user copies into a scene is written as the scene wants it.
    assert language("it").value(0.02543, "given") == "0.02543"
    assert set(SAMPLES) == set(FORMATS)


def test_a_name_that_is_no_word_stays_and_is_printable() -> None:
    assert language("en").word("pymunk:plain") == "pymunk:plain"
    assert "\x1b" not in language("en").word("\x1b[31m")


def test_findings_are_sorted_by_severity_and_told_once() -> None:
    light, middle, heavy = info("histories_agree"), caution("near_tangent_events", steps=2), changes_answer("no_answer")
    assert weighed([light, heavy, middle, light, heavy.of("")]) == [heavy, middle, light]


def test_an_answer_is_the_sentences_of_its_findings() -> None:
    say = language("en").say
    parts = [info("histories_agree"), info("histories_known_until", until_s=2.0)]
    answer = Answer("agree", parts).texted(say)
    assert answer.text == " ".join(each.text for each in texted(parts, say))
    assert all(isinstance(each, Finding) and each.text for each in answer.findings)


RENDERED = {"sentence", "headline", "verdict_sentence", "said", "text", "evidence", "answer"}
"""What holds a finished sentence."""
SAYERS = {"say", "texted"}
"""What makes one."""
ON_TEXT = {
    "startswith", "endswith", "replace", "partition", "rpartition", "split", "find", "index", "count", "removeprefix",
    "removesuffix",
}  # fmt: skip
IN_TEXT = {"search", "match", "sub", "findall", "finditer", "fullmatch", "split"}


def test_no_code_searches_a_finished_sentence(root: Path) -> None:
    """No regular expression, `in`, `startswith`, `replace` or `partition` on a sentence of ours."""
    wrong = []
    for package in PACKAGES:
        for path in (root / package).rglob("*.py"):
            wrong += [f"{path.name}:{line}" for line in searches(ast.parse(path.read_text(encoding="utf-8")))]
    for path in (root / "reports" / "templates").glob("*.j2"):
        wrong += [f"{path.name}: {found}" for found in IN_TEMPLATE.findall(path.read_text(encoding="utf-8"))]
    assert not wrong


IN_TEMPLATE = re.compile(
    rf"(?:{'|'.join(sorted(RENDERED))})\.(?:{'|'.join(sorted(ON_TEXT))})\(|\bin [\w.]*\.(?:{'|'.join(sorted(RENDERED))})\b"
)


def searches(tree: ast.AST) -> list[int]:
    """The lines on which a finished sentence, or a name that was given one in the same function, is searched."""
    lines = []
    for scope in ast.walk(tree):
        if isinstance(scope, ast.FunctionDef | ast.Module):
            named = {
                target.id
                for node in ast.walk(scope)
                if isinstance(node, ast.Assign) and isinstance(scope, ast.FunctionDef) and finished(node.value, set())
                for target in node.targets
                if isinstance(target, ast.Name)
            }
            lines += [
                node.lineno
                for node in ast.walk(scope)
                if isinstance(node, ast.Compare | ast.Call) and any(finished(each, named) for each in searched(node))
            ]
    return sorted(set(lines))


def finished(node: ast.AST, named: set[str]) -> bool:
    """Whether an expression is a sentence of ours: what holds one, what makes one, or a name that was given one."""
    if isinstance(node, ast.Call):
        return getattr(node.func, "attr", getattr(node.func, "id", "")) in SAYERS
    return getattr(node, "attr", "") in RENDERED or getattr(node, "id", "") in named


def searched(node: ast.Compare | ast.Call) -> list[ast.expr]:
    """What an expression searches for text."""
    if isinstance(node, ast.Compare):
        return [node.comparators[0]] if isinstance(node.ops[0], ast.In | ast.NotIn) else []
    if not isinstance(node.func, ast.Attribute):
        return []
    return [node.func.value] * (node.func.attr in ON_TEXT) + node.args * (node.func.attr in IN_TEXT)


@pytest.mark.parametrize(
    ("code", "seen"),
    [
        ("'x' in run.sentence", True),
        ("scores.verdict_sentence.replace('a', 'b')", True),
        ("PATTERN.search(finding.text)", True),
        ("ENGLISH.say(each).startswith('The')", True),
        ("def f(each):\n    told = ENGLISH.say(each)\n    return 'x' in told", True),
        ("def f(each):\n    told = each.code\n    return 'x' in told", False),
        ("finding.code in CODES", False),
    ],
)
def test_such_a_search_is_seen(code: str, seen: bool) -> None:
    assert bool(searches(ast.parse(code))) is seen


def test_such_a_search_in_a_template_is_seen() -> None:
    assert IN_TEMPLATE.search('{% if not verdict.headline.endswith(".") %}')
    assert IN_TEMPLATE.search("{% if 'fell' in item.text %}")
    assert not IN_TEMPLATE.search("{% for each in findings %}{{ each.text }}{% endfor %}")


@pytest.mark.parametrize(
    ("share", "said"),
    [(0.08, "dell'8"), (0.83, "dell'83"), (0.11, "dell'11"), (0.01, "dell'1"), (0.005, "dello 0,5"), (0.12, "del 12")],
)
def test_an_italian_article_follows_its_number(share: float, said: str) -> None:
    """In a string of its own and in a finding's."""
    say = language("it")
    assert f"da una spinta {said} % del peso" in say("push.statue_slides", pushes=say.percent(share))
    worst = {"bounded": True, "azimuth_deg": 0.0, "planar_g": 0.3, "solid_g": 0.2, "sides_deg": [], "never": 0}
    assert f"È insicuro {said}\u00a0% verso" in say.say(info("plane_worst", error=share, **worst))


def test_scenes_that_are_measured_by_have_names_in_every_language() -> None:
    """On an Italian page they stood in English."""
    names = [each.name for each in (*standard_set(), *catalogue(), *difficulties())]
    names += [each.note for each in catalogue() if each.note] + [BenchRecord.title, StressRecord.title, TOGETHER]
    for code in LANGUAGES:
        assert [name for name in names if f"word.{name}" not in language(code).strings] == []
    italian = language("it")
    assert italian.word("free rocking") != "free rocking"
