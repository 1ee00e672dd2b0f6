"""The explorer: its functions in Node against Python's, and the page in a real browser."""

import json
import re
import shutil
import subprocess
import tempfile
from dataclasses import replace
from functools import cache
from importlib.resources import files
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from coefficients.catalogue import Entry, entries, resolve
from coefficients.exported_code import exported_values
from fitting import Form, Stage
from integrals.reference import Axis, Estimate, Reference, leg
from integrals.sampling import Sampling
from programs import write_source
from quantities import Problem, problem, problems, register
from quantities.calling_convention import Argument, CallingConvention
from quantities.loader import load_problems
from quantities.registry import unregister
from shadefit.figures.values import axis_hints
from shadefit.report import code, explorer, sections
from shadefit.report import page as report

# Values on the page have eight decimals, and the page's rule for R has an error.
SHOWN = 1e-6
# Places in the page's units (degrees): each has tables whose domain it is in, and others.
PLACES = {
    "ps": [(0.35, 45, 30, 90), (0.2, 80, 89, -170), (1, 10, 0, 0), (0.05, 45, 60, 30)],
    "g": [(0.2, 0.5), (0.001, 0.001), (0.5, 1), (0.75, 0.3)],
    "q": [(0.2,), (0.001,), (0.5,), (0.9,)],
    "r": [(0.35, 45), (0.15, 0), (1, 90), (0.05, 30)],
    "velvet": [(-0.5,), (-0.95,), (0,)],
}
# Milliseconds. A machine that runs other tests at the same time is slow.
TIMEOUT = 60_000
NODE, CHROMIUM = shutil.which("node"), shutil.which("chromium")
FLAGS = [
    *("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run"),
    *("--disable-background-networking", "--disable-component-update", "--disable-sync"),
]
# Evaluates a quantity, and each of its tables, at points that are read as JSON.
_MAIN = """
const points = JSON.parse(require("node:fs").readFileSync(0, "utf8"));
const values = {};
for (const quantity of known.quantities) {
    select(quantity.name);
    const own = values[quantity.name] = { exact: points[quantity.name].map(exactAt) };
    for (const table of quantity.tables)
        own[table.name] = points[quantity.name].map((point) => evaluate(table, point));
}
console.log(JSON.stringify(values));
"""


def some_tables(owner):
    """List the tables that the page is tested with: one best table only, as each takes time."""
    every = entries(owner)
    best = [entry for entry in every if entry.kind == "best"]
    return [entry for entry in every if entry not in best[:-1]]


@pytest.fixture(scope="module")
def few_tables():
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(explorer, "entries", some_tables)
        patch.setattr(code, "LISTED", ("hlsl", "wgsl"))
        patch.setattr(explorer, "LISTED", ("hlsl", "wgsl"))
        yield


def own_units(quantity):
    """Return the places (n, axes) in the units of the axes, with 90° exactly at a domain's end."""
    pairs = axis_hints(problem(quantity))
    places = np.array(PLACES[quantity], float) / [hint.factor for _, hint in pairs]
    return np.minimum(places, [axis.upper for axis, _ in pairs])


@cache
def in_python(quantity, name):
    """Return the exact values at the places, or those of a table's exported functions."""
    points = own_units(quantity)
    if name == "exact":
        value = problem(quantity).reference.value
        return jax.jit(jax.vmap(lambda x: value(*x)))(points).tolist()
    return exported_values(resolve(name), points).tolist()


def outside(quantity, name, place):
    """Return whether a place is outside the domain of a table."""
    axes = resolve(name).axes
    return not all(axis.contains(x) for axis, x in zip(axes, place, strict=True))


def model_scripts():
    """Return the page's scripts that need no page."""
    own = files("shadefit.report")
    return "\n".join(own.joinpath(name).read_text(encoding="utf-8") for name in explorer.MODEL)


