"""The page of what has been checked: three questions, each figure with what it does not prove."""

from pathlib import Path

from reports.build_examples import COLUMNS, PARTS, write_checked
from reports.messages import ENGLISH
from reports.pages.page import write_report


def test_every_check_is_on_the_page_with_what_it_does_not_prove(tmp_path: Path) -> None:
    record = write_checked(tmp_path / "checked", ENGLISH.say)
    assert [each.name for each in record.tables] == list(PARTS)
    (said,) = record.answer.findings
    assert (said.code, said.values["checks"]) == ("checked", sum(len(each.rows) for each in record.tables))
    page = write_report(tmp_path / "checked").read_text(encoding="utf-8")
    for part in record.tables:
        for row in part.rows:
            assert len(row) == len(COLUMNS)
            assert str(row[COLUMNS.index("does_not_prove")]).replace("'", "&#39;") in page
