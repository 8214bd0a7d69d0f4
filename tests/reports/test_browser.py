"""The pages as a person meets them: opened from disk in a browser, at a desk and on a telephone."""

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from harness import load_scene
from harness.questions.scene.scene_run import run_scene, write_result
from reports.messages import ENGLISH
from reports.pages.page import write_report
from tests.budgets_reports import DRAWN_SHARE, FRAME_MS

pytestmark = pytest.mark.browser

SIZES = {"desk": {"width": 1280, "height": 900}, "phone": {"width": 390, "height": 844}}
SOFTWARE_WEBGL = "GPU stall due to ReadPixels"
"""A remark of Chromium's software renderer on itself, which stands in for a graphics card here."""


NAMELESS = """
[...document.querySelectorAll('button, select, input, [role=img], svg[role]')].filter((item) =>
  !(item.textContent.trim() || item.closest('label')
    || item.getAttribute('aria-label') || item.getAttribute('aria-labelledby')))
  .map((item) => item.outerHTML.slice(0, 80))
"""


@dataclass
class Visit:
    """An open page and what it said and asked for."""

    page: Any
    said: list[str] = field(default_factory=list)
    asked: list[str] = field(default_factory=list)


@pytest.fixture(scope="module")
def visit(browser: Any, page_of: Callable[[str], Path]) -> Iterator[Callable[[str, str], Visit]]:
    """Opens a page once for all tests of one size, and brings it back to its beginning."""
    known: dict[tuple[str, str], Visit] = {}

    def opened(name: str, size: str) -> Visit:
        if (name, size) not in known:
            context = browser.new_context(viewport=SIZES[size], has_touch=size == "phone")
            found = known[name, size] = Visit(context.new_page())
            found.page.on("console", lambda message: found.said.append(message.text))
            found.page.on("pageerror", lambda error: found.said.append(str(error)))
            found.page.on("request", lambda request: found.asked.append(request.url))
            found.page.goto(page_of(name).as_uri())
            if not name.startswith("plain"):
                found.page.wait_for_selector("html[data-ready=yes]", timeout=60_000)
        page = known[name, size].page
        if name == "run":
            page.evaluate("rockcheck.replay.setPlaying(false); rockcheck.setTime(0)")
            page.locator("[data-for=histories][data-do=all]").click()
        return known[name, size]

    yield opened
    for found in known.values():
        found.page.context.close()


def plot_of(page: Any, name: str = "histories") -> dict[str, float]:
    """The first pair of axes of a chart on the screen."""
    box: dict[str, float] = page.evaluate(f"rockcheck.charts['{name}'].plots()[0].toJSON()")
    return box


def errors(found: Visit) -> list[str]:
    return [text for text in found.said if SOFTWARE_WEBGL not in text]


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", ["run", "table", "map", "plain run", "plain table", "plain map"])
def test_it_opens_without_an_error_a_request_or_sideways_scrolling(
    visit: Callable[[str, str], Visit], page_of: Callable[[str], Path], name: str, size: str
) -> None:
    found = visit(name, size)
    found.page.evaluate("window.scrollTo(0, document.body.scrollHeight)")
    assert errors(found) == []
    local = [url for url in found.asked if url.startswith(("data:", "blob:"))]
    assert [url for url in found.asked if url not in local] == [page_of(name).as_uri()]
    assert found.page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    assert found.page.locator(".wait").count() == 0


def test_long_tables_are_folded_on_a_telephone_and_open_at_a_desk(visit: Callable[[str, str], Visit]) -> None:
    closed = "document.querySelectorAll('details.fold:not([open])').length"
    desk, phone = visit("run", "desk").page, visit("run", "phone").page
    assert desk.evaluate(closed) == 0
    assert not desk.locator(".fold > summary:visible").count()
    assert desk.locator("#outcomes table").is_visible()
    folds = phone.evaluate(closed)
    assert folds == phone.locator(".fold > summary:visible").count() >= 2
    assert not phone.locator("#outcomes table").is_visible()
    phone.locator("nav a[href='#outcomes']").click()
    assert phone.locator("#outcomes table").is_visible()
    assert phone.locator("#outcomes caption").bounding_box()["width"] < SIZES["phone"]["width"]
    assert phone.evaluate(closed) == folds - 1
    phone.locator("#outcomes .fold > summary").click()
    assert phone.evaluate(closed) == folds


def test_answer_leans_and_replay_are_on_the_first_screen(visit: Callable[[str, str], Visit]) -> None:
    page = visit("run", "desk").page
    page.set_viewport_size({"width": 1280, "height": 800})
    for selector in ("#verdict-title", ".lean", "[data-replay=play]"):
        box = page.locator(selector).first.bounding_box()
        assert box["y"] + box["height"] <= 800, selector