def in_node(owners, points, main=_MAIN):
    """Evaluate quantities and their tables by the page's own code, in Node."""
    if NODE is None:
        pytest.skip("node is not on PATH (Debian: nodejs)")
    functions, known = explorer.functions_and_data(owners)
    model = model_scripts()
    parts = [
        explorer.printed(functions),
        f"const exported = {{ {', '.join(functions)} }};",
        f"const known = {json.dumps(known, allow_nan=False)};",
        "const codes = Object.fromEntries(known.quantities.map(({ name }) => [name, []]));",
        *(model, main),
    ]
    given = json.dumps({name: rows.tolist() for name, rows in points.items()})
    with tempfile.TemporaryDirectory() as folder:
        # The script of all tables is too long for a command line.
        path = Path(folder) / "page.js"
        path.write_text("\n".join(parts), encoding="utf-8")
        done = subprocess.run(
            [NODE, str(path)], input=given, capture_output=True, text=True, check=True, timeout=60
        )
    return json.loads(done.stdout)


def sliders_points(owner, count=40):
    """Return points (count, axes) at random over the ranges of the sliders."""
    low, high = np.array([hint.slider for _, hint in axis_hints(owner)]).T
    return low + (high - low) * np.random.default_rng(8).random((count, len(low)))


def require_the_same(owners):
    points = {owner.name: sliders_points(owner) for owner in owners}
    values = in_node(owners, points)
    for owner in owners:
        found = values[owner.name]
        exact = found.pop("exact")
        expected = owner.reference.values(points[owner.name])
        # R is averaged by a rule of 48² points, whose error is largest for the least α.
        allowed = 1e-12 if owner.closed_form else 1e-6
        # A browser cannot evaluate an integral that is no average of a closed form.
        if owner.closed_form is None and owner.average is None:
            assert set(exact) == {None}
        else:
            np.testing.assert_allclose(exact, expected, rtol=0, atol=allowed)
        for name, each in found.items():
            expected = exported_values(resolve(name), points[owner.name])
            np.testing.assert_allclose(each, expected, rtol=0, atol=1e-12, err_msg=name)


@pytest.mark.slow
def test_the_page_evaluates_the_exported_functions(few_tables):
    require_the_same(list(problems().values()))


@pytest.mark.slow
def test_the_page_evaluates_the_exported_functions_of_every_table():
    require_the_same(list(problems().values()))


@pytest.mark.slow
def test_the_page_clamps_as_the_exported_functions_do():
    # α and θf below the domain of the table are clamped for c₀ … c₅, but not in u·t.
    owner, entry = problem("ps"), resolve("published/ps")
    below, at_end = np.array([[0.05, 0.5, 0.3, 1.0], [0.15, 0.5, 0.3, 1.0]])
    values = in_node([owner], {"ps": np.array([below, at_end])})["ps"]["published/ps"]
    assert values[0] == values[1] == pytest.approx(exported_values(entry, below[None])[0])


def test_every_table_has_a_function_of_its_own():
    every = [entry for owner in problems().values() for entry in entries(owner)]
    made = [explorer.identifier(entry) for entry in every]
    assert len(set(made)) == len(every)
    owner = problem("g")
    assert explorer.identifier(resolve("published/ps@printed")) == "publishedPsPrinted"
    assert explorer.identifier(Entry("best/g-exp_9.2", "best", owner)) == "bestGExp92"


X = Axis("x", 0.0, np.inf, meaning="an argument")


@pytest.fixture
def tables_only():
    """Register a quantity that has a form but no closed form that can be printed."""

    @leg(X)
    def quadrature(x):
        return Estimate(jnp.cos(x), jnp.array(1e-15))

    reference = Reference(
        "new", "N_w", "a new quantity", "cos x", (X,), Sampling(5, 6, 7), quadrature=quadrature
    )
    axes = (replace(X, upper=0.75),)
    form = Form("line", "1 + c x", reference, axes, ["c"], (Stage(lambda c, x: 1 + c[0] * x),))
    calling = CallingConvention("New", "A line.", (Argument("x", "x", "above"),))
    yield register(Problem(reference, (form,), calling))
    unregister("new")


