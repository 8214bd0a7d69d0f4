"""A page is printed whole by the machine's own browser, and a missing one is said before anything is written."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from reports.cli import app
from reports.export import figures as pdf
from tests.reports.invented_run import write_invented

needs_browser = pytest.mark.skipif(
    not any(map(shutil.which, pdf.BROWSERS)), reason="no Chromium on this machine (on Debian: apt-get install chromium)"
)


@needs_browser
@pytest.mark.browser
def test_a_conservators_page_is_printed_in_italian(tmp_path: Path) -> None:
    folder = write_invented(tmp_path / "run", disagree=True)
    words = ["report", str(folder), "--for", "conservator", "--language", "it", "--pdf"]
    result = CliRunner().invoke(app, words)
    assert result.exit_code == 0, result.output
    printed = (folder / "conservator.pdf").read_bytes()
    assert printed.startswith(b"%PDF")
    assert len(re.findall(rb"/Type\s*/Page\b", printed)) >= 1
    assert 'lang="it"' in (folder / "conservator.html").read_text(encoding="utf-8")
    assert CliRunner().invoke(app, words).exit_code == 0, "its own PDF may be written again"


@needs_browser
def test_a_pdf_of_another_is_not_overwritten(tmp_path: Path) -> None:
    folder = write_invented(tmp_path / "run")
    mine = folder / "report.pdf"
    mine.write_bytes(b"%PDF mine")
    result = CliRunner().invoke(app, ["report", str(folder), "--pdf"])
    assert result.exit_code != 0
    assert mine.read_bytes() == b"%PDF mine"


def test_without_a_browser_it_is_said_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = write_invented(tmp_path / "run")
    monkeypatch.setattr(pdf.shutil, "which", lambda _: None)
    with pytest.raises(pdf.InputError, match="apt-get install chromium"):
        pdf.write_pdf(folder / "report.html")
    assert not list(folder.glob("*.pdf"))
