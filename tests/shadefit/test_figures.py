"""Pictures: they show what the tables and references say, and are the same bytes each time."""

import io
import re
import struct
from pathlib import Path
from xml.etree import ElementTree

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from matplotlib.collections import QuadMesh
from matplotlib.figure import Figure
from matplotlib.text import Text

from coefficients.catalogue import entries, resolve
from coefficients.compare import compare
from coefficients.exported_code import exported_values, operations_of
from coefficients.frontier import Mark, best_so_far, marks
from coefficients.search import Found, Result
from fitting import Form, Stage
from integrals.reference import Axis, Estimate, Reference, leg
from integrals.sampling import Sampling
from quantities import Problem, problem, problems, register
from quantities.calling_convention import Argument, CallingConvention
from quantities.plot_hints import AxisHint, PlotHints
from quantities.registry import unregister
from shadefit import figures
from shadefit.cli import main
from shadefit.figures import (
    curves,
    detail_maps,
    drawable,
    frontier,
    maps,
    pictures,
    ps_lights,
    render,
    search,
)
from shadefit.figures.fuzz_pictures import DRAWN
from shadefit.figures.picture import Picture
from shadefit.figures.ps_materials import (
    BEST,
    COMPARED,
    EXCHANGED,
    PRINTED,
    TABLES,
    ps_errors,
    ps_rows,
)
from shadefit.figures.style import COLOURS, DASHES, MARKERS
from shadefit.figures.values import (
    axis_hints,
    best_tables,
    compared_values,
    error_text,
    exact,
    label_of,
    mesh,
)
from shadefit.images import optional_libraries

DOCS = Path(__file__).parents[2] / "docs"
SVG = "{http://www.w3.org/2000/svg}"
SLOW = pytest.mark.slow
X = Axis("x", 0.0, np.inf, meaning="first argument")
ANGLE = Axis("turn", 0.0, np.pi, "φ", "rad", "second argument", open_below=True)
rng = np.random.default_rng(6)


def new_problem(*axes, name="new", plot=None):
    """Return a quantity that has neither kept tables nor, by default, plot hints."""

    @leg(*axes)
    def closed_form(*point):
        return Estimate(jnp.cos(sum(point)), jnp.array(1e-15))

    reference = Reference(
        name, "N_w", "a new quantity", "cos(x + …)", axes, Sampling(5, 6, 7), closed_form
    )
    stage = Stage(lambda c, *point: 1 + c[0] * sum(point))
    form = Form("line", "1 + c x", reference, axes, ["c"], (stage,))
    arguments = tuple(Argument(axis.name, axis.name) for axis in axes)
    return Problem(reference, (form,), CallingConvention("New", "A line.", arguments), plot=plot)


@pytest.fixture
def registered():
    """Return a function that registers a quantity until the test ends."""
    added = []

    def add(owner):
        added.append(owner)
        return register(owner)

    yield add
    for owner in added:
        unregister(owner.name)


def points_of(form, count=300):
    low, high = np.array([(axis.lower, axis.upper) for axis in form.axes]).T
    return low + (high - low) * rng.random((count, len(form.axes)))


@pytest.mark.parametrize("name", ["published/ps", "g", "r"])
def test_exported_values_are_the_form_inside_its_domain(name):
    entry = resolve(name)
    fitted = entry.require_fitted()
    points = points_of(fitted.form)
    expected = jax.vmap(lambda x: fitted(*x))(points)
    codomain = entry.problem.calling.codomain
    expected = expected if codomain is None else np.clip(expected, *codomain)
    np.testing.assert_allclose(exported_values(entry, points), expected, atol=1e-13)


def test_exported_values_of_an_upright_fibre_are_those_of_the_clamped_material():
    # Figures 1 to 4 show θf = 0. The listing clamps it to 0.1 for c₀ … c₅, but not in u·t.
    entry = resolve("published/ps")
    c = np.asarray(entry.require_fitted().first(0.35, 0.1))
    theta_u = np.linspace(0, np.pi / 2, 9)
    points = np.stack([np.full(9, 0.35), np.zeros(9), theta_u, np.ones(9)], axis=-1)
    n = t = np.cos(theta_u)
    expected = c @ np.stack([n**0, n, t, n * n, n * t, t * t])
    np.testing.assert_allclose(exported_values(entry, points), expected, atol=1e-14)


