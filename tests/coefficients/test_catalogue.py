"""What names stand for: tables that are kept here, files, and closed forms."""

import json

import numpy as np
import pytest

from coefficients import catalogue
from coefficients.catalogue import (
    entries,
    path_of,
    printed,
    published,
    refitted,
    resolve,
    with_published,
)
from coefficients.packaged import FOLDER, corrected, names, names_of_best
from coefficients.table import Table, parse, read, serialise
from programs import trace
from quantities import problem, problems

QUANTITIES = ("ps", "g", "q", "r", "velvet")
_GGX = ("ggx-directional-albedo", "ggx-scale", "ggx-bias")
_SORTED = ("blue", "green", "red")
_SKIN = tuple(f"skin-{s}-{c}" for s in ("cylinder", "sphere") for c in ("red", "green", "blue"))
PUBLISHED = (
    "ps",
    "g",
    "q",
    "r",
    *_GGX,
    "sggx-filter",
    "sggx-filter-axes",
    *_SKIN,
    "skin-lobe-sphere",
)
# Constants of two sources are in print for these.
SECOND = (
    *("sggx-filter-lean", "sggx-filter-axes-lean"),
    *(f"skin-cylinder-{channel}-yeung" for channel in _SORTED),
)
CLOSED_FORMS = ("exact/ps", "exact/g", "exact/q", "exact/velvet")


def table_of(name: str) -> Table:
    return resolve(name).require_table()


# Names


def test_every_listed_name_resolves():
    listed = names()
    assert list(listed) == [
        "g",
        *("ggx-average-albedo", "ggx-bias", "ggx-directional-albedo", "ggx-scale"),
        *("ps", "q", "r", "sggx-filter-axes", "sggx-filter"),
        *(f"skin-{s}-{c}" for s in ("band-1", "band-2", "cylinder") for c in _SORTED),
        *("skin-lobe-cylinder", "skin-lobe-sphere"),
        *(f"skin-sphere-{c}" for c in _SORTED),
        "velvet",
        *names_of_best(),
        *(f"published/{each}" for each in sorted((*PUBLISHED, *SECOND), key=lambda x: f"{x}.json")),
        "published/ps@printed",
    ]
    for name in listed:
        entry, stem = resolve(name), name.rpartition("/")[2].removesuffix("@printed")
        table = entry.require_table()
        assert (entry.name, table.name) == (name, stem)
        assert table.quantity == entry.problem.name
        assert stem == table.quantity or stem.startswith(f"{table.quantity}-")
        assert (table.publication is not None) == name.startswith("published/")


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("ps", "refitted"),
        ("velvet", "refitted"),
        ("best/q-9", "best"),
        ("best/ps-40-wide", "best"),
        ("published/g", "published"),
        ("published/ps@printed", "printed"),
    ],
)
def test_each_kind_of_table_is_told_apart(name, kind):
    entry = resolve(name)
    assert (entry.name, entry.kind) == (name, kind)
    assert entry.require_fitted().form.name == entry.require_table().form
    assert entry.axes == entry.require_fitted().axes
    assert entry.equation == entry.require_table().equation
    assert entry.remark == entry.problem.calling.remark
    assert entry.problem is problem(entry.require_table().quantity)


def test_a_published_table_is_corrected_unless_it_is_asked_for_as_printed():
    raw = read(FOLDER / "fuzz" / "published" / "ps.json")
    assert table_of("published/ps@printed") == raw
    assert table_of("published/ps") == corrected(raw) != raw
    # The errata of the others change no coefficient, so that both are the same.
    assert "published/g@printed" not in names()
    assert table_of("published/g@printed").coefficients == table_of("published/g").coefficients


def test_a_name_is_resolved_once():
    assert resolve("best/g-9") is resolve("best/g-9")


@pytest.mark.parametrize("name", CLOSED_FORMS)
def test_a_closed_form_has_code_but_no_table(name):
    entry, owner = resolve(name), problem(name.partition("/")[2])
    assert (entry.kind, entry.problem, entry.table, entry.fitted) == ("exact", owner, None, None)
    assert entry.axes == owner.exact_code.axes
    assert entry.equation == owner.exact_code.equation
    assert entry.remark == owner.exact_code.remark
    (function,) = entry.functions()
    points = np.array([[axis.upper for axis in entry.axes]])
    (columns,) = entry.arguments_at(points)
    assert columns.shape == (1, len(function.parameters))
    for require in (entry.require_table, entry.require_fitted):
        with pytest.raises(ValueError) as caught:
            require()
        assert str(caught.value) == (
            f"{name} has no coefficients: allowed is {name} with --to LANG"
        )