def test_a_registered_quantity_is_explored_as_far_as_it_can_be_evaluated(tables_only, monkeypatch):
    assert tables_only not in explorer.explored()
    fitted = tables_only.default.fitted(np.array([-0.25]))
    # Any table will do: the page takes its values from the fitted form.
    entry = Entry("best/new-1", "best", tables_only, resolve("q").table, fitted)
    monkeypatch.setattr(explorer, "entries", lambda owner: [entry])
    assert tables_only in explorer.explored()
    _, known = explorer.functions_and_data([tables_only])
    ((axis,),) = [each["axes"] for each in known["quantities"]]
    assert (axis["low"], axis["high"], axis["start"]) == (0.0, 1.0, 0.5)
    values = in_node([tables_only], {"new": np.array([[0.5], [1.0]])})["new"]
    assert values == {"exact": [None, None], "best/new-1": [0.875, 0.8125]}


@pytest.fixture(scope="module")
def script(few_tables) -> str:
    return explorer.script()


@pytest.mark.slow
def test_the_script_cannot_end_its_element(script):
    assert "</" not in script
    assert script.startswith('"use strict";')
    assert re.search(r"NaN|Infinity", script.split("const known = ")[1].split("\n")[0]) is None


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
        patch.setattr(report, "script", lambda more: script)
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
    for axis, value in zip(problem(quantity).axes, place, strict=True):
        page.fill(f"#enter-{axis.name}", str(value))


def values(page):
    rows = page.locator("#values tr").all()
    return {row.get_attribute("data-table"): row.locator("td").all_inner_texts() for row in rows}


def curves(page):
    """Wait until the page has drawn, and return every path of the upper chart."""
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => setTimeout(done)))")
    paths = page.locator("#values-chart path").all()
    return [path.get_attribute("d") for path in paths]


def mark_of(page):
    """Return the x at which the upper chart marks the explored place."""
    return float(page.locator("#values-chart .mark").get_attribute("x1"))


def test_the_numbers_shown_are_those_of_python(page):
    for quantity, places in PLACES.items():
        choose(page, quantity)
        for index, place in enumerate(places):
            enter(page, quantity, place)
            shown = values(page)
            tables = {entry.name for entry in some_tables(problem(quantity))}
            assert set(shown) == {"exact", *tables}
            for name, (value, error) in shown.items():
                expected = in_python(quantity, name)[index]
                assert float(value) == pytest.approx(expected, abs=SHOWN)
                if name == "exact":
                    continue
                inside = not outside(quantity, name, own_units(quantity)[index])
                assert error.endswith("outside its domain") == (not inside)


def test_moving_a_slider_changes_the_plot(page):
    for quantity in PLACES:
        choose(page, quantity)
        before, numbers, mark = curves(page), values(page), mark_of(page)
        first = problem(quantity).axes[0].name
        page.focus(f"#slide-{first}")
        for _ in range(4):
            page.keyboard.press("ArrowRight")
        after = curves(page)
        drawn = page.locator("#values input:checked").count()
        assert len(after) == len(before) == 1 + drawn
        assert values(page)["exact"] != numbers["exact"]
        # The curves of a quantity of one axis stay, and the mark moves along them.
        if len(problem(quantity).axes) == 1:
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

    # The errors of one table are so small that they have no colour on the scale of the other: at
    # first each has its own.
    before = drawn()
    assert len(before) == 3
    assert len(set(before)) == 3
    page.fill("#enter-alpha", "0.2")
    after = drawn()
    assert all(a != b for a, b in zip(after, before, strict=True))
    # Below the domain of the tables the exported functions clamp α, and the exact values differ.
    page.fill("#enter-alpha", "0.1")
    below = drawn()
    assert all(a != b for a, b in zip(below, after, strict=True))
    assert len(set(below)) == 3
    choose(page, "g")
    assert page.locator("#discs").is_hidden()


