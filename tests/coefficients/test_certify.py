"""Largest errors of the packaged tables: proven, and compared with what the tables state."""

import json

import numpy as np
import pytest

from coefficients.catalogue import resolve
from coefficients.certify import certify, chosen, with_largest_error
from coefficients.packaged import names_of_best
from coefficients.table import parse, serialise
from fitting import form_values
from programs.bounding.compiled import compiler_missing
from quantities.fuzz import r_error

pytestmark = pytest.mark.skipif(compiler_missing() is not None, reason="no C compiler")

QUICK = ["q", "velvet", "best/q-4", "best/q-9", "best/q-12-log"]
SLOW = ["g", "best/q-5", "best/q-12"] + [
    name for name in names_of_best() if name.startswith("best/g-")
]


@pytest.mark.parametrize("name", [*QUICK, *(pytest.param(n, marks=pytest.mark.slow) for n in SLOW)])
def test_the_largest_error_of_a_table_is_proven(name):
    entry = resolve(name)
    done = certify(entry)
    assert done.state == "proven" and not done.understated
    found, fitted = done.found, entry.require_fitted()
    assert found.lower <= found.upper <= 1.01 * found.lower + 1e-12
    # The point is inside the domain and has the error.
    at = np.array([[found.at[axis.name] for axis in entry.axes]])
    assert all(axis.contains(x) for axis, x in zip(entry.axes, at[0], strict=True))
    error = abs(form_values(fitted, at) - entry.problem.reference.values(at))[0]
    assert error == pytest.approx(found.lower, rel=1e-6)
    # The climb that the table's error comes from misses at most what the bound leaves.
    assert 0.99 * done.stated <= found.lower
    assert done.stated <= found.upper


def test_a_quantity_without_a_closed_form_is_sampled(monkeypatch):
    """R has no proof for so small a roughness."""
    monkeypatch.setattr(r_error, "LEAST_ALPHA", 0.5)
    done = certify(resolve("best/r-25"))
    assert (done.state, done.found, done.understated) == ("sampled", None, False)
    with pytest.raises(ValueError, match="best/r-25: its largest error is not proven"):
        with_largest_error(done)


def test_a_published_table_is_proven_but_has_no_certificates_to_write():
    done = certify(resolve("published/q"))
    assert done.state == "proven" and done.stated is None
    with pytest.raises(ValueError, match="published/q is published"):
        with_largest_error(done)


def test_a_table_that_states_too_little_is_noticed(tmp_path):
    data = json.loads(serialise(resolve("best/q-9").require_table()))
    data["errors"]["off_grid"]["max"] *= 0.99
    path = tmp_path / "table.json"
    path.write_text(json.dumps(data))
    assert certify(resolve(str(path))).understated


def test_a_proven_table_is_written_and_read():
    done = certify(resolve("best/q-4"))
    table = parse(serialise(with_largest_error(done)), "q-4")
    record = table.certificates.largest_error
    assert (record.lower, record.upper) == (done.found.lower, done.found.upper)
    assert (record.at, record.boxes) == (done.found.at, done.found.boxes)
    assert (
        table.model_copy(update={"certificates": resolve("best/q-4").require_table().certificates})
        == resolve("best/q-4").require_table()
    )


def test_all_stands_for_the_tables_that_were_fitted():
    names = [entry.name for entry in chosen(["all"])]
    assert "q" in names and "best/ps-61-wide" in names
    assert not any(name.startswith("published") for name in names)
    with pytest.raises(ValueError, match="no table is called"):
        chosen(["nothing"])
    with pytest.raises(ValueError, match="has no coefficients"):
        chosen(["exact/q"])
