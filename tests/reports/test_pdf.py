"""A page is printed whole by the machine's own browser, and a missing one is said before anything is written."""

import re
import shutil
import subprocess
from pathlib import Path
from urllib.parse import unquote, urlparse

import pytest
from typer.testing import CliRunner

from reports.cli import app
from reports.export import figures as pdf
from reports.pages.page import write_report
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


def test_nothing_is_folded_away_in_print(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Scores, limits, what was left out and how to repeat it stood folded in the PDF of a run."""
    page, given = write_report(write_invented(tmp_path / "run")), list[str]()

    def printing(call: list[str], **_: object) -> subprocess.CompletedProcess[str]:
        given.append(Path(unquote(urlparse(call[-1]).path)).read_text(encoding="utf-8"))
        return subprocess.CompletedProcess(call, 0, "", "")

    monkeypatch.setattr(pdf.shutil, "which", lambda name: name)
    monkeypatch.setattr(pdf.subprocess, "run", printing)
    with pytest.raises(pdf.InputError, match="none: chromium ended"):
        pdf.write_pdf(page)
    assert re.findall("<details(?! open)", given[0]) == []
    assert given[0].count("<details open") == page.read_text(encoding="utf-8").count("<details") > 5


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
