"""A study computes each distinct run once, goes on where it was killed, and ends in the same store."""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from harness import InputError, Scene, simulate
from harness.model import to_plain
from harness.questions.study import cases as selection
from harness.questions.study import study_run
from harness.questions.study.cases import BaseScene, base_of, expand, load_study, recheck
from harness.questions.study.study_record import study_rows
from harness.questions.study.study_run import Summary, run_study, study_name
from harness.records.study import impacts
from harness.runs.runner import Done, InlinePool, LocalPool, Pool, Work
from harness.runs.store import Packed, Store
from tests.harness.questions.study.small_study import STUDY, contents, written


def compute(path: Path, store_path: Path, pool: Pool | None = None) -> Summary:
    study = load_study(path)
    with Store(store_path) as store:
        return run_study(study, path, store, pool or InlinePool())


def test_runs_that_are_the_same_by_their_physics_are_computed_once(tmp_path: Path) -> None:
    path = written(tmp_path)
    first = compute(path, tmp_path / "s.sqlite")
    assert (first.cases, first.wanted, first.distinct, first.computed) == (60, 60, 30, 30)
    again = compute(path, tmp_path / "s.sqlite")
    assert (again.computed, again.found) == (0, 30)


def test_an_engine_that_is_named_twice_is_asked_once(tmp_path: Path) -> None:
    path = written(tmp_path, STUDY.replace('engines = ["analytic"]', 'engines = ["analytic", "analytic"]'))
    summary = compute(path, tmp_path / "s.sqlite")
    assert (summary.wanted, summary.computed) == (60, 30)


def test_an_accuracy_of_no_engine_names_its_key(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        load_study(written(tmp_path, STUDY + "[accuracy]\nfoo = 1e-3\n"))
    assert [each.key for each in caught.value.mistakes] == ["accuracy.foo"]


@pytest.mark.parametrize(
    ("ask", "key"),
    [
        ("margin = 0.1\n", "ask.margin"),
        ("audit = 0.2\n", "ask.audit"),
        ('cases = "adaptive"\nmargin = 0.1\n', "ask.margin"),
    ],
)
def test_what_would_choose_no_case_is_refused(tmp_path: Path, ask: str, key: str) -> None:
    with pytest.raises(InputError) as caught:
        load_study(written(tmp_path, f"{STUDY}[ask]\n{ask}"))
    assert [each.key for each in caught.value.mistakes] == [key]


def test_the_spacing_of_a_list_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        load_study(written(tmp_path, STUDY + '[[vary]]\nkey = "duration_s"\nvalues = [1.0]\nspacing = "log"\n'))
    assert [each.key.split(".")[-1] for each in caught.value.mistakes] == ["spacing"]


def test_the_store_does_not_depend_on_the_number_of_processes(tmp_path: Path) -> None:
    path = written(tmp_path)
    for name, jobs in (("one", 1), ("two", 2)):
        with closing(LocalPool(jobs)) as pool:
            compute(path, tmp_path / f"{name}.sqlite", pool)
    assert contents(tmp_path / "one.sqlite") == contents(tmp_path / "two.sqlite")


def test_only_cases_near_the_boundary_and_an_audit_are_sent(tmp_path: Path) -> None:
    text = STUDY.replace('engines = ["analytic"]', 'engines = ["analytic", "pymunk"]')
    text = text.replace("count = 6", "count = 4").replace("count = 5", "count = 2").replace("[0.85, 0.9]", "[0.85]")
    path = written(tmp_path, text + '[accuracy]\npymunk = 1e-2\n[ask]\ncases = "boundary"\naudit = 0.2\n')
    summary = compute(path, tmp_path / "s.sqlite")
    study = load_study(path)
    with Store(tmp_path / "s.sqlite") as store:
        rows = study_rows(store, study_name(study))
    sent = [row for row in rows if row.engine == "pymunk" and row.run is not None]
    left = [row for row in rows if row.engine == "pymunk" and row.run is None]
    assert summary.not_sent == len(left) > 0
    assert {row.reason for row in left} == {selection.NOT_SENT}
    assert {row.reason for row in sent} <= {selection.NEAR, selection.MARGIN, selection.RECHECK}
    assert selection.NEAR in {row.reason for row in sent}
    found = recheck(study, rows)
    assert found.audited == sum(row.reason == selection.RECHECK for row in sent)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('scene = "block.toml"', 'scene = "none.toml"', "readable TOML file"),
        ("motion.x.amplitude_g", "motion.x.amplitud_g", " amplitude_g"),
        ("start = 0.05", "", "start.* stop.* count"),
        ('engines = ["analytic"]', 'engines = ["analytical"]', "engines"),
        ('name = "own"', "", "name"),
        ("count = 6", "count = 0", "at least 1"),
    ],
)
def test_a_wrong_study_is_a_mistake_that_names_its_key(tmp_path: Path, old: str, new: str, message: str) -> None:
    path = written(tmp_path, STUDY.replace(old, new))
    with pytest.raises(InputError, match=message):
        compute(path, tmp_path / "s.sqlite")