def test_the_replay_plays_and_moves_only_a_transform(visit: Callable[[str, str], Visit]) -> None:
    page = visit("run", "desk").page
    page.evaluate("Object.assign(rockcheck.replay.stats, { frames: 0, script_ms: 0, worst_ms: 0 })")
    uploaded = "rockcheck.replay.figures.get('pybullet').body.geometry.attributes.position.version"
    before = page.evaluate(uploaded)
    page.locator("[data-replay=play]").click()
    page.wait_for_function("rockcheck.replay.stats.frames > 5", timeout=30_000)
    stats = page.evaluate("rockcheck.replay.stats")
    assert page.evaluate("rockcheck.time") > 0.0
    assert page.evaluate(uploaded) == before
    assert stats["script_ms"] / stats["frames"] <= FRAME_MS
    page.locator("[data-replay=play]").click()
    assert page.evaluate("rockcheck.replay.isPlaying()") is False


def test_the_drawn_pose_is_the_recorded_rotation(visit: Callable[[str, str], Visit]) -> None:
    page = visit("run", "desk").page
    page.evaluate("rockcheck.setTime(2.2)")
    drawn = page.evaluate("rockcheck.replay.figures.get('analytic').tilt.rotation.y")
    told = page.locator("[data-theta=analytic]").inner_text()
    assert f"{abs(drawn):.4f} rad" in told
    corner_z = page.evaluate("rockcheck.replay.figures.get('analytic').tilt.position.z")
    assert (corner_z > 0.2 + 1e-6) == (drawn < 0), "θ < 0 turns about the left corner, which lifts the right one"


def test_slider_and_cursor_follow_one_clock(visit: Callable[[str, str], Visit]) -> None:
    page = visit("run", "desk").page
    page.locator("#replay input[type=range]").fill("5")
    assert page.evaluate("rockcheck.time") == pytest.approx(5.0)
    cursor, plot = (
        page.locator(".cursor").bounding_box(),
        plot_of(page),
    )
    assert cursor["x"] == pytest.approx(plot["x"] + 0.5 * plot["width"], abs=3.0)
    page.locator("[data-for=histories][data-do=in]").click()
    page.locator("[data-for=histories][data-do=later]").click()
    page.wait_for_timeout(100)
    assert page.locator(".cursor").bounding_box()["x"] == pytest.approx(plot["x"], abs=3.0)


def test_the_histories_zoom_by_mouse_and_by_button(visit: Callable[[str, str], Visit]) -> None:
    page = visit("run", "desk").page
    span = "(() => { const [a, b] = rockcheck.charts.histories.range(); return b - a; })()"
    whole = page.evaluate(span)
    page.locator("[data-for=histories][data-do=in]").click()
    assert page.evaluate(span) == pytest.approx(whole / 2.0)
    page.locator("[data-for=histories][data-do=all]").click()
    assert page.evaluate(span) == pytest.approx(whole)
    page.locator("#chart-histories .live").scroll_into_view_if_needed()
    area = plot_of(page)
    middle = area["y"] + 0.5 * area["height"]
    page.mouse.move(area["x"] + 0.2 * area["width"], middle)
    page.mouse.down()
    page.mouse.move(area["x"] + 0.4 * area["width"], middle, steps=4)
    page.mouse.up()
    page.wait_for_function(f"{span} < 0.3 * {whole}")
    assert page.evaluate(span) == pytest.approx(0.2 * whole, rel=0.1)
    domain = page.evaluate("rockcheck.charts.histories.view.scale('x').domain()")
    assert domain == page.evaluate("rockcheck.charts.histories.range()"), "all rows share the stretch"
    shown = page.evaluate("rockcheck.charts.histories.view.data('histories').map((row) => row.t)")
    low, high = domain
    assert sum(low <= t <= high for t in shown) >= len(shown) - 6, "of each model one more sample at each end"


def test_as_few_samples_are_drawn_as_keep_every_curve(visit: Callable[[str, str], Visit]) -> None:
    """Zooms take as long as they draw samples: of those of a stretch that all have room half lie on straight lines."""
    page = visit("run", "desk").page
    low, high = 2.0, 2.3
    rows, models = page.evaluate(
        "async (stretch) => { const {zoom, view, spec} = rockcheck.charts.histories; await zoom({X: stretch}); "
        "return [view.data('histories'), spec.datasets.histories.map("
        "(each) => ({name: each.name, t: [...each.t], theta: [...each.theta]}))]; }",
        [low, high],
    )
    for model in models:
        t_s, theta_rad = np.array(model["t"]), np.array(model["theta"])
        there = (t_s >= low) & (t_s <= high)
        shown = [(row["t"], row["theta"]) for row in rows if row["name"] == model["name"]]
        assert len(shown) < 0.5 * there.sum()
        off = np.interp(t_s[there], *np.transpose(shown)) - theta_rad[there]
        assert np.abs(off).max() < DRAWN_SHARE * np.ptp(theta_rad[there])


