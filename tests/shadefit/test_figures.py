"""Pictures: what is drawn is what the tables and integrals say, and drawn the same each time."""

import io
import re
import struct
from pathlib import Path
from xml.etree import ElementTree

import jax
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

from coefficients.catalogue import form_of, load
from coefficients.compare import compare
from integrals import PS
from shadefit.cli import main
from shadefit.figures import PICTURES, frontier, render, run
from shadefit.figures.frontier import Mark, best_so_far, marks
from shadefit.figures.materials import EXCHANGED, PRINTED, TABLES, ps_errors, ps_rows
from shadefit.figures.style import COLOURS, DASHES, MARKERS
from shadefit.figures.values import exact, exported, kind_of, mesh, quantities, tables_of

DOCS = Path(__file__).parents[2] / "docs"
SVG = "{http://www.w3.org/2000/svg}"
SLOW = pytest.mark.slow
rng = np.random.default_rng(6)


def points_of(form, count=300):
    low, high = np.array([(axis.lower, axis.upper) for axis in form.axes]).T
    return low + (high - low) * rng.random((count, len(form.axes)))


@pytest.mark.parametrize("name", ["published/ps", "g", "r"])
def test_exported_values_are_the_form_inside_its_domain(name):
    form = form_of(load(name))
    points = points_of(type(form))
    expected = jax.vmap(lambda x: form(*x))(points)
    np.testing.assert_allclose(exported(name, points), expected, atol=1e-13)


def test_exported_values_of_an_upright_fibre_are_those_of_the_clamped_material():
    # Figures 1 to 4 show θf = 0, which the listing clamps to 0.1 for c₀ … c₅ but not in u·t.
    form = form_of(load("published/ps"))
    c = np.asarray(form.material(0.35, 0.1))
    theta_u = np.linspace(0, np.pi / 2, 9)
    points = np.stack([np.full(9, 0.35), np.zeros(9), theta_u, np.ones(9)], axis=-1)
    n = t = np.cos(theta_u)
    expected = c @ np.stack([n**0, n, t, n * n, n * t, t * t])
    np.testing.assert_allclose(exported("published/ps", points), expected, atol=1e-14)


def test_values_keep_the_shape_of_their_points():
    points = mesh(np.linspace(0.2, 1, 3), np.linspace(0.2, 1.5, 4))
    assert points.shape == (3, 4, 2)
    assert exported("r", points).shape == (3, 4)
    assert exported("r", points)[2, 1] == exported("r", points[2, 1][None])[0]


def test_tables_are_listed_with_what_they_are():
    assert quantities() == ["ps", "g", "q", "r"]
    assert tables_of("ps")[:3] == ["published/ps@printed", "published/ps", "ps"]
    assert [kind_of(name) for name in tables_of("ps")[:3]] == ["printed", "published", "refitted"]
    assert kind_of("best/ps-9") == "best"
    for quantity in quantities():
        for name in tables_of(quantity):
            assert load(name).quantity == quantity
            assert kind_of(name) in COLOURS.keys() & DASHES.keys() & MARKERS.keys()


def test_no_two_kinds_share_a_colour_a_dash_or_a_marker():
    for look in (COLOURS, DASHES, MARKERS):
        assert len({str(value) for value in look.values()}) == len(look)


@pytest.mark.parametrize(
    "quantity", ["q", *(pytest.param(name, marks=SLOW) for name in ("ps", "g", "r"))]
)
def test_every_table_has_its_mark(quantity):
    found = {mark.name: mark for mark in marks(quantity)}
    exact = set() if quantity == "r" else {"closed form"}
    assert set(found) == {*tables_of(quantity)} | exact
    published = f"published/{quantity}"
    entries = compare([(name, load(name)) for name in (published, quantity)]).entries
    for entry in entries:
        mark = found[entry.label]
        assert (mark.largest, mark.rms) == (entry.errors.largest, entry.errors.rms)
    # As listed: FuzzPs, FuzzGApprox, FuzzAveragePenetration (two products, two sums, a clamp).
    assert found[published].operations == {"ps": 13, "g": 12, "q": 5, "r": 53}[quantity]
    if quantity == "r":
        return
    # The closed form costs more and errs by rounding alone: a few units of float32.
    assert found["closed form"].operations > max(m.operations for m in found.values()) / 2
    assert 0 < found["closed form"].largest < 16 * np.finfo(np.float32).eps


