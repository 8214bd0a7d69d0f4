"""The field's standard terms, one for each thing: words that were replaced do not come back, in names or in sentences."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGES = ("analytic", "meshes", "harness", "reports")
NAMES = {
    "want": "options",
    "rung": "level",
    "rungs": "levels",
    "ladder": "levels",
    "probe": "verification run",
    "probes": "verification runs",
    "rattle": "micro-rocking",
    "rattles": "micro-rocking",
    "rattling": "micro-rocking",
    "swing": "half-cycle",
    "swings": "half-cycles",
    "halt": "stick onset",
    "halts": "stick onsets",
    "halted": "sticks",
    "march": "state",
    "shake": "base_excitation",
    "peer": "other_project",
    "stance": "orientation",
    "crumbs": "debris",
    "mending": "repair",
    "mended": "repaired",
    "course": "run_phases",
}
"""Parts of a name, and what the thing is called instead."""
SAYING = {"tell": "on_progress", "told": "messages, sentences or on_progress", "telling": "messages"}
SAYING_ROOMS = ("analytic", "meshes", "harness")
"""The same for what is said."""
ENGINE_NAMES = {
    "found": "a noun",
    "kept": "a noun",
    "standing": "support",
    "sweeps": "iterations",
    "coming": "contact time",
}
"""The same where the mechanics is: in the engines, what chooses their steps, and what runs a scene."""
ENGINE_ROOMS = ("harness/engines", "harness/accuracy", "harness/scene_run", "harness/cli.py")
NO_NOUNS = {"found", "kept"}
"""What no value is called: a reader learns from it how it came to be, not what it is."""
NO_NOUNS_YET = ("analytic/spatial/kernel/resting.py",)
ALLOWED = {
    ("analytic/solution.py", "HALT"): "the name of an event in records",
}
PROSE = {
    r"tossed coin": "what chance gives",
    r"the peer\b": "its name",
    r"fine and dear": "coarse to fine, the cost rising",
    r"ever smaller": "chattering",
    r"stands? up to": "does not overturn up to",
    r"\b[Rr]ungs?\b": "level",
    r"\b[Rr]attl(e|es|ed|ing)\b": "micro-rocking",
    r"\b[Cc]rumbs?\b": "debris",
    r"\bdear(er|est)?\b": "costly",
    r"\b[Ll]adders?\b": "levels",
    r"\b[Pp]robes?\b": "verification run",
    r"\bbare loops?\b": "baseline loop",
}
"""Patterns of sentences, and what to write instead."""
KEYS = re.compile(r'"[a-z0-9_]+"|\{\{.*?\}\}|\{%.*?%\}|`[^`\n]*`')
"""What is no sentence: keys of records, expressions of templates, code."""


def names(text: str) -> Iterator[str]:
    """The names that a module spells."""
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.NAME:
            yield token.string


def wrong_names(path: str, text: str) -> set[str]:
    """Names of a module with a part that was replaced."""
    forbidden = NAMES | (ENGINE_NAMES if path.startswith(ENGINE_ROOMS) else {})
    if path.startswith(SAYING_ROOMS):
        forbidden |= SAYING
    return {
        name for name in names(text) if forbidden.keys() & set(name.lower().split("_")) and (path, name) not in ALLOWED
    }


def nameless(text: str) -> set[str]:
    """Values and arguments that a module binds to a word that is no noun; a record's own keys are left as they are."""
    nodes = list(ast.walk(ast.parse(text)))
    fields = {id(node.target) for node in nodes if isinstance(node, ast.AnnAssign)} - {
        id(node.target)
        for function in nodes
        if isinstance(function, ast.FunctionDef)
        for node in ast.walk(function)
        if isinstance(node, ast.AnnAssign)
    }
    values = {
        node.id
        for node in nodes
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store) and id(node) not in fields
    }
    return NO_NOUNS & (values | {node.arg for node in nodes if isinstance(node, ast.arg)})


def wrong_sentences(text: str) -> set[str]:
    plain = KEYS.sub("", text)
    return {found[0] for pattern in PROSE for found in re.finditer(pattern, plain)}


def product(root: Path, *endings: str) -> Iterator[tuple[str, str]]:
    for package in PACKAGES:
        for path in (root / package).rglob("*"):
            if path.suffix in endings:
                yield path.relative_to(root).as_posix(), path.read_text(encoding="utf-8")


@pytest.mark.parametrize("package", PACKAGES)
def test_no_name_that_was_replaced_is_back(root: Path, package: str) -> None:
    modules = {name: text for name, text in product(root, ".py") if name.startswith(package)}
    assert modules
    assert {name: wrong for name, text in modules.items() if (wrong := wrong_names(name, text))} == {}


def test_every_value_is_named_by_a_noun(root: Path) -> None:
    modules = {name: text for name, text in product(root, ".py") if not name.startswith(NO_NOUNS_YET)}
    assert {name: wrong for name, text in modules.items() if (wrong := nameless(text))} == {}


def test_no_sentence_uses_a_word_that_was_replaced(root: Path) -> None:
    pages = dict(product(root, ".py", ".j2"))
    pages |= {path.name: path.read_text(encoding="utf-8") for path in (root / "docs").glob("*.md")}
    pages |= {name: (root / name).read_text(encoding="utf-8") for name in ("README.md", "CONTRIBUTING.md")}
    assert {name: wrong for name, text in pages.items() if (wrong := wrong_sentences(text))} == {}


def test_what_is_allowed_is_there(root: Path) -> None:
    for path, name in ALLOWED:
        assert name in set(names((root / path).read_text(encoding="utf-8"))), "take it off the list"


def test_a_word_that_is_back_is_seen() -> None:
    assert wrong_names("harness/engines/a.py", "def next_swing_s(found: int) -> None: ...\n") == {
        "next_swing_s",
        "found",
    }
    assert wrong_names("meshes/a.py", "found = 1\nstanding = 'a swing'\n") == set()
    assert nameless("class A:\n    found: int\ndef f(kept):\n    found: int = kept\n") == {"found", "kept"}
    assert nameless("class A:\n    found: int\nA(found=1).found\n") == set()
    assert wrong_sentences("Every rung of `rungs` stands up to 1 g.") == {"rung", "stands up to"}
    assert wrong_sentences('{"rung": 1}') == set()
