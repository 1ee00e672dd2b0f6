import json
import math
from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from coefficients import catalogue
from coefficients.catalogue import (
    FOLDER,
    PUBLISHED,
    QUANTITIES,
    SINGLE_FORMS,
    corrected,
    form_of,
    from_fit,
    load,
    names,
    names_of_best,
)
from coefficients.table import parse, read, serialise
from fitting import Certificate, Errors, Fit, QuadraticQ, RationalG
from fitting.points.grids import gauss_grid


def test_every_name_that_is_listed_loads():
    listed = names()
    assert listed == [
        *("g", "ps", "q", "r", "velvet"),
        *names_of_best(),
        *("published/g", "published/ps", "published/q", "published/r"),
        "published/ps@printed",
    ]
    for name in listed:
        stem = name.rpartition("/")[2].removesuffix("@printed")
        assert (load(name).name, load(name).quantity) == (stem, stem.partition("-")[0])
        assert (load(name).publication is not None) == name.startswith("published/")


def test_a_refitted_table_has_all_that_is_known_of_it():
    for quantity in QUANTITIES:
        table = load(quantity)
        assert load(f"refit/{quantity}") == table
        for part in ("grid", "weight", "reference", "errors", "certificates", "provenance"):
            assert getattr(table, part) is not None, part


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_a_table_holds_a_form_of_the_shape_that_its_names_say(quantity):
    for name in (quantity, f"published/{quantity}") if quantity in PUBLISHED else (quantity,):
        table = load(name)
        form = form_of(table)
        assert type(form) is SINGLE_FORMS[table.form]
        assert table.equation == form.equation
        assert table.coefficient_names == form.coefficient_names()
        assert np.asarray(form.coefficients).tolist() == table.coefficients
        axes = [(axis.name, axis.unit, [axis.lower, axis.upper]) for axis in form.axes]
        assert [(a.name, a.unit, a.domain) for a in table.arguments] == axes


def test_a_path_is_read_and_a_published_table_in_it_corrected(tmp_path):
    path = tmp_path / "mine.json"
    path.write_text(serialise(load("published/ps@printed")))
    assert load(str(path)) == load("published/ps")
    other = tmp_path / "without-suffix"
    other.write_text(serialise(load("q")))
    assert load(str(other)) == load("q")


NAMES = [
    "",
    "s",
    "PS",
    "published",
    "published/",
    "published/s",
    "published/ps@corrected",
    "published/ps@printed@printed",
    "ps@printed",
    "refit/ps@printed",
    "../refit/ps",
    "published/../refit/ps",
    "/etc/passwd",
    "ps.json.json",
    "no-such-file.json",
    "ps\0",
    "ps\n",
    "x" * 5000,
    "@printed",
]


@pytest.mark.parametrize("name", NAMES, ids=lambda name: repr(name[:30]))
def test_what_is_no_name_and_no_file_is_refused_in_one_line(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError) as error:
        load(name)
    assert type(error.value) is ValueError
    assert str(error.value).isprintable()


def test_a_refusal_says_what_is_allowed():
    with pytest.raises(ValueError, match="'s': allowed are ps, g, q, r, velvet, published/ps"):
        load("s")


