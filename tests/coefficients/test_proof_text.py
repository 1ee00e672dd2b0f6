import json
import re

import pytest

from coefficients.catalogue import load, names
from coefficients.proven import proofs, proven
from coefficients.table import serialise

PROVEN = [name for name in names() if load(name).certificates is not None]
NUMBER = r"[-+.\de]+"


@pytest.mark.parametrize("name", PROVEN)
def test_no_number_says_more_than_is_proven(name):
    certificates = load(name).certificates
    text = "; ".join(proven(certificates))
    bound = re.search(rf"denominators ≥ ({NUMBER})", text)
    assert (bound is None) == (certificates.denominator_bound is None)
    if bound is not None:
        assert 0.99 * certificates.denominator_bound < float(bound[1])
        assert float(bound[1]) <= certificates.denominator_bound
    values = re.search(rf"values in \[({NUMBER}), ({NUMBER})\]", text)
    assert (values is None) == (certificates.range is None)
    if values is not None:
        low, high = (float(each) for each in values.groups())
        assert low <= certificates.range[0] < low + 1e-4
        # What is above one is so by the proof's own rounding.
        assert high >= min(certificates.range[1], 1) > high - 2e-4
    least = re.search(rf"error below ({NUMBER})", text)
    assert (least is None) == (certificates.least_error is None)
    if least is not None:
        assert 0.99 * certificates.least_error < float(least[1]) <= certificates.least_error


def test_one_sided_tables_say_so():
    assert "none above the exact value" in proven(load("velvet").certificates)
    assert not any("above" in each for each in proven(load("best/r-25").certificates))


def test_nothing_is_proven_of_what_was_published():
    assert proven(load("published/g").certificates) == []


def written(path, name: str, **changes) -> str:
    data = json.loads(serialise(load(name)))
    path.write_text(json.dumps(data | changes))
    return str(path)


def test_what_a_file_says_of_itself_is_no_proof(tmp_path):
    table = json.loads(serialise(load("best/q-9")))
    c = table["coefficients"]
    said = {"denominator_bound": 5.0, "boxes": 1, "range": [0.2, 0.9]}
    lies = written(tmp_path / "lies.json", "best/q-9", certificates=said)
    found = proofs(lies)
    assert "5" not in found[0]
    assert found[1:] == proofs("best/q-9")[1:]
    poles = written(
        tmp_path / "poles.json",
        "best/q-9",
        coefficients=[*c[:-1], -4.0],
        certificates=said,
    )
    assert proofs(poles) == ["nothing: a denominator may vanish"]


def test_a_file_that_says_falsely_that_it_loses_energy_is_not_believed(tmp_path):
    table = json.loads(serialise(load("velvet")))
    lower = [c - 0.01 for c in table["coefficients"]]
    found = proofs(written(tmp_path / "bright.json", "velvet", coefficients=lower))
    assert found
    assert "none above the exact value" not in found


@pytest.mark.parametrize("name", ["q", "best/g-9", "velvet"])
def test_a_copy_of_a_table_proves_as_much(name, tmp_path):
    assert proofs(written(tmp_path / "copy.json", name)) == proofs(name)


@pytest.mark.parametrize(
    "certificates",
    [
        {"boxes": 1, "denominator_bound": -1.0},
        {"boxes": 1, "least_error": 0.0},
        {"boxes": 1, "range": [0.2, 7.5]},
        {"boxes": 1, "range": [0.9, 0.2]},
    ],
)
def test_certificates_that_prove_nothing_are_refused(certificates, tmp_path):
    path = written(tmp_path / "odd.json", "best/q-9", certificates=certificates)
    with pytest.raises(ValueError, match="certificates"):
        load(path)
