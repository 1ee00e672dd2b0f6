"""The explorer: its functions against Python's, and the page in a real browser."""

import re
import shutil
from functools import cache
from pathlib import Path

import jax
import numpy as np
import pytest

from coefficients.catalogue import form_of, load
from integrals import INTEGRALS
from programs.printing.printer import write
from programs.toolchains.registry import toolchain
from shadefit.figures.values import kind_of, quantities, tables_of
from shadefit.report import explorer
from shadefit.report import page as report

# What the page's eight decimals, and R's rule, may cost.
SHOWN = 1e-6
# Where the page is read, in its own units (degrees), every table inside and outside its domain.
PLACES = {
    "ps": [(0.35, 45, 30, 90), (0.2, 80, 89, -170), (1, 10, 0, 0), (0.05, 45, 60, 30)],
    "g": [(0.2, 0.5), (0.001, 0.001), (0.5, 1), (0.75, 0.3)],
    "q": [(0.2,), (0.001,), (0.5,), (0.9,)],
    "r": [(0.35, 45), (0.15, 0), (1, 90), (0.05, 30)],
}
# Milliseconds: a machine that is busy with other tests is slow.
TIMEOUT = 60_000
CHROMIUM = shutil.which("chromium")
FLAGS = [
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
]


def some_tables(quantity):
    """List the tables that the page is tested with: of other forms one, as each takes its time."""
    every = tables_of(quantity)
    best = [name for name in every if kind_of(name) == "best"]
    return [name for name in every if name not in best[:-1]]


@pytest.fixture(scope="module", autouse=True)
def few_tables():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(explorer, "tables_of", some_tables)
        explorer.exported.cache_clear()
        yield
    explorer.exported.cache_clear()


def radians(quantity):
    """Give the places (n, axes) in the units of the integral, 90° exactly at the domain's end."""
    axes = INTEGRALS[quantity].axes
    places = np.array(PLACES[quantity], float)
    units = [np.pi / 180 if axis.unit == "rad" else 1 for axis in axes]
    ends = [axis.upper for axis in axes]
    return np.minimum(places * units, ends)


@cache
def in_python(quantity, name):
    """Give the values of a table, or of the integral, at the places; None outside its domain."""
    integral, points = INTEGRALS[quantity], radians(quantity)
    if name == "exact":
        return jax.jit(jax.vmap(lambda x: integral.value(*x)))(points).tolist()
    form = form_of(load(name))
    inside = np.all([axis.contains(x) for axis, x in zip(form.axes, points.T, strict=True)], axis=0)
    # A few points of many forms: not worth compiling.
    return [float(form(*x)) if here else None for x, here in zip(points, inside, strict=True)]


def test_exported_functions_give_pythons_values():
    javascript = toolchain("javascript")
    missing = javascript.missing("double")
    if missing is not None:
        pytest.skip(missing)
    functions = explorer.functions()
    for identifier, quantity, name in (
        ("exactPs", "ps", "exact"),
        ("exactG", "g", "exact"),
        ("exactQ", "q", "exact"),
        ("publishedPs", "ps", "published/ps"),
    ):
        expected = in_python(quantity, name)
        inside = np.array([value is not None for value in expected])
        function, rows = functions[identifier], radians(quantity)[inside]
        values = javascript.run(explorer.exported(), function, rows, "double")
        wanted = [value for value in expected if value is not None]
        np.testing.assert_allclose(np.ravel(values), wanted, rtol=0, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("quantity", PLACES)
def test_every_tables_function_gives_pythons_values(quantity):
    javascript = toolchain("javascript")
    missing = javascript.missing("double")
    if missing is not None:
        pytest.skip(missing)
    for name in tables_of(quantity):
        function = explorer._of_table(name)
        expected = in_python(quantity, name)
        inside = np.array([value is not None for value in expected])
        source = write(function, "javascript", "double")
        values = javascript.run(source, function, radians(quantity)[inside], "double")
        wanted = [value for value in expected if value is not None]
        np.testing.assert_allclose(np.ravel(values), wanted, rtol=0, atol=1e-12)


def test_every_table_has_a_function_of_its_own(monkeypatch):
    monkeypatch.setattr(explorer, "tables_of", tables_of)
    every = [name for quantity in quantities() for name in tables_of(quantity)]
    made = [explorer.identifier(name) for name in every]
    assert len(set(made)) == len(every)
    assert set(made) < explorer.functions().keys()
    assert explorer.identifier("published/ps@printed") == "publishedPsPrinted"
    assert explorer.identifier("best/g-exp_9.2") == "bestGExp92"


@pytest.fixture(scope="module")
def script() -> str:
    return explorer.script()


def test_the_script_cannot_end_its_element(script):
    text = script
    assert "</" not in text
    assert text.startswith('"use strict";')
    assert re.search(r"NaN|Infinity", text.split("const known = ")[1].split("\n")[0]) is None


@pytest.fixture(scope="module")
def browser():
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("chromium is not on PATH (Debian: chromium)")
    with sync_api.sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS, timeout=TIMEOUT)
        yield started
        started.close()


@pytest.fixture(scope="module")
def address(tmp_path_factory, script) -> str:
    path: Path = tmp_path_factory.mktemp("report") / "report.html"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report, "script", lambda: script)
        path.write_text(report.assemble("", "", "", ""), encoding="utf-8")
    return path.as_uri()


