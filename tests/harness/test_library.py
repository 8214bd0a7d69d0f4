"""The harness as a library: what it offers is seen, shows itself, and gives tables and pictures."""

from __future__ import annotations

import ast
import inspect
import json
import pickle
import subprocess
import sys
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

import harness
from harness.model.history import Outcome
from harness.model.shown import Shown
from harness.records.study import CaseRun, StudyRecord, StudyRow

REFERENCE = ("analytic", "analytic.closed_form", "analytic.pulse_response", "meshes", "harness")
"""What `make docs` documents."""


@pytest.fixture(scope="module")
def scene(root: Path) -> harness.Scene:
    return harness.load_scene(root / "scenes/free_rocking.toml", duration_s=1.0)


@pytest.fixture(scope="module")
def run(scene: harness.Scene) -> harness.Run:
    return harness.simulate(scene, "analytic")


def public(module: ModuleType) -> list[str]:
    """The public names of a module: those it lists, else those it defines."""
    own = [name for name, item in vars(module).items() if getattr(item, "__module__", None) == module.__name__]
    return list(getattr(module, "__all__", None) or [name for name in own if not name.startswith("_")])


@pytest.mark.parametrize("package", ["harness", "analytic", "meshes"])
def test_a_fresh_package_shows_its_names(package: str, root: Path) -> None:
    code = f"import {package}, json; print(json.dumps([dir({package}), list({package}.__all__)]))"
    shown, offered = json.loads(
        subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, check=True).stdout
    )
    assert len(offered) >= 4
    assert set(offered) <= set(shown)


def test_every_name_of_the_harness_has_a_home() -> None:
    assert set(harness.__all__) == set(harness._HOMES)
    assert all(getattr(harness, name).__module__ == home for name, home in harness._HOMES.items())


@pytest.mark.parametrize("name", REFERENCE)
def test_every_public_name_says_what_it_is(name: str) -> None:
    module = import_module(name)
    names = public(module)
    assert names
    items = {each: getattr(module, each) for each in names}
    undocumented = [each for each, item in items.items() if callable(item) and not _said(item)]
    undocumented += [
        f"{each}.{method}"
        for each, item in items.items() if inspect.isclass(item)
        for method, body in vars(item).items()
        if not method.startswith("_") and (callable(body) or isinstance(body, property)) and not (body.__doc__ or "").strip()
    ]  # fmt: skip
    assert not undocumented, f"{name}: without a docstring: {', '.join(undocumented)}"


def _said(item: object) -> bool:
    text = (getattr(item, "__doc__", None) or "").strip()
    # A dataclass without a docstring is given its signature for one.
    return bool(text) and not text.startswith(f"{getattr(item, '__name__', '')}(")


def test_the_reference_lists_every_public_name(tmp_path: Path, root: Path) -> None:
    pytest.importorskip("pdoc", reason="pdoc (the extra [dev]) is not installed")
    said = subprocess.run(
        [sys.executable, "-m", "pdoc", "--output-directory", str(tmp_path), *REFERENCE],
        cwd=root,
        capture_output=True,
        text=True,
    )
    assert said.returncode == 0, said.stderr
    assert f"pdoc --output-directory out/api {' '.join(REFERENCE)}" in (root / "Makefile").read_text(encoding="utf-8")
    for name in REFERENCE:
        page = (tmp_path / f"{name.replace('.', '/')}.html").read_text(encoding="utf-8")
        missing = [each for each in public(import_module(name)) if f'id="{each}"' not in page]
        assert not missing, f"{name}: not in the reference: {', '.join(missing)}"
        assert 'src="http' not in page
        assert "@import" not in page


@pytest.mark.parametrize("package", ["analytic", "harness", "meshes", "reports"])
def test_packages_say_that_they_are_typed(package: str, root: Path) -> None:
    assert (root / package / "py.typed").is_file()
    assert '"*" = ["py.typed"]' in (root / "pyproject.toml").read_text(encoding="utf-8")


