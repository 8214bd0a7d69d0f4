"""The harness as a library: what it offers is seen, shows itself, and gives tables and pictures."""

import ast
import doctest
import inspect
import json
import pickle
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
import tomli_w
import trimesh

import harness
from analytic.excitation import Harmonic
from harness import Outcome, engines, model
from harness.model import BaseExcitation, RunSet, Shown, column_of
from harness.questions.scene.scene_run import write_result
from harness.records.study import CaseRun, StudyRecord, StudyRow
from harness.runs.task import scene_key
from tests import budgets

REFERENCE = ("analytic", "analytic.closed_form", "analytic.pulse_response", "meshes", "harness")
"""What `make docs` documents."""


@pytest.fixture(scope="module")
def scene(root: Path) -> harness.Scene:
    return harness.load_scene(root / "scenes/free_rocking.toml", {"duration_s": 1.0})


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
    for name, home in harness._HOMES.items():
        assert getattr(harness, name).__module__ in (home, f"{home}.{model._HOMES.get(name)}")


def test_every_noun_has_a_home() -> None:
    assert set(model.__all__) == set(model._HOMES)
    homes = {name: import_module(f"harness.model.{home}") for name, home in model._HOMES.items()}
    assert all(getattr(model, name) is getattr(home, name) for name, home in homes.items())
    with pytest.raises(AttributeError, match="no attribute 'absent'"):
        _ = model.absent


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
    loaded = harness.load_scene(file)
    ways = (
        harness.load_scene(file, {"motion.x.amplitude_g": np.float32(0.4)}),
        harness.load_scene(file, ["motion.x.amplitude_g=0.4"]),
        loaded.replace(motion__x__amplitude_g=0.4),
        loaded.replace({"motion.x.amplitude_g": 0.4}),
    )
    assert [way.base_excitation.x.peak_m_s2 for way in ways] == pytest.approx([0.4 * loaded.gravity_m_s2] * 4)
    assert loaded.replace(uncertainty=None).uncertainty == ()
    said = r"^keyword motion__x__amplitud_g: motion.x.amplitud_g: .* amplitude_g\?$"
    with pytest.raises(harness.InputError, match=said):
        loaded.replace(motion__x__amplitud_g=0.4)
    with pytest.raises(harness.InputError, match=r"^overrides: duration_s: .*'x'$"):
        harness.load_scene(file, {"duration_s": "x"})


def test_a_run_of_a_changed_scene_is_the_run_of_the_scene_so_loaded(scene: harness.Scene, run: harness.Run) -> None:
    assert scene.source is not None
    changed = {"contact.restitution": 0.8}
    wanted = harness.simulate(harness.load_scene(scene.source, {"duration_s": 1.0, **changed}), "analytic")
    for got in (
        harness.simulate(scene, "analytic", overrides=changed),
        harness.simulate(scene.replace(changed), "analytic"),
    ):
        assert got.impact_times_s == wanted.impact_times_s
    assert wanted.impact_times_s != run.impact_times_s
    with pytest.raises(harness.InputError, match=r"replace: .*dataclasses\.replace"):
        replace(scene, _reader=None).replace(title="other")


TABLES: dict[str, Any] = {
    "title": "a block",
    "duration_s": 2.0,
    "statue": dict(
        zip(
            ("mass_kg", "centroid_height_m", "corner_left_m", "corner_right_m", "inertia_kg_m2"),
            (500.0, 0.5, 0.1, 0.1, 43.3),
            strict=True,
        )
    ),
    "motion": {"x": {"kind": "harmonic", "amplitude_g": np.float64(0.3), "frequency_hz": np.int64(2)}},
    "pedestal": None,
}


def test_a_scene_of_a_mapping_is_that_of_the_file(tmp_path: Path) -> None:
    made = harness.scene(TABLES)
    file = tmp_path / "scene.toml"
    file.write_text(tomli_w.dumps(made.given))
    loaded = harness.load_scene(file)
    assert (made.source, made.given) == (None, loaded.given)
    engine = engines.load("pybullet")
    assert scene_key(made, engine.capabilities) == scene_key(loaded, engine.capabilities)
    assert made.replace(duration_s=1).duration_s == 1.0


