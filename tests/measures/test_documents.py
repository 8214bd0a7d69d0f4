"""What README and notebook show is what the program gives now: `python -m tests.measures.documents` renews it."""

import json
from pathlib import Path

import pytest

from tests.engines_for_tests import ready
from tests.measures.documents import executed, first_run
from tests.measures.pages import DOCS, begin
from tests.reports.shown import not_printed, shown


def test_the_readme_shows_the_first_lines_of_its_run(root: Path, tmp_path: Path) -> None:
    ready("pybullet")
    readme = (root / "README.md").read_text(encoding="utf-8")
    ((command, lines),) = shown(readme.partition(begin("tests.measures.documents"))[2])
    assert len(lines) == 12
    printed = first_run(tmp_path / "run")
    assert command in printed
    assert not_printed(lines, printed) == [], printed


def test_the_notebook_shows_what_its_cells_give(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pandas", reason="pandas (the extra [frames]) is not installed")
    pytest.importorskip("matplotlib").use("Agg")
    monkeypatch.chdir(root)
    notebook = json.loads((DOCS / "example.ipynb").read_text(encoding="utf-8"))
    assert sum(len(cell.get("outputs", [])) for cell in notebook["cells"]) >= 8
    assert executed(notebook, {}) == notebook