def test_values_keep_the_shape_of_their_points():
    points = mesh(np.linspace(0.2, 1, 3), np.linspace(0.2, 1.5, 4))
    assert points.shape == (3, 4, 2)
    values = compared_values(problem("r"), points)
    assert list(values) == ["exact", "published", "refitted"]
    assert {each.shape for each in values.values()} == {(3, 4)}
    one = exported_values(resolve("r"), points[2, 1][None])
    assert values["refitted"][2, 1] == one[0]
    assert list(compared_values(problem("r"), points, [resolve("best/r-45")]))[1:] == ["best/r-45"]


def test_best_tables_come_in_the_order_of_their_errors():
    for owner in problems().values():
        found = best_tables(owner)
        assert {entry.name for entry in found} == {
            entry.name for entry in entries(owner) if entry.kind == "best"
        }
        largest = [entry.table.errors.off_grid.max for entry in found]
        assert largest == sorted(largest, reverse=True)


def test_errors_are_written_with_two_digits():
    written = [error_text(value) for value in (0.14, 0.1, 0.00198, 0.0009996, 8.025e-5, 0.0)]
    assert written == ["0.14", "0.10", "0.0020", "1.0e-3", "8.0e-5", "0.0e0"]


def test_every_table_of_two_axes_has_a_map_on_a_scale_that_holds_its_errors():
    owner = problem("g")
    figure = maps.draw_errors(owner)
    tables = [entry for entry in entries(owner) if entry.kind != "printed"]
    panels = {
        title.split(" ")[0]: axes
        for axes in figure.axes
        if "− exact" in (title := axes.get_title())
    }
    assert set(panels) == {label_of(entry) for entry in tables}
    for entry in tables:
        axes = panels[label_of(entry)]
        (image,) = (each for each in axes.collections if isinstance(each, QuadMesh))
        worst = np.abs(image.get_array()).max()
        low, high = image.get_clim()
        assert low == -high
        assert worst <= high <= 1.5 * worst
        assert error_text(worst) in axes.get_title()
        assert f"{operations_of(entry)} operations" in axes.get_title()


def test_the_first_picture_shows_the_gain_of_best_tables(monkeypatch):
    monkeypatch.setattr(ps_lights, "_PIXELS", 41)
    figure = ps_lights.draw_discs()
    factors, worst = {}, {}
    for axes in figure.axes:
        if "− exact" in axes.get_title():
            name = axes.get_title().split(" ")[0]
            factors[name] = float(axes.get_title().rsplit("× ", 1)[1])
            (image,) = axes.get_images()
            worst[name] = np.abs(image.get_array()).max()
            assert axes.get_xlabel() == f"largest {error_text(worst[name])}"
            # The same colour stands for an error that is smaller by the factor in the title.
            assert image.get_clim()[1] * factors[name] == pytest.approx(0.1)
            # No error of a best table exceeds its colour scale, for any material.
            table = resolve("published/ps" if name == "published" else name).table
            assert name == "published" or table.errors.off_grid.max <= image.get_clim()[1]
    assert list(factors) == ["published", "best/ps-25", "best/ps-40"]
    assert worst["published"] > 5 * worst["best/ps-25"] > 25 * worst["best/ps-40"]


def test_every_kind_of_table_has_a_style():
    for owner in problems().values():
        for entry in entries(owner):
            assert entry.kind in COLOURS.keys() & DASHES.keys() & MARKERS.keys()


def test_no_two_kinds_share_a_colour_a_dash_or_a_marker():
    for look in (COLOURS, DASHES, MARKERS):
        assert len({str(value) for value in look.values()}) == len(look)