@pytest.mark.parametrize(
    ("call", "where", "key"),
    [
        (lambda: harness.scene({}), "scene", "title"),
        (lambda: harness.scene("scene.toml"), "scene", "mapping"),
        (lambda: harness.scene({**TABLES, "motion": {"x": {"kind": "samples", "dt_s": 0.01}}}), "scene", "motion.x.accel_m_s2"),
        (lambda: harness.load_scene({}), "load_scene", "path"),
        (lambda: harness.scene(TABLES).with_motion([0.0, np.nan], 0.01), "with_motion", "accel_m_s2"),
        (lambda: harness.scene(TABLES).with_motion(np.zeros((2, 2)), 0.01), "with_motion", "accel_m_s2"),
        (lambda: harness.scene(TABLES).with_motion([0.0, 1.0], 0.0), "with_motion", "dt_s"),
        (lambda: harness.scene(TABLES).with_motion([0.0, 1.0], 0.1, "w"), "with_motion", "axis"),
        (lambda: harness.sweep(harness.scene(TABLES), {}), "sweep", "values"),
        (lambda: harness.sweep(harness.scene(TABLES), {"motion.x.amplitude_g": 0.3}), "sweep", "motion.x.amplitude_g"),
        (lambda: harness.read_mesh("absent.ply"), "absent.ply", ""),
        (lambda: harness.read_mesh("absent.ply", density_kg_m3=-1.0), "read_mesh", "density_kg_m3"),
        (lambda: harness.History.from_arrays([0.0, 0.0], [0.0, 0.0]), "from_arrays", "t_s"),
        (lambda: harness.History.from_arrays([0.0, 1.0], [0.0]), "from_arrays", "theta_rad"),
    ],
)  # fmt: skip
def test_mistakes_of_a_call_are_named(call: Callable[[], object], where: str, key: str) -> None:
    with pytest.raises(harness.InputError) as caught:
        call()
    assert (caught.value.mistakes[0].where, caught.value.mistakes[0].key) == (where, key)


