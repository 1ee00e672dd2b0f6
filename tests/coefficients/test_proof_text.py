"""What is proven of a table, in words: no number says more than is proven."""

import json
import re

import pytest

from coefficients.catalogue import Entry, names, resolve
from coefficients.proof_text import proof_text, proofs
from coefficients.table import parse, serialise


def certificates_of(name: str):
    return resolve(name).require_table().certificates


def data_of(name: str) -> dict:
    return json.loads(serialise(resolve(name).require_table()))


PROVEN = [name for name in names() if certificates_of(name) is not None]
NUMBER = r"[-+.\de]+"


@pytest.mark.parametrize("name", PROVEN)
def test_no_number_says_more_than_is_proven(name):
    certificates = certificates_of(name)
    text = "; ".join(proof_text(certificates))
    bound = re.search(rf"denominators ≥ ({NUMBER})", text)
    assert (bound is None) == (certificates.denominator_bound is None)
    if bound is not None:
        assert 0.99 * certificates.denominator_bound < float(bound[1])
        assert float(bound[1]) <= certificates.denominator_bound
    values = re.search(rf"values in \[({NUMBER}), ({NUMBER})\]", text)
    assert (values is None) == (certificates.range is None)
    if values is not None:
        low, high = (float(each) for each in values.groups())
        # What is outside the codomain is so by the proof's own rounding.
        least, most = resolve(name).problem.reference.codomain
        lower = max(certificates.range[0], least) if least > 0 else certificates.range[0]
        assert low <= lower < low + 1e-4
        upper = min(certificates.range[1], most)
        assert high >= upper > high - 2e-4
    least = re.search(rf"error below ({NUMBER})", text)
    assert (least is None) == (certificates.least_error is None)
    if least is not None:
        assert 0.99 * certificates.least_error < float(least[1]) <= certificates.least_error


def test_one_sided_tables_say_so():
    assert "none above the exact value" in proof_text(certificates_of("velvet"))
    assert not any("above" in each for each in proof_text(certificates_of("best/r-25")))


def test_nothing_is_proven_of_what_was_published():
    assert proof_text(certificates_of("published/g")) == []


@pytest.mark.parametrize("upper", [0.06713230369730813, 8.166033525e-06, 0.0, 1.0, 0.9999999])
def test_a_proven_largest_error_is_rounded_up(upper):
    largest = {"lower": 0.0, "at": {"density": 0.5}, "upper": upper, "boxes": 7}
    data = data_of("q")
    data["certificates"]["largest_error"] = largest
    certificates = parse(json.dumps(data), "q").certificates
    (text,) = re.findall(rf"errors ≤ ({NUMBER}(?:e-\d+)?)", "; ".join(proof_text(certificates)))
    assert upper <= float(text) <= upper * 1.001 + 1e-300


def test_a_largest_error_below_its_own_point_is_refused():
    data = data_of("q")
    at = {"density": 0.5}
    data["certificates"]["largest_error"] = {"lower": 0.2, "at": at, "upper": 0.1, "boxes": 7}
    with pytest.raises(ValueError, match=r"at least 0\.2 and at most 0\.1"):
        parse(json.dumps(data), "q")


def written(path, name: str, **changes) -> Entry:
    """Write a changed copy of a table to a file, and resolve that."""
    path.write_text(json.dumps(data_of(name) | changes))
    return resolve(str(path))


def again(texts: list[str]) -> list[str]:
    """Return what is proven of a file too: not its largest error, and not a bound of others'."""
    return [t for t in texts if not t.startswith(("errors ≤", "no coefficients have"))]


def test_what_a_file_says_of_itself_is_no_proof(tmp_path):
    c = data_of("best/q-9")["coefficients"]
    said = {"denominator_bound": 5.0, "boxes": 1, "range": [0.2, 0.9]}
    lies = written(tmp_path / "lies.json", "best/q-9", certificates=said)
    found = proofs(lies)
    assert "5" not in found[0]
    assert found[1:] == again(proofs(resolve("best/q-9")))[1:]
    poles = written(
        tmp_path / "poles.json",
        "best/q-9",
        coefficients=[*c[:-1], -0.3],
        certificates=said,
    )
    assert proofs(poles) == ["nothing: a denominator may vanish"]


def test_a_file_that_says_falsely_that_it_loses_energy_is_not_believed(tmp_path):
    lower = [c - 0.01 for c in data_of("velvet")["coefficients"]]
    found = proofs(written(tmp_path / "bright.json", "velvet", coefficients=lower))
    assert found
    assert "none above the exact value" not in found


@pytest.mark.parametrize("name", ["q", "best/g-9", "velvet"])
def test_a_copy_of_a_table_proves_as_much(name, tmp_path):
    assert proofs(written(tmp_path / "copy.json", name)) == again(proofs(resolve(name)))


@pytest.mark.parametrize(
    ("certificates", "message"),
    [
        ({"boxes": 1, "denominator_bound": -1.0}, "certificates"),
        ({"boxes": 1, "least_error": 0.0}, "certificates"),
        ({"boxes": 1, "range": [0.9, 0.2]}, "certificates"),
        ({"boxes": 1, "range": [0.2, 7.5]}, r"the range as \[0.2, 7.5\].* has \[0.0, 1.0\]"),
    ],
)
def test_certificates_that_prove_nothing_are_refused(certificates, message, tmp_path):
    with pytest.raises(ValueError, match=message):
        written(tmp_path / "odd.json", "best/q-9", certificates=certificates)


def test_a_closed_form_has_nothing_to_prove():
    with pytest.raises(ValueError, match="exact/q has no coefficients"):
        proofs(resolve("exact/q"))