@pytest.mark.parametrize(
    "quantity", ["q", *(pytest.param(name, marks=SLOW) for name in ("ps", "g", "r"))]
)
def test_every_table_has_its_mark(quantity):
    owner = problem(quantity)
    found = {mark.name: mark for mark in marks(owner)}
    closed_form = set() if owner.exact_code is None else {"closed form"}
    assert set(found) == {entry.name for entry in entries(owner)} | closed_form
    published = f"published/{quantity}"
    compared = compare([(name, resolve(name)) for name in (published, quantity)])
    for each in compared.contestants:
        mark = found[each.label]
        assert (mark.largest, mark.rms) == (each.errors.largest, each.errors.rms)
    # The operations of the listings' functions FuzzPs, FuzzGApprox, FuzzAveragePenetration (two
    # products, two sums, a clamp at both ends) and FuzzAveragePs, with the clamps of their code.
    assert found[published].operations == {"ps": 19, "g": 15, "q": 6, "r": 53}[quantity]
    if not closed_form:
        return
    # The closed form costs more, and has only the rounding error of float32.
    assert found["closed form"].operations > max(m.operations for m in found.values()) / 2
    assert 0 < found["closed form"].largest < 16 * np.finfo(np.float32).eps


def test_the_frontier_has_the_marks_that_no_other_beats():
    every = tuple(
        Mark(f"m{i}", "best", int(cost), float(error), 0.0)
        for i, (cost, error) in enumerate(zip(rng.integers(1, 9, 40), rng.random(40), strict=True))
    )
    best = best_so_far(every)
    for mark in every:
        beaten = any(
            other is not mark
            and other.operations <= mark.operations
            and other.largest <= mark.largest
            for other in every
        )
        assert (mark in best) == (not beaten)
    assert [m.operations for m in best] == sorted({m.operations for m in best})


def test_labels_of_the_frontier_do_not_cover_each_other(monkeypatch):
    costs = np.sort(rng.integers(10, 90, 14))
    errors = 0.1 * np.exp(-np.sort(6 * rng.random(14)))
    crowd = tuple(
        Mark(f"best/form-{i}", "best", int(cost), float(error), 0.0)
        for i, (cost, error) in enumerate(zip(costs, errors, strict=True))
    )
    monkeypatch.setattr(frontier, "marks", lambda owner: crowd)
    monkeypatch.setattr(frontier, "label_of_mark", lambda mark, owner: mark.name)
    monkeypatch.setattr(frontier, "problems", lambda: {"g": problem("g")})
    figure = frontier.draw_frontier()
    figure.draw_without_rendering()
    panel = figure.axes[0]
    # The boxes of the words: the box of a whole annotation contains its line, too.
    boxes = [Text.get_window_extent(text) for text in panel.texts]
    assert len(boxes) == len(crowd)
    assert not any(a.overlaps(b) for i, a in enumerate(boxes) for b in boxes[:i])


def test_a_closed_form_that_costs_far_more_does_not_squeeze_the_tables(monkeypatch):
    tables = [Mark(f"best/q-{i}", "best", i, 0.1 / i, 0.01) for i in (4, 9)]
    monkeypatch.setattr(frontier, "problems", lambda: {"q": problem("q")})
    for operations, drawn in ((20, True), (630, False)):
        every = (*tables, Mark("closed form", "exact", operations, 1e-7, 1e-8))
        monkeypatch.setattr(frontier, "marks", lambda owner, every=every: every)
        (panel,) = (axes for axes in frontier.draw_frontier().axes if axes.get_visible())
        assert (operations <= panel.get_xlim()[1]) == drawn
        assert ("closed form: 630 operations, error 1.0e-7" in panel.get_xlabel()) != drawn
        names = {text.get_text() for text in panel.texts}
        assert names == {"q-4, pole", "q-9, pole", *(["closed form"] if drawn else [])}


def test_curves_of_small_errors_can_be_told_apart():
    _, signed, logarithmic = curves.draw_curves(problem("q")).axes
    assert logarithmic.get_yscale() == "log"
    # The signed panel has one more line, the axis at zero, which is its last.
    for below, line in zip(logarithmic.get_lines(), signed.get_lines()[:-1], strict=True):
        np.testing.assert_array_equal(below.get_ydata(), np.abs(line.get_ydata()))
    low, high = logarithmic.get_ylim()
    heights = []
    for entry, text in zip(reversed(best_tables(problem("q"))), logarithmic.texts, strict=True):
        assert text.get_text() == entry.name
        assert low < entry.table.errors.off_grid.max < high
        heights.append(np.log(text.xy[1] / low) / np.log(high / low))
    assert np.diff(heights).min() > 0.055
    assert heights[-1] < 1