def test_files_of_no_scene_file_are_looked_for_from_here(
    root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(root / "scenes")
    made = harness.scene({**TABLES, "statue": {"mesh": {"file": "togatus.ply", "density_kg_m3": 2700.0}}})
    monkeypatch.chdir(tmp_path)
    assert made.replace(duration_s=1.0).statue.mass_kg == made.statue.mass_kg


def test_an_own_array_is_a_motion_of_the_scene(tmp_path: Path) -> None:
    """As it is, though the scene's file multiplies all its axes; in the record, and in another process."""
    t_s = np.arange(0.0, 1.0, 0.005)
    own = 4.0 * np.sin(12.0 * t_s)
    base = harness.scene({**TABLES, "motion": {**TABLES["motion"], "scale": 2.5}, "uncertainty": UNKNOWN})
    made = base.with_motion(own, dt_s=0.005)
    assert np.max(np.abs(made.base_excitation.x.accel_m_s2(t_s) - own)) < budgets.OWN_MOTION_REL * np.max(own)
    assert [item.key for item in made.uncertainty] == ["statue.mass_kg"]
    sent = pickle.loads(pickle.dumps(made))
    assert sent.replace(motion__scale=5.0).base_excitation.x.peak_m_s2 == pytest.approx(2.0 * np.max(np.abs(own)))
    run = harness.simulate(made, "analytic")
    written = write_result(harness.run_scene(made, ["analytic"]), tmp_path)
    toml = json.loads(written.read_text())["scene"]["toml"]
    assert harness.simulate(harness.scene(toml), "analytic").peak_theta_rad == run.peak_theta_rad


UNKNOWN = {
    "motion.x.amplitude_g": {"kind": "lognormal", "cov": 0.1},
    "statue.mass_kg": {"kind": "lognormal", "cov": 0.1},
}


def test_a_sweep_s_rows_are_single_runs() -> None:
    made, outcome = harness.scene(TABLES), harness.RunOptions(history=False)
    values = {"motion.x.amplitude_g": np.array([0.2, 0.6]), "statue.mass_kg": (400, 500.0)}
    runs = harness.sweep(made, values)
    rows = runs.columns()
    assert [*zip(rows["motion.x.amplitude_g"], rows["statue.mass_kg"], strict=True)] == [
        (0.2, 400.0), (0.2, 500.0), (0.6, 400.0), (0.6, 500.0)
    ]  # fmt: skip
    for k in range(len(runs)):
        changed = {key: rows[key][k] for key in values}
        run = harness.simulate(made.replace(changed), "analytic", options=outcome)
        assert (rows["outcome"][k], rows["overturned"][k]) == (run.outcome.value, run.outcome.overturned)
        assert (rows["peak_theta_rad"][k], rows["steps"][k]) == (abs(run.peak_theta_rad), run.steps)
    other = harness.sweep(made, {"motion.x.amplitude_g": [0.6]}, "pymunk", accuracy_rad=1e-2)
    assert list(other.columns()) == list(harness.sweep(made, {"motion.x.amplitude_g": [0.6]}).columns())
    assert other.table["outcome"].tolist() == [runs.table["outcome"][3]]


def test_a_set_of_runs_is_chosen_from_arranged_and_paired() -> None:
    runs = study().run_set()
    assert runs.where({"engine": "analytic", "a_g": 0.2}).table["outcome"].tolist() == ["overturned_left", "stands"]
    rows, columns, outcomes = runs.where({"engine": "analytic"}).pivot("a_g", "f_hz")
    assert (rows.tolist(), columns.tolist()) == ([0.1, 0.2], [1.0, 2.0])
    assert outcomes.tolist() == [["stands", "stands"], ["overturned_left", "stands"]]
    assert [len(some) for some in runs.pairs()["pymunk"]] == [0, 0], "what was not run is no pair"
    both = replace(runs, table={**runs.table, "outcome": column_of(["stands"] * 5)})
    mine, model = both.pairs()["pymunk"]
    assert (mine.engines, model.engines) == (["pymunk"], ["analytic"])
    assert mine.table["a_g"].tolist() == model.table["a_g"].tolist() == [0.1]
    with pytest.raises(harness.InputError, match="no_such"):
        runs.where({"no_such": 1})


def test_what_varies_in_a_set_of_runs_may_be_lists_and_words() -> None:
    table = {"a": column_of([[1], [2], [1], [2]]), "b": column_of(["keep", "keep", 2.0, 2.0])}
    said = {"engine": column_of(["analytic"] * 4), "outcome": column_of(["stands", "overturned_left", "stands", None])}
    runs = RunSet("lists", ["a", "b"], table | said)
    assert runs.facts()["varied"] == "a (2), b (2)"
    rows, columns, outcomes = runs.pivot("a", "b")
    assert (rows.tolist(), columns.tolist()) == ([[1], [2]], ["keep", 2.0])
    assert outcomes.tolist() == [["stands", "stands"], ["overturned_left", None]]
    assert runs.pairs() == {}


def test_a_set_of_runs_is_an_arrow_table() -> None:
    pytest.importorskip("pyarrow", reason="needs the extra [parquet]")
    table = study().run_set().to_arrow()
    assert table.column("outcome").to_pylist() == ["stands", "overturned_left", "stands", "stands", None]


def test_a_mesh_that_is_not_clean_has_mass_properties_and_doubts(tmp_path: Path) -> None:
    box = trimesh.creation.box((0.4, 0.3, 1.2))
    box.apply_translation((1.0, 2.0, 0.6))
    for name, mesh in {"whole": box, "open": open_box(box), "wound": wound_box(box)}.items():
        mesh.export(tmp_path / f"{name}.ply")
        found = harness.read_mesh(tmp_path / f"{name}.ply", density_kg_m3=1000.0)
        assert (found.solid is not None, not found.doubts) == (name == "whole", name == "whole")
        assert (name == "wound") == ("prepared_wound" in [doubt.code for doubt in found.doubts])
        assert found.mass_kg == pytest.approx(144.0, rel=budgets.HOLED_REL)
        assert found.centroid_m == pytest.approx((1.0, 2.0, 0.6), rel=budgets.HOLED_REL)
        assert found.inertia_kg_m2[1, 1] == pytest.approx(144.0 * (0.4**2 + 1.2**2) / 12.0, rel=budgets.HOLED_REL)
    assert harness.read_mesh(tmp_path / "whole.ply", unit="dm").mass_kg == pytest.approx(2700.0 * 0.144e-3, rel=1e-6)


def open_box(box: trimesh.Trimesh) -> trimesh.Trimesh:
    """Without one triangle of a flat side, which a cone closes as it was."""
    return trimesh.Trimesh(box.vertices, box.faces[1:], process=False)


def wound_box(box: trimesh.Trimesh) -> trimesh.Trimesh:
    """With one triangle the other way round."""
    return trimesh.Trimesh(box.vertices, np.vstack([box.faces[:1, ::-1], box.faces[1:]]), process=False)


def test_a_history_of_arrays_has_its_rates() -> None:
    t_s = np.linspace(0.0, 1.0, 201)
    found = harness.History.from_arrays(t_s.tolist(), (0.1 * t_s**2).tolist(), slip_m=0.5 * t_s)
    # Differences of second order are exact for a parabola, at both ends too.
    assert found.theta_rate_rad_s == pytest.approx(0.2 * t_s, abs=budgets.DIFFERENCED)
    assert found.slip_rate_m_s == pytest.approx(0.5, abs=budgets.DIFFERENCED)
    assert harness.History.from_arrays([0.0, 1.0], [0.0, 0.1]).slip_m.tolist() == [0.0, 0.0]


def test_every_docstring_s_call_runs(root: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What the docstrings of the library show, in one session: `dir(harness)`, its functions, the methods that make a scene."""
    made = harness.scene(TABLES)
    reference = harness.simulate(made, "analytic")
    (tmp_path / "scenes").symlink_to(root / "scenes")
    monkeypatch.chdir(tmp_path)
    assert reference.history is not None
    for name in ("mine.csv", "theirs.csv"):
        reference.history.write_csv(tmp_path / name)
    write_result(harness.run_scene(made, ["analytic"]), tmp_path / "out" / "paestum_floor")
    functions = [getattr(harness, name) for name in harness.__all__ if inspect.isfunction(getattr(harness, name))]
    assert len(functions) >= 11
    methods = [harness.Scene.replace, harness.Scene.with_motion, harness.History.from_arrays]
    for function in (*functions, *methods):
        examples = doctest.DocTestParser().get_examples(function.__doc__)
        assert examples, f"{function.__name__}: its docstring shows no call"
        names = {"harness": harness, "np": np, "scene": made, "run": reference, "reference": reference}
        for example in examples:
            exec(example.source, names)


@pytest.mark.parametrize("package", ["harness", "analytic", "analytic.spatial", "meshes"])
def test_no_public_function_hides_its_options(package: str) -> None:
    module = import_module(package)
    items = [item for name, item in inspect.getmembers(module) if not name.startswith("_")]
    items += [getattr(module, name) for name in getattr(module, "__all__", ())]
    assert any(map(inspect.isfunction, items))
    hidden = [
        item.__name__ for item in items if inspect.isfunction(item)
        if any(each.kind is each.VAR_KEYWORD for each in inspect.signature(item).parameters.values())
    ]  # fmt: skip
    assert not hidden


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
        assert page.count("<tr>") == len(each.facts()) >= 2
        assert "<cases>" not in page
    assert "four &lt;cases&gt;" in study()._repr_html_()
    assert run.outcome.value in repr(run)
    assert study().facts()["analytic"] == "overturns in 1 of 4"


def test_tables_hold_what_the_result_holds(scene: harness.Scene, run: harness.Run) -> None:
    pytest.importorskip("pandas", reason="pandas (the extra [frames]) is not installed")
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
    with pytest.raises(harness.InputError, match=rf"{name}, .*\[frames\]"):
        run.to_dataframe() if name == "pandas" else run.to_xarray()


def test_pictures_are_drawn_on_the_axes_given(scene: harness.Scene, run: harness.Run) -> None:
    from matplotlib.figure import Figure

    for each in [*shown(scene, run), study(axes=1)]:
        ax = Figure().subplots()
        assert each.plot(ax) is ax
        assert ax.get_xlabel()
    ax = run.plot(Figure().subplots(), linestyle=":")
    assert ax.lines[0].get_label() == "analytic"
    assert (ax.lines[0].get_ydata() == run.history.theta_rad).all()
    assert [line.get_label() for line in study().plot(Figure().subplots()).collections] == [
        "analytic does not overturn",
        "analytic overturns",
    ]


def test_a_run_without_a_history_and_a_study_without_numbers_say_so(scene: harness.Scene) -> None:
    outcome = harness.simulate(scene, "analytic", options=harness.RunOptions(history=False))
    with pytest.raises(harness.InputError, match=r"^run of analytic: history: "):
        outcome.plot()
    with pytest.raises(harness.InputError, match=": vary: "):
        study(axes=0).plot()


def test_what_shows_itself_travels_between_processes(run: harness.Run) -> None:
    again = pickle.loads(pickle.dumps(run))
    assert repr(again) == repr(run)


@pytest.mark.parametrize("call", ["simulate", "run_scene", "assess", "sweep"])
def test_a_path_is_no_scene_and_how_to_read_it_is_told(call: str) -> None:
    more = {"simulate": ["analytic"], "sweep": [{"duration_s": [1.0]}]}.get(call, [])
    with pytest.raises(harness.InputError, match="load_scene"):
        getattr(harness, call)("scene.toml", *more)


def test_a_mistake_that_a_worker_found_reads_as_it_was_said(scene: harness.Scene) -> None:
    with pytest.raises(harness.InputError) as caught:
        scene.replace(foo=1)
    again = pickle.loads(pickle.dumps(caught.value))
    assert (str(again), again.mistakes) == (str(caught.value), caught.value.mistakes)


def test_a_motion_of_ones_own_class_is_refused_and_not_taken_for_what_it_derives_from() -> None:
    class Louder(Harmonic):
        def accel_m_s2(self, t_s: Any) -> Any:
            return 2.0 * super().accel_m_s2(t_s)

    with pytest.raises(harness.InputError, match="with_motion") as caught:
        BaseExcitation(x=Louder(1.0, 2.0))
    assert [(each.key, each.got) for each in caught.value.mistakes] == [("x", "Louder")]


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
    assert len(cells) == 10
    assert max(len(cell.replace("\n\n", "\n").splitlines()) for cell in cells) <= 5
    assert isinstance(names["scores"], harness.Scores)
    assert len(names["frame"]) == 100  # type: ignore[arg-type]


def test_tab_completion_shows_the_library_and_nothing_else() -> None:
    assert [name for name in dir(harness) if not name.startswith("_")] == harness.__all__