def test_the_frontier_is_what_nothing_beats():
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
    monkeypatch.setattr(frontier, "marks", lambda quantity: crowd)
    monkeypatch.setattr(frontier, "quantities", lambda: ["g"])
    figure = frontier.draw_frontier()
    figure.draw_without_rendering()
    panel = figure.axes[0]
    # Of the words alone: an annotation's own box takes in its line.
    boxes = [Text.get_window_extent(text) for text in panel.texts]
    assert len(boxes) == len(crowd)
    assert not any(a.overlaps(b) for i, a in enumerate(boxes) for b in boxes[:i])


def test_rows_show_the_exchange():
    alphas, _, rows = ps_rows(9)
    best = rows["best in each cell"]
    assert best.shape == (9, 9, 6)
    printed, corrected = rows["published, as printed"], rows["published, rows exchanged"]
    first, second = EXCHANGED
    np.testing.assert_array_equal(printed[..., first], corrected[..., second])
    np.testing.assert_array_equal(printed[..., second], corrected[..., first])
    # Away from α = 0.15, where least squares in a cell and a smooth fit part.
    inner = alphas > 0.3
    for row in EXCHANGED:
        right = np.abs(corrected - best)[inner, :, row].max()
        assert right < 0.2 * np.abs(printed - best)[inner, :, row].max()
    # By symmetry of the integral, (u·n)(u·t) has no part in it where the fibre lies flat.
    np.testing.assert_allclose(best[:, -1, 4], 0, atol=1e-10)


def test_errors_by_material_are_those_of_the_lights():
    alphas, tilts, errors = ps_errors(5, 6)
    assert list(errors) == list(TABLES)
    printed, corrected = (errors[label] for label in list(TABLES)[:2])
    # P_s is ½ at α = 1 in every table: both are the same there.
    assert printed[0][-1].max() < 1e-12
    assert np.mean(printed[0]) > 3 * np.mean(corrected[0])
    rms, largest = printed
    assert np.all(rms <= largest)
    lights = mesh(np.linspace(0.05, 1.5, 12), np.linspace(0, np.pi, 12)).reshape(-1, 2)
    points = np.concatenate([np.tile([alphas[1], tilts[3]], (144, 1)), lights], axis=1)
    apart = np.abs(exported(PRINTED, points) - exact(PS, points))
    assert largest[1, 3] == pytest.approx(apart.max(), rel=0.2)


def test_a_picture_is_the_same_bytes_each_time():
    first, second = (render(PICTURES["figure-6"].draw) for _ in range(2))
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


def test_named_pictures_are_written_and_others_refused(tmp_path, capsys):
    run(["figure-6"], tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["figure-6.png", "figure-6.svg"]
    with pytest.raises(ValueError, match=r"no figure is called 'figure-8': allowed are ps, fig"):
        run(["figure-6", "figure-8"], tmp_path / "none")
    assert not (tmp_path / "none").exists()
    with pytest.raises(SystemExit) as stopped:
        main(["figures", "Ps", "--out", str(tmp_path / "none")])
    assert stopped.value.code == 2
    assert capsys.readouterr().err.startswith("shadefit: no figure is called 'Ps'")


def test_the_gallery_shows_every_picture():
    text = (DOCS / "gallery.md").read_text(encoding="utf-8")
    for name, picture in PICTURES.items():
        assert f"(figures/{name}.png)" in text
        assert f"(figures/{name}.svg)" in text
        assert picture.title in text
    for path in re.findall(r"\((figures/[^)]+)\)", text):
        assert (DOCS / path).is_file(), path


def test_committed_pictures_are_small_and_can_be_read():
    total = 0
    for name in PICTURES:
        png = (DOCS / "figures" / f"{name}.png").read_bytes()
        width, height = struct.unpack(">II", png[16:24])
        assert 500 <= width <= 1300
        assert 350 <= height <= 1000
        svg = (DOCS / "figures" / f"{name}.svg").read_bytes()
        ElementTree.fromstring(svg)
        total += len(png) + len(svg)
    assert total < 4_200_000


@pytest.mark.slow
@pytest.mark.parametrize("name", PICTURES)
def test_every_picture_is_drawn_the_same_twice(name):
    assert render(PICTURES[name].draw) == render(PICTURES[name].draw)