def test_rows_show_the_exchange():
    alphas, _, rows = ps_rows(9)
    best = rows[BEST]
    assert best.shape == (9, 9, 6)
    printed, corrected = rows["published, as printed"], rows["published, rows exchanged"]
    first, second = EXCHANGED
    np.testing.assert_array_equal(printed[..., first], corrected[..., second])
    np.testing.assert_array_equal(printed[..., second], corrected[..., first])
    # Near α = 0.15 the best coefficients of one material differ from any smooth fit.
    inner = alphas > 0.3
    for row in EXCHANGED:
        right = np.abs(corrected - best)[inner, :, row].max()
        assert right < 0.2 * np.abs(printed - best)[inner, :, row].max()
    # Where the fibre lies flat, P_s is even in u·t: the coefficient of (u·n)(u·t) is zero.
    np.testing.assert_allclose(best[:, -1, 4], 0, atol=1e-10)


def test_errors_by_material_are_those_of_the_lights():
    alphas, tilts, errors = ps_errors(5, 6)
    assert list(errors) == list(COMPARED)
    printed, corrected = (errors[label] for label in list(TABLES)[:2])
    assert np.max(errors["best/ps-40"][1]) < np.max(corrected[1]) / 20
    # At α = 1 every table gives P_s = ½, so that both tables are the same.
    assert printed[0][-1].max() < 1e-12
    assert np.mean(printed[0]) > 3 * np.mean(corrected[0])
    rms, largest = printed
    assert np.all(rms <= largest)
    lights = mesh(np.linspace(0.05, 1.5, 12), np.linspace(0, np.pi, 12)).reshape(-1, 2)
    points = np.concatenate([np.tile([alphas[1], tilts[3]], (144, 1)), lights], axis=1)
    apart = np.abs(
        exported_values(resolve(PRINTED), points) - exact(problem("ps").reference, points)
    )
    assert largest[1, 3] == pytest.approx(apart.max(), rel=0.2)


def test_a_picture_is_the_same_bytes_each_time():
    first, second = (render(pictures()["figure-6"].draw) for _ in range(2))
    assert first == second
    assert first["png"][:8] == b"\x89PNG\r\n\x1a\n"
    root = ElementTree.parse(io.BytesIO(first["svg"])).getroot()
    assert root.tag == f"{SVG}svg"
    assert b"dc:date" not in first["svg"]


def test_the_style_stays_inside_its_pictures():
    import matplotlib as mpl  # noqa: PLC0415

    before = dict(mpl.rcParams)
    render(lambda: Figure(figsize=(1, 1)))
    assert dict(mpl.rcParams) == before


def test_settings_of_the_user_change_no_picture():
    import matplotlib as mpl  # noqa: PLC0415

    def draw():
        figure = Figure(figsize=(1, 1))
        figure.subplots().plot([1, 2])
        return figure

    plain = render(draw)
    with mpl.rc_context({"axes.linewidth": 5, "svg.fonttype": "none", "savefig.facecolor": "red"}):
        assert render(draw) == plain


def test_named_pictures_are_written_and_others_refused(tmp_path, capsys):
    assert main_status("figures", "figure-6", "--out", str(tmp_path)) == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == ["figure-6.png", "figure-6.svg"]
    capsys.readouterr()
    assert main_status("figures", "figure-6", "Ps", "--out", str(tmp_path / "none")) == 2
    assert not (tmp_path / "none").exists()
    said = capsys.readouterr().err
    assert said.startswith("shadefit: no figure is called 'Ps': allowed are ps, fig")


@pytest.fixture
def without_photographs(monkeypatch):
    real = optional_libraries.importlib.import_module

    def absent(name):
        if name == "skimage.data":
            raise ModuleNotFoundError(name)
        return real(name)

    monkeypatch.setattr(optional_libraries.importlib, "import_module", absent)


