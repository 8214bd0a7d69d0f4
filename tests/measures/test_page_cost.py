"""The measurement of pages: what it prints stands in the record of changes, so that it must measure what it says."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from tests.measures import page_cost as bench_pages
from tests.reports.invented_run import write_invented


def test_without_a_browser_it_says_so_and_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(shutil, "which", lambda name: None)
    assert bench_pages.run([tmp_path]) == 1
    assert "no Chromium" in capsys.readouterr().err


@pytest.mark.browser
def test_it_writes_opens_and_times_a_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    try:
        with bench_pages.chromium():
            pass
    except bench_pages.NoBrowser as missing:
        pytest.skip(str(missing))
    folder = write_invented(tmp_path / "run", disagree=True, mesh=True)
    assert bench_pages.run([folder]) == 0
    said = capsys.readouterr().out.splitlines()
    assert (folder / "report.html").is_file()
    sizes, times = [], []
    for line in said[1:]:
        found = re.search(r"([\d.]+) MB, ready in ([\d.]+) to ([\d.]+) s$", line)
        assert found is not None, line
        sizes.append(float(found[1]))
        times.append((float(found[2]), float(found[3])))
    assert len(sizes) == 1
    assert sizes[0] == pytest.approx((folder / "report.html").stat().st_size / 1e6, abs=0.05)
    assert all(0.0 < best <= worst for best, worst in times)
