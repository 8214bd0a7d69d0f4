"""Tables of the documentation are renewed between their marks, and every mark names a command that is there."""

import re
from importlib import import_module

import pytest

from tests.engines_for_tests import ready
from tests.measures import paper_forms
from tests.measures.pages import DOCS, END, begin, renewed


def test_only_what_stands_between_the_marks_is_renewed() -> None:
    page = f"before\n{begin('a.b')}\nold\n{END}\nbetween\n{begin('a.b c')}\nother\n{END}\nafter\n"
    assert renewed(page, "a.b", "new") == page.replace("old", "new")
    assert renewed(page, "a.b c", "new") == page.replace("other", "new")
    with pytest.raises(ValueError, match="no marks"):
        renewed("a page", "a.b", "new")


def test_every_mark_of_the_documentation_names_a_command_and_its_table() -> None:
    ready("pybullet")
    from tests.measures import pybullet_settings

    named = {
        "tests.measures.paper_forms": paper_forms.TABLES,
        "tests.measures.pybullet_settings": pybullet_settings.TABLES,
    }
    marks = [
        mark
        for path in DOCS.rglob("*.md")
        for mark in re.findall(r"<!-- begin: python -m (\S+) ?(\S*) -->", path.read_text())
    ]
    assert len(marks) >= 12
    for module in {module for module, _ in marks}:
        assert hasattr(import_module(module), "__file__"), module
    for module, tables in named.items():
        assert [name for at, name in marks if at == module] == list(tables)