def test_keys_are_replaced_as_keywords_as_a_mapping_and_as_texts(root: Path) -> None:
    file = root / "scenes/paestum_floor.toml"
    ways = (
        harness.load_scene(file, motion__x__amplitude_g=0.4),
        harness.load_scene(file, **{"motion.x.amplitude_g": 0.4}),
        harness.load_scene(file, {"motion.x.amplitude_g": 0.4}),
        harness.load_scene(file, ["motion.x.amplitude_g=0.4"]),
    )
    assert {way.base_excitation.x.peak_m_s2 for way in ways} == {0.4 * ways[0].gravity_m_s2}
    said = r"^keyword motion__x__amplitud_g: motion.x.amplitud_g: .*did you mean amplitude_g"
    with pytest.raises(harness.InputError, match=said):
        harness.load_scene(file, motion__x__amplitud_g=0.4)
    with pytest.raises(harness.InputError, match=r"^overrides: duration_s: wanted a number"):
        harness.load_scene(file, {"duration_s": "x"})


def test_a_run_of_a_changed_scene_is_the_run_of_the_scene_so_loaded(scene: harness.Scene, run: harness.Run) -> None:
    assert scene.source is not None
    loaded = harness.load_scene(scene.source, duration_s=1.0, contact__restitution=0.8)
    wanted = harness.simulate(loaded, "analytic")
    for changed in ({"overrides": {"contact.restitution": 0.8}}, {"contact__restitution": 0.8}):
        got = harness.simulate(scene, "analytic", **changed)
        assert got.impact_times_s == wanted.impact_times_s
    assert wanted.impact_times_s != run.impact_times_s
    with pytest.raises(harness.InputError, match="unknown key"):
        harness.simulate(scene, "analytic", acuracy_rad=1e-3)
    with pytest.raises(harness.InputError, match="a scene that was loaded"):
        harness.simulate(replace(scene, given={}), "analytic", title="other")


def shown(scene: harness.Scene, run: harness.Run) -> list[Shown]:
    assert run.history is not None
    return [scene, run, run.history, harness.compare(run, run, scene=scene), study()]


def study(axes: int = 2) -> StudyRecord:
    """Four cases of one model: what a study keeps, the rest left out."""
    keys = ("a_g", "f_hz")[:axes]
    cases = [dict(zip(keys, values, strict=False)) for values in ((0.1, 1.0), (0.2, 1.0), (0.1, 2.0), (0.2, 2.0))]
    rows = [
        StudyRow(number=k, engine="analytic", reason="asked", varied=dict(case), run=case_run(k == 1))
        for k, case in enumerate(cases[: 2**axes])
    ]
    absent = StudyRow(number=9, engine="pymunk", reason="cannot", varied=dict(cases[0]), run=None)
    head = dict.fromkeys(inspect.signature(StudyRecord).parameters) | {"schema_version": 1, "kind": "study"}
    return StudyRecord(**head | {"title": "four <cases>", "vary": {}, "rows": [*rows, absent]})  # type: ignore[arg-type]


def case_run(falls: bool) -> CaseRun:
    outcome = Outcome.OVERTURNED_LEFT if falls else Outcome.STANDS
    given = dict.fromkeys(inspect.signature(CaseRun).parameters)
    return CaseRun(**given | {"outcome": outcome, "peak_theta_rad": -1.5 if falls else 0.1, "impacts": 3})  # type: ignore[arg-type]


def test_all_show_themselves_shortly_and_without_markup_of_their_own(scene: harness.Scene, run: harness.Run) -> None:
    for each in shown(scene, run):
        line, page = repr(each), each._repr_html_()
        assert line.startswith(f"<{type(each).__name__} ")
        assert len(line) < 400, line
        assert page.count("<tr>") == len(each.facts()) >= 3
        assert "<cases>" not in page
    assert "four &lt;cases&gt;" in study()._repr_html_()
    assert run.outcome.sentence in repr(run)
    assert study().facts()["analytic"] == "overturns in 1 of 4"