def test_tables_are_drawn_when_they_are_ticked(page):
    assert len(curves(page)) == 3
    page.get_by_label("published/ps@printed").check()
    assert len(curves(page)) == 4
    for box in page.locator("#values input").all():
        box.uncheck()
    assert len(curves(page)) == 1
    assert "no table is chosen" in page.locator("#errors-chart > svg").get_attribute("aria-label")


def test_what_is_out_of_range_is_marked_and_not_taken(page):
    shown = values(page)
    message = page.locator("#message-alpha")
    assert page.get_attribute("#enter-alpha", "aria-describedby") == "message-alpha"
    for wrong in ("2", "", "-1"):
        page.fill("#enter-alpha", wrong)
        assert page.get_attribute("#enter-alpha", "aria-invalid") == "true"
        assert message.inner_text() == "α must be a number from 0.05 to 1"
        assert values(page) == shown
    page.fill("#enter-alpha", "0.36")
    assert page.get_attribute("#enter-alpha", "aria-invalid") == "false"
    assert message.is_hidden()
    assert values(page) != shown


def test_a_curve_can_be_drawn_against_any_argument(page):
    seen = set()
    for axis in problem("ps").axes:
        page.select_option("#against", axis.name)
        seen.add(curves(page)[0])
        label = page.locator("#values-chart > svg").get_attribute("aria-label")
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


def ticked(page):
    return {
        row.get_attribute("data-table")
        for row in page.locator("#values tr").all()
        if row.locator("input:checked").count()
    }


def test_best_tables_are_drawn_at_first(page):
    for quantity in PLACES:
        choose(page, quantity)
        own = some_tables(problem(quantity))
        best = {entry.name for entry in own if entry.kind == "best"}
        if best:
            assert ticked(page) == best | {f"published/{quantity}"}
        else:
            assert ticked(page) == {entry.name for entry in own}


def test_at_most_three_best_tables_are_drawn_at_first():
    for owner in problems().values():
        own = entries(owner)
        best = [entry for entry in explorer.drawn_at_first(own) if entry.kind == "best"]
        errors = [
            entry.require_table().errors.off_grid.max for entry in own if entry.kind == "best"
        ]
        assert len(best) == min(3, len(errors))
        if errors:
            drawn = [entry.require_table().errors.off_grid.max for entry in best]
            assert {min(errors), max(errors)} <= set(drawn)


def test_a_click_on_a_curve_sets_the_argument(page):
    box = page.locator("#values-chart").bounding_box()
    for share in (0.3, 0.8):
        shown = values(page)
        page.mouse.click(box["x"] + share * box["width"], box["y"] + 100)
        curves(page)
        assert values(page) != shown
        assert mark_of(page) == pytest.approx(share * box["width"], abs=1)
    # On the other side of the zenith the azimuth is the opposite one.
    assert page.input_value("#enter-phi") == "90"
    page.mouse.click(box["x"] + 0.3 * box["width"], box["y"] + 100)
    assert page.input_value("#enter-phi") == "-90"
    before = curves(page)
    page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 100)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.7 * box["width"], box["y"] + 100)
    page.mouse.up()
    assert curves(page) == before
    assert page.input_value("#enter-phi") == "90"


def test_a_click_on_a_map_sets_the_direction(page):
    canvas = page.locator("#discs canvas").nth(1)
    canvas.scroll_into_view_if_needed()
    width = canvas.bounding_box()["width"]
    # 0.4 and 0.6 of the radius from the centre: the sines of the polar angles
    canvas.click(position={"x": width / 2, "y": width * 0.3})
    assert float(page.input_value("#enter-theta_u")) == pytest.approx(23.6, abs=0.5)
    assert float(page.input_value("#enter-phi")) == pytest.approx(90, abs=2)
    canvas.click(position={"x": width * 0.8, "y": width / 2})
    assert float(page.input_value("#enter-theta_u")) == pytest.approx(36.9, abs=0.7)
    assert float(page.input_value("#enter-phi")) == pytest.approx(0, abs=2)