def test_the_closed_form_of_p_s_takes_more_steps_in_double():
    entry = resolve("exact/ps")
    single, double = (trace(entry.functions(each)[0]) for each in ("float", "double"))
    assert len(double.steps) > len(single.steps)


@pytest.mark.parametrize("name", ["exact/r", "exact/", "exact/best/q-9", "exact/PS"])
def test_an_unknown_closed_form_is_refused(name):
    with pytest.raises(ValueError) as caught:
        resolve(name)
    assert str(caught.value) == (
        f"no closed form is exported as {name!r}: allowed are {', '.join(CLOSED_FORMS)} and "
        "tables' names"
    )


# Files


def test_a_path_is_read_and_a_published_table_in_it_corrected(tmp_path):
    path = tmp_path / "mine.json"
    path.write_text(serialise(table_of("published/ps@printed")))
    entry = resolve(str(path))
    assert (entry.name, entry.kind, entry.problem) == (str(path), "file", problem("ps"))
    assert entry.table == table_of("published/ps")
    other = tmp_path / "without-suffix"
    other.write_text(serialise(table_of("q")))
    assert table_of(str(other)) == table_of("q")


def test_a_name_is_not_taken_from_the_working_directory(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ps").write_text("not a table")
    (tmp_path / "ps.json").write_text("not a table")
    assert table_of("ps") == read(FOLDER / "fuzz" / "refit" / "ps.json")
    with pytest.raises(ValueError, match="no JSON table"):
        resolve("ps.json")


def test_a_file_in_a_folder_called_exact_is_a_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "exact").mkdir()
    (tmp_path / "exact" / "mine.json").write_text(serialise(table_of("q")))
    assert resolve("exact/mine.json").kind == "file"
    with pytest.raises(ValueError, match=r"exact/none\.json cannot be read: No such file"):
        resolve("exact/none.json")


def test_a_file_about_an_unknown_quantity_is_read_by_its_expression(tmp_path):
    data = {**json.loads(serialise(table_of("best/q-9"))), "quantity": "s"}
    path = tmp_path / "s.json"
    path.write_text(json.dumps(data))
    entry = resolve(str(path))
    assert entry.problem.name == "s"
    assert not entry.problem.reference.legs
    assert float(entry.require_fitted()(0.2)) == float(resolve("best/q-9").require_fitted()(0.2))


def test_a_file_about_an_unknown_quantity_without_expression_is_refused(tmp_path):
    data = {**json.loads(serialise(table_of("q"))), "quantity": "s", "schema": "shadefit.table/1"}
    del data["expression"]
    path = tmp_path / "s.json"
    path.write_text(json.dumps(data))
    with pytest.raises(ValueError, match="no quantity is called 's': allowed are ps, g, q, r, vel"):
        resolve(str(path))


def test_a_file_of_a_shape_without_slopes_is_read(tmp_path):
    """Surfaces of degree 0 are allowed, and are constants."""
    data = json.loads(serialise(table_of("best/ps-11")))
    form = problem("ps").find_form("one-root-ps", {**data["shape"], "degree": 0})
    data.update(
        shape=form.shape,
        equation=form.equation,
        coefficients=[0.2, 0.5, 0.1, -0.9][: form.size] + [0.0] * (form.size - 4),
        coefficient_names=form.coefficient_names,
        schema="shadefit.table/1",
    )
    del data["expression"]
    path = tmp_path / "constant.json"
    path.write_text(json.dumps(data))
    assert resolve(str(path)).require_fitted().form is form