def test_a_picture_whose_library_is_absent_is_refused_in_one_line(
    tmp_path, capsys, without_photographs
):
    out = tmp_path / "none"
    assert main_status("figures", "detail-operators", "detail-photograph", "--out", str(out)) == 2
    said = capsys.readouterr().err
    assert said == (
        "shadefit: drawing photographs needs the library skimage: "
        "install it by pip install scikit-image\n"
    )
    assert not out.exists()


def test_without_names_pictures_whose_library_is_absent_are_left_out(
    tmp_path, capsys, without_photographs, monkeypatch
):
    both = {
        "plain": Picture("Plain", "A plain one.", lambda: Figure((1, 1))),
        "photo": Picture("Photo", "A photo.", lambda: Figure((1, 1)), ("skimage.data",)),
    }
    monkeypatch.setattr(figures, "pictures", lambda: both)
    assert main_status("figures", "--out", str(tmp_path)) == 0
    said = capsys.readouterr().err
    assert said.count("photo is not drawn: ") == 1
    assert said.splitlines()[0].endswith("pip install scikit-image")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["plain.png", "plain.svg"]
    assert list(drawable(both)[0]) == ["plain"]


def test_curves_of_detail_operators_pass_through_the_detail():
    panels = detail_maps.draw_operators().axes
    assert len(panels) == 3
    for axes in panels:
        lines = [line for line in axes.get_lines() if line.get_label().startswith("d = ")]
        for line, detail in zip(lines, np.linspace(0, 1, 11), strict=True):
            s, f = np.array(line.get_data())
            assert line.get_label() == f"d = {detail:.1f}"
            assert f[s == 0.5] == pytest.approx(detail, abs=1e-6)
            assert np.diff(f).min() >= -1e-6


def test_shares_of_errors_hold_every_value():
    codes = np.array([[-30.0, -10.0, 0.0, 0.0], [1.0, 3.0, 10.0, 11.0]])
    shares = detail_maps._shares(codes)
    assert len(shares) == 21
    assert shares.sum() == 1
    assert shares[[0, 10, 11, 13, 20]].tolist() == [0.25, 0.25, 0.125, 0.125, 0.25]


@SLOW
def test_the_closed_loop_of_the_photograph_has_the_least_error():
    target, _, results = detail_maps.composed()
    overlay, smooth, closed = results.values()
    assert closed.errors.rmse < smooth.errors.rmse < overlay.errors.rmse
    for each in results.values():
        assert np.sqrt(np.mean(each.codes**2)) == pytest.approx(each.errors.rmse)
        assert each.seen.shape == target.shape == (256, 256, 3)


def main_status(*arguments):
    with pytest.raises(SystemExit) as stopped:
        main(list(arguments))
    return stopped.value.code or 0


def test_pictures_are_declared_for_the_quantities_of_the_fuzz_brdf():
    assert set(DRAWN) == {each for each in problems().values() if each.topic == "fuzz"}


@pytest.mark.parametrize("axes", [(X,), (X, ANGLE)])
def test_a_registered_quantity_is_drawn_without_more_code(registered, axes):
    known = set(pictures())
    registered(new_problem(*axes))
    assert set(pictures()) == known | {"errors-new"}
    picture = pictures()["errors-new"]
    assert picture.title == "Errors of N_w"
    # There are no tables to draw: only the exact values.
    assert len(picture.draw().axes) == len(axes)
    assert render(picture.draw)["svg"]


def test_a_quantity_has_a_panel_of_the_frontier_if_it_has_marks_to_compare(registered, monkeypatch):
    owner = registered(new_problem(X))
    assert marks(owner) == ()
    two = tuple(Mark(f"best/n-{i}", "best", 5 + i, 0.1 / (1 + i), 0.01) for i in range(2))
    few = {"q": two[:1], "new": two}
    monkeypatch.setattr(frontier, "problems", lambda: {"q": problem("q"), "new": owner})
    monkeypatch.setattr(frontier, "marks", lambda owner: few[owner.name])
    monkeypatch.setattr(frontier, "label_of_mark", lambda mark, owner: mark.name)
    panels = [axes for axes in frontier.draw_frontier().axes if axes.get_visible()]
    assert [axes.get_title() for axes in panels] == ["$N_w$"]