def test_a_name_is_not_taken_from_the_folder_that_one_is_in(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ps").write_text("not a table")
    (tmp_path / "ps.json").write_text("not a table")
    assert load("ps") == read(FOLDER / "refit" / "ps.json")
    with pytest.raises(ValueError, match="no JSON table"):
        load("ps.json")


@pytest.mark.parametrize("name", names())
def test_a_table_that_is_written_and_read_is_the_same(name, tmp_path):
    """Errata that are applied are not applied again; as printed, they are, as to any file."""
    table, path = load(name), tmp_path / "table.json"
    path.write_text(serialise(table))
    assert load(str(path)) == corrected(table)
    assert corrected(corrected(table)) == corrected(table)


@pytest.mark.parametrize("rows", [[3, 6], [-1, 3], [0, 100]])
def test_an_erratum_about_rows_that_do_not_exist_is_refused(rows):
    data = json.loads(serialise(load("published/ps@printed")))
    data["publication"]["errata"][0]["exchange_rows"] = rows
    with pytest.raises(ValueError, match="rows-3-4 exchanges rows that do not exist"):
        corrected(parse(json.dumps(data), "itself"))


def test_errata_are_applied_in_their_order():
    data = json.loads(serialise(load("published/ps@printed")))
    errata = data["publication"]["errata"]
    errata.append({**errata[0], "id": "again"})
    assert corrected(parse(json.dumps(data), "itself")).coefficients == data["coefficients"]
    errata[-1]["exchange_rows"] = [0, 3]
    moved = corrected(parse(json.dumps(data), "itself")).coefficients
    assert moved == [data["coefficients"][row] for row in (4, 1, 2, 0, 3, 5)]


WRONG = {
    "an unknown form": ({"form": "rational-x"}, "'rational-x' of g is not known"),
    "a form of another quantity": ({"quantity": "q"}, "is one of g, not q"),
    "too many coefficients": (
        {"coefficients": [1.0] * 5, "coefficient_names": ["c"] * 5},
        r"\(5,\).*takes \(4,\)",
    ),
    "rows where there are none": (
        {"coefficients": [[1.0] * 4], "coefficient_names": [["c"] * 4]},
        r"\(1, 4\).*takes \(4,\)",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_table_that_is_no_table_of_its_form_is_refused(name):
    change, message = WRONG[name]
    data = {**json.loads(serialise(load("published/g"))), **change}
    with pytest.raises(ValueError, match=message):
        form_of(parse(json.dumps(data), "itself"))


G_ARGUMENTS = json.loads(serialise(load("published/g")))["arguments"]
G_NAMES = RationalG.coefficient_names()
CONTRADICTIONS = {
    "a unit": (
        {"arguments": [{**G_ARGUMENTS[0], "unit": "rad"}, G_ARGUMENTS[1]]},
        "the unit of density as 'rad', form 'rational-g' has '1'",
    ),
    "a domain": (
        {"arguments": [{**G_ARGUMENTS[0], "domain": [0, 50]}, G_ARGUMENTS[1]]},
        r"the domain of density as \[0.0, 50.0\], form 'rational-g' has \[0.001, 0.5\]",
    ),
    "arguments the other way round": (
        {"arguments": G_ARGUMENTS[::-1]},
        r"arguments as \['cos_v', 'density'\], form 'rational-g' has \['density', 'cos_v'\]",
    ),
    "an argument twice": ({"arguments": [*G_ARGUMENTS, G_ARGUMENTS[1]]}, "g gives arguments as"),
    "one argument": ({"arguments": G_ARGUMENTS[:1]}, r"arguments as \['density'\]"),
    "names the other way round": (
        {"coefficient_names": G_NAMES[::-1]},
        "the name of coefficient 0 as 'c3: ν³', form 'rational-g' has 'c0: dν'",
    ),
    "a long name": (
        {"coefficient_names": [*G_NAMES[:3], "c" * 2000]},
        r"the name of coefficient 3 as 'c+\.\.\.c+', form",
    ),
}


@pytest.mark.parametrize("name", CONTRADICTIONS)
def test_a_table_that_contradicts_its_form_is_refused(name):
    change, message = CONTRADICTIONS[name]
    data = {**json.loads(serialise(load("published/g"))), **change}
    with pytest.raises(ValueError, match=message) as error:
        form_of(parse(json.dumps(data), "itself"))
    assert str(error.value).isprintable()


def test_a_domain_is_the_same_after_rounding():
    data = json.loads(serialise(load("published/r")))
    data["arguments"][0]["domain"][0] = float(np.float32(0.15))
    data["arguments"][1]["domain"][1] = 1.570796
    form_of(parse(json.dumps(data), "itself"))


def fit_of(form, bound: float = 0.5) -> Fit:
    """Give a fit with made-up results, to be written down."""
    grid = gauss_grid(type(form).axes, 9)
    where = {axis.name: axis.lower for axis in type(form).axes}
    return Fit(
        form=form,
        grid=grid,
        weight="uniform",
        directions=7,
        solver="by hand",
        reference_error=1e-15,
        on_grid=Errors(0.1, 0.2, where, 81),
        off_grid=Errors(0.3, 0.4, where, 99),
        certificate=Certificate(bound, 11),
    )


def test_a_fit_is_written_down_whole():
    coefficients = [-0.9, 0.4, 0.7, -0.26]
    table = from_fit(fit_of(RationalG(jnp.array(coefficients))), "make it")
    assert table.coefficients == coefficients
    assert (table.name, table.form, table.equation) == ("g", "rational-g", "Eq. (3)")
    assert [(n.argument, n.count, n.spacing) for n in table.grid.nodes] == [
        ("density", 9, "gauss-legendre"),
        ("cos_v", 9, "gauss-legendre"),
    ]
    assert (table.grid.directions, table.weight) == (7, "uniform")
    assert (table.reference.leg, table.reference.error) == ("closed_form", 1e-15)
    on, off = table.errors.on_grid, table.errors.off_grid
    assert (on.rms, on.max, on.points, off.rms, off.max, off.points) == (0.1, 0.2, 81, 0.3, 0.4, 99)
    assert on.where == {"density": 0.001, "cos_v": 0.001}
    assert (table.certificates.denominator_bound, table.certificates.boxes) == (0.5, 11)
    assert (table.provenance.command, table.provenance.solver) == ("make it", "by hand")
    assert table.provenance.versions["jax"] == "0.10.2"
    assert parse(serialise(table), "itself") == table


def test_a_form_without_denominators_has_no_bound_in_its_table():
    table = from_fit(fit_of(QuadraticQ(jnp.array([-1.7, 1.2])), math.inf), "make it")
    assert table.certificates.denominator_bound is None
    assert "denominator_bound" not in serialise(table)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_a_fit_that_is_no_number_is_not_written_down(bad):
    good = fit_of(QuadraticQ(jnp.array([-1.7, 1.2])))
    with pytest.raises(ValueError, match="no JSON number"):
        from_fit(replace(good, form=QuadraticQ(jnp.array([bad, 1.2]))), "make it")
    with pytest.raises(ValueError, match="no JSON number"):
        from_fit(replace(good, off_grid=Errors(bad, 0.4, {"density": 0.1}, 9)), "make it")


def test_nothing_in_a_table_tells_when_or_where_it_was_made(monkeypatch, tmp_path):
    form = QuadraticQ(jnp.array([-1.7, 1.2]))
    first = serialise(from_fit(fit_of(form), "make it"))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HOME", str(tmp_path))
    assert serialise(from_fit(fit_of(form), "make it")) == first
    assert str(catalogue.FOLDER) not in first