class Inline(InlinePool):
    """Runs here, and counts what it is handed."""

    def __init__(self) -> None:
        self.tasks = 0

    def run(self, work: Work, tasks: Iterable[Any], done: Done) -> None:
        def counted(task: Any, answer: Any) -> None:
            self.tasks += 1
            done(task, answer)

        super().run(work, tasks, counted)


def test_the_work_around_a_run_is_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    resolved: list[int] = []
    written_: list[int] = []
    scene, add = BaseScene.scene, Store.add

    def counted(self: BaseScene, setting: Mapping[str, Any]) -> Scene:
        resolved.append(1)
        return scene(self, setting)

    def noted(self: Store, results: Sequence[Packed], clock_s: float = 0.0) -> None:
        written_.append(len(results))
        add(self, results, clock_s)

    monkeypatch.setattr(BaseScene, "scene", counted)
    monkeypatch.setattr(Store, "add", noted)
    path, pool = written(tmp_path, STUDY.replace("count = 6", "count = 20")), Inline()
    with Store(tmp_path / "s.sqlite") as store:
        done = run_study(load_study(path), path, store, pool)
    runs, cases = 100, 200
    assert done.computed == runs
    # A scene is resolved once for its name and once where it runs; a batch is one message and one transaction.
    assert len(resolved) == cases + runs
    assert written_ == [64, 36]
    assert pool.tasks == 2
    usage = vars(done.usage)
    assert usage["runs"] == runs
    assert 0.0 < usage["busy_s"] <= usage["wall_s"]
    assert 0.0 < usage["utilisation"] <= 1.0


def test_an_outcome_in_a_study_is_that_of_a_run_alone(tmp_path: Path) -> None:
    path = written(tmp_path)
    study = load_study(path)
    with Store(tmp_path / "s.sqlite") as store:
        run_study(study, path, store, Inline())
        rows = {row.number: row.run for row in store.rows(study_name(study))}
    base = base_of(study, path)
    for case in list(expand(study, base))[::7]:
        alone = to_plain(simulate(base.scene(case.setting), "analytic"))
        outcome = rows[case.number]
        assert outcome is not None
        # Only the list of events, the history and the check of the error differ.
        for name in ("outcome", "overturn_time_s", "no_return_time_s", "peak_slip_m"):
            assert outcome[name] == alone[name], (case.number, name)
        if alone["outcome"] == "stands":
            assert outcome["peak_theta_rad"] == alone["peak_theta_rad"]
            assert impacts(outcome) == impacts(alone)


def test_the_size_is_told_and_what_nobody_can_wait_for_is_refused(tmp_path: Path) -> None:
    text = STUDY.replace('engines = ["analytic"]', 'engines = ["analytic", "pybullet"]')
    path = written(tmp_path, text)
    study = load_study(path)
    base = base_of(study, path)
    assert study_run.told_size(study, study_run.study_cost(study, base, 2).cpu_s, 2, "study.toml").startswith(
        "60 cases, 120 runs: about "
    )
    huge = load_study(written(tmp_path, text.replace("count = 6", "count = 3000").replace("count = 5", "count = 3000")))
    with pytest.raises(InputError, match=r"^study.toml: vary: .* got 18000000 .* 36000000 .* 2.*--large"):
        study_run.told_size(huge, study_run.study_cost(huge, base, 2).cpu_s, 2, "study.toml")


def test_a_map_is_estimated_by_its_boundary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A step costs the same in both: what is compared is the number of steps, not two timings of a busy machine."""
    monkeypatch.setattr(study_run, "timed_step_s", lambda *_: 1e-4)
    text = STUDY.replace('engines = ["analytic"]', 'engines = ["pybullet"]').replace("count = 6", "count = 65")
    text = text.replace("count = 5", "count = 65")
    whole, along = (
        load_study(written(tmp_path, text + ask)) for ask in ("", '[ask]\ncases = "adaptive"\naudit = 0.01\n')
    )
    base = base_of(whole, tmp_path / "study.toml")
    assert study_run.study_cost(along, base, 1).cpu_s < 0.2 * study_run.study_cost(whole, base, 1).cpu_s


def test_a_forecast_counts_what_is_the_same_by_its_physics_once(tmp_path: Path) -> None:
    path = written(tmp_path)
    study = load_study(path)
    base = base_of(study, path)
    counted = sum(1.0 / study_run.alike(study, base, case, "analytic") for case in expand(study, base))
    assert counted == pytest.approx(compute(path, tmp_path / "s.sqlite").distinct)


def test_the_time_that_is_left_counts_runs_that_cost_something_once(tmp_path: Path) -> None:
    """Not the model's, which take next to nothing, nor what is the same by its physics: their rate would tell too little."""
    text = STUDY.replace('engines = ["analytic"]', 'engines = ["analytic", "pymunk"]').replace("count = 6", "count = 2")
    path = written(tmp_path, text.replace("count = 5", "count = 2"))
    study, heard = load_study(path), list[tuple[int, int]]()
    with Store(tmp_path / "s.sqlite") as store:
        done = run_study(study, path, store, InlinePool(), lambda *each: heard.append(each))
        distinct = len({row.key for row in store.rows(study_name(study)) if row.engine == "pymunk"})
    assert heard[0] == (0, distinct)
    assert heard[-1] == (distinct, distinct)
    assert done.computed > distinct