def test_maps_have_colour_bars_whose_scale_adapts(page):
    def ends():
        curves(page)
        every = [bar.inner_text().split() for bar in page.locator("#discs .ends").all()]
        return [[float(value.replace("−", "-")) for value in bar] for bar in every]

    assert page.input_value("#maps") == "automatic"
    own = ends()
    page.select_option("#maps", "common")
    common = ends()
    assert len(common) == 3
    assert common[1] == common[2]
    assert common[0] == [0, 0.5, 1]
    assert common[1][0] == -common[1][2]
    page.get_by_label("published/ps", exact=True).uncheck()
    alone = ends()
    assert 0 < alone[1][2] < common[1][2] / 100
    page.get_by_label("published/ps", exact=True).check()
    assert ends() == common
    page.select_option("#maps", "own")
    assert ends()[2] == alone[1]
    assert ends() == own


def test_errors_that_differ_much_are_drawn_on_a_logarithmic_scale(page):
    def label():
        curves(page)
        return page.locator("#errors-chart .name").nth(1).inner_html()

    assert label() == "|table − exact|"
    page.select_option("#errors", "linear")
    assert label() == "table − exact"
    page.select_option("#errors", "automatic")
    page.get_by_label("published/ps", exact=True).uncheck()
    assert label() == "table − exact"


def test_the_address_keeps_the_state(page):
    choose(page, "g")
    enter(page, "g", (0.3, 0.25))
    page.select_option("#against", "density")
    page.select_option("#errors", "linear")
    page.select_option("#code-in", "wgsl")
    page.get_by_label("published/g", exact=True).uncheck()
    page.wait_for_url(lambda url: "table=published/g" not in url and "errors=linear" in url)
    shown, drawn, code = values(page), curves(page), page.inner_text("#code-text")
    other = page.context.new_page()
    other.goto(page.url)
    other.wait_for_selector("#errors-chart path")
    assert values(other) == shown
    assert curves(other) == drawn
    assert ticked(other) == ticked(page)
    assert other.inner_text("#code-text") == code
    assert other.input_value("#errors") == "linear"
    # A link to a section leaves the state as it is.
    other.click('nav a[href="#summary"]')
    assert values(other) == shown


@pytest.mark.parametrize(
    "hostile",
    [
        "quantity=__proto__&at.alpha=1",
        "quantity=ps&at.alpha=7&against=nothing&table=nothing&errors=toString&code=<b>&language=x",
        "quantity=ps&at.alpha=&at.phi=NaN&at.theta_f=Infinity&at.theta_u=1e999",
        "%E0%A4%A&quantity",
    ],
)
def test_an_address_of_somebody_else_does_no_harm(page, address, hostile):
    before = values(page)
    other = page.context.new_page()
    failed = []
    other.on("pageerror", lambda error: failed.append(str(error)))
    other.goto(f"{address}#{hostile}")
    other.wait_for_selector("#errors-chart path")
    assert values(other) == before
    assert failed == []
    wrong = [text for text in other.locator(".message").all_inner_texts() if text]
    assert len(wrong) == (hostile.count("at.") if "=ps" in hostile else 0)
    other.close()