@pytest.fixture
def page(browser, address):
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    opened = context.new_page()
    opened.set_default_timeout(TIMEOUT)
    said, asked = [], []
    opened.on("console", lambda message: said.append(message.text))
    opened.on("pageerror", lambda error: said.append(str(error)))
    opened.on("request", lambda request: asked.append(request.url))
    opened.goto(address)
    opened.wait_for_selector("#errors-chart path")
    yield opened
    assert said == []
    assert {url.partition(":")[0] for url in asked} <= {"file", "data"}
    context.close()


def choose(page, quantity):
    page.check(f'input[name="quantity"][value="{quantity}"]')


def enter(page, quantity, place):
    for axis, value in zip(INTEGRALS[quantity].axes, place, strict=True):
        page.fill(f"#enter-{axis.name}", str(value))


def values(page):
    rows = page.locator("#values tr").all()
    return {row.get_attribute("data-table"): row.locator("td").all_inner_texts() for row in rows}


def curves(page):
    """Wait until what was asked for is drawn; give every path of the upper chart."""
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => setTimeout(done)))")
    paths = page.locator("#values-chart path").all()
    return [path.get_attribute("d") for path in paths]


def mark_of(page):
    """Give where the place explored is marked on the upper chart."""
    return float(page.locator("#values-chart .mark").get_attribute("x1"))


def test_the_numbers_shown_are_pythons(page):
    for quantity, places in PLACES.items():
        choose(page, quantity)
        for index, place in enumerate(places):
            enter(page, quantity, place)
            shown = values(page)
            assert set(shown) == {"exact", *some_tables(quantity)}
            for name, (value, error) in shown.items():
                expected = in_python(quantity, name)[index]
                if expected is None:
                    assert value == "—"
                    assert error.endswith("outside its domain")
                else:
                    assert float(value) == pytest.approx(expected, abs=SHOWN)


def test_moving_a_slider_changes_the_plot(page):
    for quantity in PLACES:
        choose(page, quantity)
        before, numbers, mark = curves(page), values(page), mark_of(page)
        first = INTEGRALS[quantity].axes[0].name
        page.focus(f"#slide-{first}")
        for _ in range(4):
            page.keyboard.press("ArrowRight")
        after = curves(page)
        assert len(after) == len(before) == 3
        assert values(page)["exact"] != numbers["exact"]
        # The curve of Q is drawn against its only argument: there the mark moves instead.
        if quantity == "q":
            assert after == before
            assert mark_of(page) > mark
        else:
            assert after[0] != before[0]
            assert mark_of(page) == mark


def test_the_discs_follow_the_material(page):
    def drawn():
        curves(page)
        return page.evaluate(
            "() => [...document.querySelectorAll('#discs canvas')].map((c) => c.toDataURL())"
        )

    before = drawn()
    assert len(before) == 3
    assert len(set(before)) == 3
    page.fill("#enter-alpha", "0.2")
    after = drawn()
    assert all(a != b for a, b in zip(after, before, strict=True))
    # Below the domain of the tables, their discs are empty.
    page.fill("#enter-alpha", "0.1")
    empty = drawn()
    assert empty[0] != after[0]
    assert empty[1] == empty[2]
    choose(page, "g")
    assert page.locator("#discs").is_hidden()


def test_tables_are_drawn_when_they_are_ticked(page):
    assert len(curves(page)) == 3
    page.get_by_label("published/ps@printed").check()
    assert len(curves(page)) == 4
    for box in page.locator("#values input").all():
        box.uncheck()
    assert len(curves(page)) == 1
    assert "no table is chosen" in page.locator("#errors-chart svg").get_attribute("aria-label")


def test_what_is_out_of_range_is_marked_and_not_taken(page):
    shown = values(page)
    for wrong in ("2", "", "-1"):
        page.fill("#enter-alpha", wrong)
        assert page.get_attribute("#enter-alpha", "aria-invalid") == "true"
        assert values(page) == shown
    page.fill("#enter-alpha", "0.36")
    assert page.get_attribute("#enter-alpha", "aria-invalid") == "false"
    assert values(page) != shown


def test_a_curve_can_be_drawn_against_any_argument(page):
    seen = set()
    for axis in INTEGRALS["ps"].axes:
        page.select_option("#against", axis.name)
        seen.add(curves(page)[0])
        label = page.locator("#values-chart svg").get_attribute("aria-label")
        assert f"against {axis.symbol} from" in label
    assert len(seen) == 4


def test_every_control_has_a_name_and_changes_are_read_out(page):
    unnamed = page.evaluate(
        """() => [...document.querySelectorAll("input, select")].filter(
            (each) => !each.labels.length && !each.getAttribute("aria-label")).length"""
    )
    assert unnamed == 0
    page.fill("#enter-alpha", "0.34")
    page.fill("#enter-alpha", "0.35")
    expected = in_python("ps", "exact")[0]
    page.wait_for_function(
        "(text) => document.querySelector('#status').textContent.includes(text)",
        arg=f"exact {expected:.4f}",
        timeout=5000,
    )
    assert page.locator("#status").get_attribute("role") == "status"
    page.keyboard.press("Tab")
    outline = page.evaluate("() => getComputedStyle(document.activeElement).outlineStyle")
    assert outline != "none"


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_fits_a_phone_in_either_scheme(browser, address, scheme):
    context = browser.new_context(viewport={"width": 360, "height": 740}, color_scheme=scheme)
    opened = context.new_page()
    opened.goto(address)
    opened.wait_for_selector("#errors-chart path")
    assert opened.evaluate("() => document.documentElement.scrollWidth") <= 360
    paper = opened.evaluate("() => getComputedStyle(document.body).backgroundColor")
    light = sum(map(int, re.findall(r"\d+", paper))) > 380
    assert light == (scheme == "light")
    context.close()