def test_a_click_sets_the_replay_and_the_pointer_is_told_what_stands_there(visit: Callable[[str, str], Visit]) -> None:
    page = visit("run", "desk").page
    page.locator("#chart-histories .live").scroll_into_view_if_needed()
    area = plot_of(page)
    place = area["x"] + 0.3 * area["width"], area["y"] + 0.5 * area["height"]
    page.mouse.move(*place)
    told = page.locator("#chart-histories .tip").inner_text().split("\n")
    assert told[0] == "3.0000 s"
    assert [line.split()[0] for line in told[1:]] == ["analytic", "pymunk", "pybullet"]
    page.mouse.click(*place)
    assert page.evaluate("rockcheck.time") == pytest.approx(3.0, abs=10.0 / area["width"])


def test_a_point_of_a_trust_map_that_is_clicked_opens_its_run(visit: Callable[[str, str], Visit]) -> None:
    found = visit("trust", "desk")
    page = found.page
    box = page.locator("#chart-floor .live")
    box.scroll_into_view_if_needed()
    area, *_ = page.evaluate("rockcheck.charts.floor.plots().map(({x, y, width, height}) => ({x, y, width, height}))")
    page.mouse.click(area["x"] + 0.75 * area["width"], area["y"] + 0.1 * area["height"])
    opened = page.evaluate("rockcheck.charts.point.view.signal('point')")
    assert opened == f"0.338 g, 2.00 Hz, {ENGLISH('chart.on_floor')}"
    page.wait_for_function(f"rockcheck.charts.point.view.data('runs').every((row) => row.point === '{opened}')")
    assert page.evaluate("rockcheck.charts.point.view.data('runs').length") == 5
    assert "motion.x.amplitude_g=0.1" in page.locator("output.command").inner_text()
    assert not found.said


def test_a_chart_that_print_hides_is_left_as_it_is_and_follows_its_width(visit: Callable[[str, str], Visit]) -> None:
    found = visit("table", "desk")
    width = "rockcheck.charts.saved.view.width()"
    before = found.page.evaluate(width)
    found.page.evaluate("window.views = Object.values(rockcheck.charts).map((chart) => chart.view); null")
    found.page.emulate_media(media="print")
    found.page.wait_for_timeout(200)
    assert found.page.evaluate("Object.values(rockcheck.charts).every((chart, k) => chart.view === window.views[k])")
    found.page.emulate_media(media="screen")
    found.page.set_viewport_size({"width": 700, "height": 900})
    found.page.wait_for_function(f"{width} > {before} + 50", timeout=20_000)
    found.page.set_viewport_size(SIZES["desk"])
    found.page.wait_for_function(f"{width} === {before}", timeout=20_000)
    assert errors(found) == []


def test_a_map_tells_of_its_cells_and_zooms_both_ways(visit: Callable[[str, str], Visit]) -> None:
    page = visit("map", "desk").page
    name = page.evaluate("Object.keys(rockcheck.charts).find((each) => rockcheck.charts[each].spec.datasets.tips)")
    page.locator(f"#chart-{name} .live").scroll_into_view_if_needed()
    area = plot_of(page, name)
    corner, centre = (area["x"] + 8, area["y"] + 8), (area["x"] + 0.5 * area["width"], area["y"] + 0.5 * area["height"])
    page.mouse.move(*centre)
    assert page.locator(f"#chart-{name} .tip").inner_text()
    domains = f"['x', 'y'].map((each) => rockcheck.charts['{name}'].view.scale(each).domain())"
    whole = page.evaluate(domains)
    page.mouse.move(*corner)
    page.mouse.down()
    page.mouse.move(*centre, steps=4)
    page.mouse.up()
    page.wait_for_function(f"{domains}[0][1] < {whole[0][1]}")
    (x, y) = page.evaluate(domains)
    assert (x[0] > whole[0][0], x[1] < whole[0][1]) == (True, True)
    assert (y[0] > whole[1][0], y[1] < whole[1][1]) == (True, True)
    page.mouse.dblclick(*centre)
    page.wait_for_function(f"JSON.stringify({domains}) === '{json.dumps(whole, separators=(',', ':'))}'")