def test_the_code_of_a_table_is_shown_and_copied(page):
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    choose(page, "q")
    best = next(entry.name for entry in some_tables(problem("q")) if entry.kind == "best")
    assert page.input_value("#code-of") == best
    for name, language in (("published/q", "hlsl"), ("exact/q", "wgsl"), (best, "hlsl")):
        page.select_option("#code-of", name)
        page.select_option("#code-in", language)
        written = write_source(resolve(name).functions("float"), language)
        assert page.inner_text("#code-text").endswith(written)
        command = f"shadefit export {name} --to {language}"
        assert page.inner_text("#code-command") == command
    page.click("#copy")
    page.wait_for_function("() => document.querySelector('#copied').textContent === 'Copied.'")
    copied = page.evaluate("() => navigator.clipboard.readText()")
    assert copied == page.locator("#code-text").evaluate("(each) => each.textContent")
    assert copied.startswith("// SPDX-License-Identifier: Apache-2.0\n")
    choose(page, "ps")
    # The code is that of the table that was ticked last.
    page.get_by_label("published/ps@printed").check()
    assert page.input_value("#code-of") == "published/ps@printed"


def test_charts_stay_in_sight_on_a_phone(browser, address):
    context = browser.new_context(viewport={"width": 390, "height": 844}, has_touch=True)
    opened = context.new_page()
    opened.goto(address)
    opened.wait_for_selector("#errors-chart path")
    assert opened.evaluate("() => document.documentElement.scrollWidth") <= 390
    for control in ("#enter-alpha", "#against", "#values tr:last-child"):
        opened.locator(control).evaluate("(each) => each.scrollIntoView({ block: 'end' })")
        charts = opened.locator(".charts").bounding_box()
        own = opened.locator(control).bounding_box()
        assert charts["y"] >= 0
        assert charts["height"] <= 844 / 3 + 10
        assert charts["y"] + charts["height"] <= own["y"]
        assert own["y"] + own["height"] <= 845
    context.close()


@pytest.fixture
def examples():
    """Load quantities with a closed form, with a quadrature, and of data."""
    folder = Path(__file__).parents[2] / "examples"
    files_of = {"soft": "soft_step.py", "fresnel": "fresnel.py", "albedo": "albedo.py"}
    for file in files_of.values():
        load_problems(str(folder / file))
    yield {name: problem(name) for name in files_of}
    for name in files_of:
        unregister(name)


def test_quantities_of_a_user_are_shown_as_far_as_they_are_known(
    browser, examples, tmp_path, monkeypatch
):
    monkeypatch.setattr(explorer, "problems", lambda: examples)
    path = tmp_path / "report.html"
    path.write_text(report.assemble(sections.summary([examples["albedo"]]), "", "", ""))
    opened = browser.new_page()
    said = []
    opened.on("pageerror", lambda error: said.append(str(error)))
    opened.goto(path.as_uri())
    opened.wait_for_selector("#values-chart path")
    names = [box.get_attribute("value") for box in opened.locator('[name="quantity"]').all()]
    # Between the points of data nothing is known, and there is no table.
    assert names == ["soft", "fresnel"]
    assert "E, data of albedo.csv" in opened.inner_text("#summary")
    assert len(curves(opened)) == 1
    assert values(opened)["exact"][0] == f"{np.tanh(2 * 0.75):.8f}"
    assert opened.input_value("#code-of") == "exact/soft"
    choose(opened, "fresnel")
    assert len(curves(opened)) == 1
    assert opened.locator("#errors-chart").is_hidden()
    assert opened.locator("#scales").is_hidden()
    assert "no formula for the exact values of F_avg" in opened.inner_text("#no-exact")
    assert "FresnelAverage" in opened.inner_text("#code-text")
    opened.mouse.click(*(opened.locator("#values-chart").bounding_box()[k] + 120 for k in "xy"))
    assert opened.input_value("#enter-eta") != "2"
    assert said == []
    opened.close()


def linear(channel):
    return channel / 12.92 if channel <= 0.04045 else ((channel + 0.055) / 1.055) ** 2.4