NO_NAMES = [
    "",
    "s",
    "PS",
    "published",
    "published/",
    "published/s",
    "published/velvet",
    "published/ps@corrected",
    "published/ps@printed@printed",
    "ps@printed",
    "best/q-9@printed",
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


@pytest.mark.parametrize("name", NO_NAMES, ids=lambda name: repr(name[:30]))
def test_other_names_are_refused_in_one_line(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError) as error:
        resolve(name)
    assert type(error.value) is ValueError
    assert str(error.value).isprintable()


def test_a_refusal_says_what_is_allowed():
    with pytest.raises(ValueError, match="'s': allowed are ps, g, q, r, velvet, ggx-dir"):
        resolve("s")
    with pytest.raises(ValueError, match="ps is not published: allowed is ps without @printed"):
        resolve("ps@printed")


# Lists of entries


def test_entries_are_listed_in_the_order_of_their_names():
    assert [entry.name for entry in entries()] == list(names())


def test_entries_of_a_quantity_are_listed_by_kind():
    found = [(entry.kind, entry.name) for entry in entries(problem("ps"))]
    assert found[:3] == [
        ("printed", "published/ps@printed"),
        ("published", "published/ps"),
        ("refitted", "ps"),
    ]
    assert {kind for kind, _ in found[3:]} == {"best"}
    assert sorted(name for _, name in found[3:]) == [name for _, name in found[3:]]
    assert [entry.name for entry in entries(problem("velvet"))] == ["velvet"]


def test_tables_of_a_quantity_are_found_by_their_kind():
    assert [owner.name for owner in with_published()] == list(PUBLISHED)
    for owner in problems().values():
        assert refitted(owner) is resolve(owner.name)
        assert (published(owner) is None) == (owner.name not in PUBLISHED)
        assert (printed(owner) is not None) == (owner.name == "ps")
    assert published(problem("g")) is resolve("published/g")
    assert printed(problem("ps")) is resolve("published/ps@printed")


def test_the_path_of_a_table_is_where_it_is_or_would_be():
    assert path_of("best/q-9") == FOLDER / "fuzz" / "best" / "q-9.json"
    assert path_of("ps") == FOLDER / "fuzz" / "refit" / "ps.json"
    for name in (*QUANTITIES, *names_of_best()):
        assert path_of(name).is_file()


def test_the_path_of_a_new_quantitys_table_is_in_its_topic(monkeypatch):
    monkeypatch.setattr(catalogue, "files", dict)
    assert path_of("g") == FOLDER / "fuzz" / "refit" / "g.json"


# What tables hold


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_a_refitted_table_has_all_its_parts(quantity):
    table = table_of(quantity)
    for part in ("grid", "weight", "reference", "errors", "certificates", "provenance"):
        assert getattr(table, part) is not None, part


@pytest.mark.parametrize("name", [*QUANTITIES, *(f"published/{each}" for each in PUBLISHED)])
def test_a_table_holds_a_form_of_the_shape_that_its_names_say(name):
    entry = resolve(name)
    table, fitted = entry.require_table(), entry.require_fitted()
    form = fitted.form
    assert form is entry.problem.single_forms[table.form]
    assert table.equation == form.equation
    assert table.coefficient_names == form.coefficient_names
    assert fitted.constants.tolist() == table.coefficients
    axes = [(axis.name, axis.unit, [axis.lower, axis.upper]) for axis in form.axes]
    assert [(a.name, a.unit, a.domain) for a in table.arguments] == axes


@pytest.mark.parametrize("name", names())
def test_a_table_that_is_written_and_read_is_the_same(name, tmp_path):
    """Errata that are applied are not applied again; as printed, they are, as to any file."""
    table, path = table_of(name), tmp_path / "table.json"
    path.write_text(serialise(table))
    assert table_of(str(path)) == corrected(table)
    assert corrected(corrected(table)) == corrected(table)


# Errata


@pytest.mark.parametrize("rows", [[3, 6], [-1, 3], [0, 100]])
def test_an_erratum_about_rows_that_do_not_exist_is_refused(rows):
    data = json.loads(serialise(table_of("published/ps@printed")))
    data["publication"]["errata"][0]["exchange_rows"] = rows
    with pytest.raises(ValueError, match="rows-3-4 exchanges rows that do not exist"):
        corrected(parse(json.dumps(data), "itself"))


def test_errata_are_applied_in_their_order():
    data = json.loads(serialise(table_of("published/ps@printed")))
    errata = data["publication"]["errata"]
    errata.append({**errata[0], "id": "again"})
    assert corrected(parse(json.dumps(data), "itself")).coefficients == data["coefficients"]
    errata[-1]["exchange_rows"] = [0, 3]
    moved = corrected(parse(json.dumps(data), "itself")).coefficients
    assert moved == [data["coefficients"][row] for row in (4, 1, 2, 0, 3, 5)]