def test_tables_hold_what_the_result_holds(scene: harness.Scene, run: harness.Run) -> None:
    pytest.importorskip("pandas", reason="pandas (the extra [frames]) is not installed")
    assert run.history is not None
    frame = run.to_dataframe()
    assert frame.index.name == "t_s"
    assert (frame["theta_rad"].to_numpy() == run.history.theta_rad).all()
    scores = harness.compare(run, run, scene=scene).to_dataframe()
    assert scores.loc["peak_ratio", "value"] == 1.0
    assert "verdict" not in scores.index
    rows = study().to_dataframe()
    assert list(rows["outcome"].dropna()) == ["stands", "overturned_left", "stands", "stands"]
    assert list(rows["a_g"]) == [0.1, 0.2, 0.1, 0.2, 0.1]
    assert len(scene.to_dataframe()) > 0


def test_datasets_hold_the_same(scene: harness.Scene, run: harness.Run) -> None:
    pytest.importorskip("xarray", reason="xarray (the extra [frames]) is not installed")
    for each in shown(scene, run):
        columns = dict(each.columns())
        dataset = each.to_xarray()
        assert [*dataset.coords, *dataset.data_vars] == list(columns)
        assert set(dataset.sizes) == {next(iter(columns))}


@pytest.mark.parametrize("name", ["pandas", "xarray"])
def test_without_its_library_a_table_names_the_extra(
    name: str, run: harness.Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(harness.InputError, match=rf"{name}, of the extra \[frames\]"):
        run.to_dataframe() if name == "pandas" else run.to_xarray()


def test_pictures_are_drawn_on_the_axes_given(scene: harness.Scene, run: harness.Run) -> None:
    from matplotlib.figure import Figure

    for each in [*shown(scene, run), study(axes=1)]:
        ax = Figure().subplots()
        assert each.plot(ax) is ax
        assert ax.get_xlabel()
    ax = run.plot(Figure().subplots(), linestyle=":")
    assert ax.lines[0].get_label() == "analytic"
    assert run.history is not None
    assert (ax.lines[0].get_ydata() == run.history.theta_rad).all()
    assert [line.get_label() for line in study().plot(Figure().subplots()).collections] == [
        "analytic does not overturn",
        "analytic overturns",
    ]


def test_a_run_without_a_history_and_a_study_without_numbers_say_so(scene: harness.Scene) -> None:
    outcome = harness.simulate(scene, "analytic", options=harness.RunOptions(history=False))
    with pytest.raises(harness.InputError, match="a run with its history"):
        outcome.plot()
    with pytest.raises(harness.InputError, match="a number that varies"):
        study(axes=0).plot()


def test_what_shows_itself_travels_between_processes(run: harness.Run) -> None:
    again = pickle.loads(pickle.dumps(run))
    assert repr(again) == repr(run)


def test_the_example_notebook_runs(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("pandas", "xarray"):
        pytest.importorskip(name, reason=f"{name} (the extra [frames]) is not installed")
    pytest.importorskip("matplotlib").use("Agg")
    monkeypatch.chdir(root)
    notebook = json.loads((root / "docs/example.ipynb").read_text(encoding="utf-8"))
    assert notebook["nbformat"] == 4
    cells = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    names: dict[str, object] = {}
    for cell in cells:
        tree = ast.parse(cell)
        last = tree.body[-1]
        exec(compile(ast.Module(tree.body[:-1], []), "example", "exec"), names)
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), "example", "eval"), names)
            assert value is not None, f"a cell shows nothing: {cell}"
        else:
            exec(compile(ast.Module([last], []), "example", "exec"), names)
    assert len(cells) >= 6
    assert isinstance(names["scores"], harness.Scores)


def test_tab_completion_shows_the_library_and_nothing_else() -> None:
    assert [name for name in dir(harness) if not name.startswith("_")] == harness.__all__