def oklab(colour):
    """Return the place of a colour '#rrggbb' in OKLab (B. Ottosson, 2020)."""
    red, green, blue = (linear(int(colour[i : i + 2], 16) / 255) for i in (1, 3, 5))
    long = np.cbrt(0.4122214708 * red + 0.5363325363 * green + 0.0514459929 * blue)
    medium = np.cbrt(0.2119034982 * red + 0.6806995451 * green + 0.1073969566 * blue)
    short = np.cbrt(0.0883024619 * red + 0.2817188376 * green + 0.6299787005 * blue)
    return np.array(
        [
            0.2104542553 * long + 0.7936177850 * medium - 0.0040720468 * short,
            1.9779984951 * long - 2.4285922050 * medium + 0.4505937099 * short,
            0.0259040371 * long + 0.7827717662 * medium - 0.8086757660 * short,
        ]
    )


def test_no_colour_is_repeated():
    style = files("shadefit.report").joinpath("report.css").read_text(encoding="utf-8")
    light, dark = re.findall(r":root \{(.*?)\}", style, re.DOTALL)[:2]
    for scheme in (light, dark):
        colours = dict(re.findall(r"--(exact|published|printed|refitted|best-\d): (#\w+);", scheme))
        assert len(colours) == 14
        places = np.array([oklab(each) for each in colours.values()])
        apart = np.linalg.norm(places[:, None] - places[None], axis=-1) + np.eye(len(places))
        # 0.02 is just noticeable for areas side by side. Thin lines need more.
        assert apart.min() > 0.08
    most = max(
        len([e for e in entries(owner) if e.kind == "best"]) for owner in problems().values()
    )
    assert most <= 10


_SCALES = """
const cases = JSON.parse(require("node:fs").readFileSync(0, "utf8"));
console.log(JSON.stringify({
    range: roundRange([0.487, 0.676]),
    flat: roundRange([0.3, 0.3]),
    none: roundRange([NaN, null].map(Number.parseFloat)),
    far: rangeOfCurves([0.5, 0.6], [[0.55, 1e6, NaN]]),
    near: rangeOfErrors([[1e-3, -2e-3], [5e-4]], "automatic"),
    apart: rangeOfErrors([[1e-2, -2e-2], [5e-5, 0]], "automatic"),
    exactly: rangeOfErrors([[0, 0]], "logarithmic"),
    powers: powersOfTen(1e-8, 1, 4),
    within: powersOfTen(0.2, 0.9, 5),
    maps: ["automatic", "common", "own"].flatMap((wanted) => [
        limitsOfMaps([0.15, 8e-6, 0], wanted), limitsOfMaps([0.15, 0.011], wanted)]),
    up: [0.011, 0.02, 0.2000001, 9, 1e-15].map(roundUp),
}));
"""


def test_scales_adapt_to_values():
    found = in_node([], {}, _SCALES)
    close = {"rel": 1e-9, "abs": 1e-12}
    assert found["range"] == pytest.approx([0.45, 0.7], **close)
    assert found["none"] == [0, 1]
    low, high = found["flat"]
    assert low < 0.3 < high < low + 1e-5
    assert found["far"] == pytest.approx([0.5, 0.7], **close)
    assert found["near"]["logarithmic"] is False
    assert found["near"]["range"] == pytest.approx([-2e-3, 1e-3], **close)
    assert found["apart"]["logarithmic"] is True
    assert found["apart"]["range"] == pytest.approx([1e-7, 0.1], rel=1e-9)
    assert found["exactly"]["logarithmic"] is False
    far, near, *others = found["maps"]
    assert far == pytest.approx([0.2, 1e-5, 1e-15], rel=1e-9)
    assert near == pytest.approx([0.2, 0.2], rel=1e-9)
    assert others[0] == pytest.approx([0.2, 0.2, 0.2], rel=1e-9)
    assert others[3] == pytest.approx([0.2, 0.02], rel=1e-9)
    assert found["powers"] == pytest.approx([1e-8, 1e-6, 1e-4, 1e-2, 1], rel=1e-9)
    assert found["within"] == pytest.approx([0.2, 0.4, 0.6, 0.8], **close)
    assert found["up"] == pytest.approx([0.02, 0.02, 0.5, 10, 1e-15], rel=1e-9)