def test_the_keyboard_alone_plays_turns_and_reaches_everything(visit: Callable[[str, str], Visit]) -> None:
    page = visit("run", "desk").page
    page.locator("#replay canvas").focus()
    x = page.evaluate("rockcheck.replay.camera.position.x")
    page.keyboard.press("ArrowLeft")
    assert page.evaluate("rockcheck.replay.camera.position.x") != x
    page.keyboard.press("Space")
    assert page.evaluate("rockcheck.replay.isPlaying()") is True
    page.keyboard.press("Space")
    unreachable = page.evaluate(
        "[...document.querySelectorAll('button, select, input, a')].filter((item) => item.tabIndex < 0).length"
    )
    assert unreachable == 0


def test_pictures_and_controls_have_names(visit: Callable[[str, str], Visit]) -> None:
    page = visit("run", "desk").page
    nameless = page.evaluate(NAMELESS)
    assert nameless == []
    assert page.evaluate("document.documentElement.lang") == "en"
    assert page.evaluate("document.querySelectorAll('h1').length") == 1


def test_the_papers_panels_change_with_group_and_model(visit: Callable[[str, str], Visit]) -> None:
    page = visit("table", "desk").page
    shown = "JSON.stringify([...new Set(rockcheck.charts.panels.view.data('panels').map((row) => `${row.model} ${row.r}`))])"
    assert page.evaluate(shown) == '["analytic (own impact) 0.85"]'
    assert page.locator("#chart-panels .live .mark-line path").count() == 30
    model, restitution = (page.locator("#chart-panels select").nth(k) for k in (0, 1))
    restitution.select_option("0.9")
    model.select_option("pymunk (imposed ratio)")
    page.wait_for_function(f"""{shown} === '["pymunk (imposed ratio) 0.9"]'""")
    assert page.locator("#chart-panels .live .mark-line path").count() == 30


@pytest.mark.parametrize("name", ["run", "table", "map"])
def test_without_scripts_the_charts_are_still_there(browser: Any, page_of: Callable[[str], Path], name: str) -> None:
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(page_of(name).as_uri())
    assert page.locator("main noscript p").is_visible()
    stills = page.locator("svg.still")
    assert all(stills.nth(k).is_visible() for k in range(stills.count()))
    assert stills.count() >= (1 if name == "run" else 2)
    assert page.locator(".chart:not(:has(svg.still))").count() == 0
    assert not any(page.locator(".tools, .transport, .wait, .stage").nth(k).is_visible() for k in range(3))
    assert page.locator("table:visible").count() > 0
    context.close()


def test_a_page_opens_on_the_event(browser: Any, page_of: Callable[[str], Path]) -> None:
    """The first view and the replay begin shortly before anything moves; zooming leaves the rotation's scale alone."""
    context = browser.new_context(viewport={"width": 1280, "height": 800})
    page = context.new_page()
    page.goto(page_of("run").as_uri())
    page.wait_for_selector("html[data-ready=yes]", timeout=60_000)
    views = page.evaluate("rockcheck.charts.histories.views")
    assert page.evaluate("rockcheck.charts.histories.range()") == views["event_s"]
    assert page.evaluate("rockcheck.time") == views["event_s"][0]
    upright = "rockcheck.charts.histories.view.scale('concat_0_y').domain()"
    assert page.evaluate(upright) == views["near"]
    page.locator("[data-for=histories][data-do=in]").click()
    assert page.evaluate(upright) == views["near"]
    page.locator("[data-for=histories][data-do=height]").click()
    page.wait_for_function(f"JSON.stringify({upright}) === JSON.stringify(rockcheck.charts.histories.views.whole)")
    verdict = page.locator("#verdict").bounding_box()
    assert verdict["y"] + verdict["height"] <= 800, "the answer stands before the fold"
    context.close()


def test_a_body_that_is_thrown_is_in_sight_all_along(browser: Any, tmp_path: Path) -> None:
    """It begins at twice its height above the floor, and slides away by three times that."""
    write_result(run_scene(load_scene("scenes/cube_toss.toml"), ["spatial"]), tmp_path)
    page = browser.new_context(viewport=SIZES["phone"]).new_page()
    page.goto(write_report(tmp_path).as_uri())
    page.wait_for_selector("html[data-ready=yes]", timeout=60_000)
    for time_s in (0.0, 0.1, 1.0):
        seen = page.evaluate(
            "(time) => { const {figures, camera} = rockcheck.replay, {tilt} = figures.get('spatial'); "
            "rockcheck.setTime(time); camera.updateMatrixWorld(); return tilt.position.clone().project(camera).toArray(); }",
            time_s,
        )
        assert max(map(abs, seen)) < 1.0, time_s
    page.context.close()