def test_pictures_follow_the_hints(registered):
    hint = AxisHint("$x$", 1.0, 100.0, 2.0, logarithmic=True, factor=2.0, unit="mm")
    plot = PlotHints({"x": hint}, values=(-1.0, 1.0), value_label="N", exact_label="cosine")
    registered(new_problem(X, plot=plot))
    (axes,) = pictures()["errors-new"].draw().axes
    assert axes.get_xlabel() == "$x$ / mm"
    assert axes.get_ylabel() == "N"
    assert axes.get_xscale() == "log"
    assert axes.get_xlim() == (2.0, 200.0)
    assert axes.get_ylim() == pytest.approx((-1.0, 1.06))
    (curve,) = axes.get_lines()
    x, y = np.array(curve.get_data(), float)
    np.testing.assert_allclose(y, np.cos(x / 2), atol=1e-12)


def test_tables_of_a_quantity_are_drawn_when_they_are_kept():
    # r(k) has one axis, and a refitted table but no published one.
    owner = problem("velvet")
    assert list(compared_values(owner, np.array([[-0.5]]))) == ["exact", "refitted"]
    above, below, logarithmic = curves.draw_curves(owner).axes
    assert len(above.get_lines()) == 2
    assert len(logarithmic.texts) == 0
    errors = below.get_lines()[0].get_ydata()
    assert np.max(errors) <= 0


def test_axes_without_hints_are_drawn_over_their_finite_domain():
    (_, first), (_, second) = axis_hints(new_problem(X, ANGLE))
    assert (first.lower, first.upper) == (0.0, 1.0)
    assert second.lower == pytest.approx(np.pi / 1000)
    assert (second.upper * second.factor, second.unit) == (pytest.approx(180), "°")
    assert second.lower < second.start < second.upper


def test_a_search_is_drawn_without_a_published_table_too():
    found = [
        Found(f"f{i}", "best", "pole-q", "a", 1, 4 + i, 0.01, 0.1 / (1 + i), None, None, None)
        for i in range(3)
    ]
    for published in (None, found[0]):
        drawn = search.draw(problem("q"), Result(found, found[:2], published, [], 0))
        assert set(drawn) == {"png", "svg"}


def test_the_gallery_shows_every_picture():
    text = (DOCS / "gallery.md").read_text(encoding="utf-8")
    for name, picture in pictures().items():
        assert f"(figures/{name}.png)" in text
        assert f"(figures/{name}.svg)" in text
        assert picture.title in text
        # The caption is wrapped there.
        assert " ".join(picture.caption.split()) in " ".join(text.split())
    for path in re.findall(r"\((figures/[^)]+)\)", text):
        assert (DOCS / path).is_file(), path
    # `make figures` also writes an EXR file there, which is not committed.
    for path in (DOCS / "figures").iterdir():
        assert path.suffix == ".exr" or f"(figures/{path.name})" in text, path


def test_committed_pictures_are_small_and_can_be_read():
    total = 0
    for name in pictures():
        png = (DOCS / "figures" / f"{name}.png").read_bytes()
        width, height = struct.unpack(">II", png[16:24])
        assert 500 <= width <= 1300
        assert 300 <= height <= 1700
        svg = (DOCS / "figures" / f"{name}.svg").read_bytes()
        ElementTree.fromstring(svg)
        total += len(png) + len(svg)
    assert total < 13_500_000


@pytest.mark.slow
@pytest.mark.parametrize("name", pictures())
def test_every_picture_is_drawn_the_same_twice(name):
    assert render(pictures()[name].draw) == render(pictures()[name].draw)


def test_a_table_without_a_published_form_is_not_called_refitted():
    (_, legend) = curves.draw_curves(problem("velvet")).axes[0].get_legend().get_texts()
    assert legend.get_text() == "fitted table"
    said = [
        text.get_text()
        for text in curves.draw_curves(problem("q")).axes[0].get_legend().get_texts()
    ]
    assert "refitted, same form" in said
