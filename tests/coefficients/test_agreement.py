"""Tables that contradict their form are refused."""

import json

import numpy as np
import pytest

from coefficients.agreement import fitted_form
from coefficients.catalogue import resolve
from coefficients.table import parse, serialise
from quantities import problem
from quantities.fuzz.supplement import RATIONAL_G


def data_of(name: str) -> dict:
    return json.loads(serialise(resolve(name).require_table()))


def form_of(data: dict):
    return fitted_form(parse(json.dumps(data), "itself"), problem(data["quantity"]))


def test_a_table_gives_its_form_with_its_coefficients():
    data = data_of("published/g")
    fitted = form_of(data)
    assert fitted.form is RATIONAL_G
    assert fitted.constants.tolist() == data["coefficients"]


WRONG = {
    "an unknown form": (
        {"form": "rational-x"},
        "form 'rational-x' is not known: allowed are rational-g, decay-g, tied-g",
    ),
    "a form of another quantity": (
        {"quantity": "q"},
        "form 'rational-g' is not known: allowed are quadratic-q, pole-q",
    ),
    "a form that has no shape": ({"shape": {"poles": 1}}, "form 'rational-g' is not known"),
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
def test_a_table_of_another_form_is_refused(name):
    change, message = WRONG[name]
    with pytest.raises(ValueError, match=message) as error:
        form_of({**data_of("published/g"), **change})
    assert str(error.value).isprintable()


G_ARGUMENTS = data_of("published/g")["arguments"]
G_NAMES = RATIONAL_G.coefficient_names
CONTRADICTIONS = {
    "a unit": (
        {"arguments": [{**G_ARGUMENTS[0], "unit": "rad"}, G_ARGUMENTS[1]]},
        "the unit of density as 'rad', form 'rational-g' has '1'",
    ),
    "a domain": (
        {"arguments": [{**G_ARGUMENTS[0], "domain": [0, 50]}, G_ARGUMENTS[1]]},
        r"the domain of density as \[0.0, 50.0\], form 'rational-g' has \[0.001, 0.5\]",
    ),
    "arguments in another order": (
        {"arguments": G_ARGUMENTS[::-1]},
        r"arguments as \['cos_v', 'density'\], form 'rational-g' has \['density', 'cos_v'\]",
    ),
    "an argument twice": (
        {"arguments": [*G_ARGUMENTS, G_ARGUMENTS[1]]},
        "arguments: a name is there twice",
    ),
    "one argument": ({"arguments": G_ARGUMENTS[:1]}, r"arguments as \['density'\]"),
    "names in another order": (
        {"coefficient_names": G_NAMES[::-1]},
        "the name of coefficient 0 as 'c3: ν³', form 'rational-g' has 'c0: dν'",
    ),
    "a weight that the quantity does not have": (
        {"weight": "cosine"},
        r"the weight as 'cosine', form 'rational-g' has \['uniform'\]",
    ),
    "a long name": (
        {"coefficient_names": [*G_NAMES[:3], "c" * 2000]},
        r"the name of coefficient 3 as 'c+\.\.\.c+', form",
    ),
}


@pytest.mark.parametrize("name", CONTRADICTIONS)
def test_a_table_that_contradicts_its_form_is_refused(name):
    change, message = CONTRADICTIONS[name]
    with pytest.raises(ValueError, match=message) as error:
        form_of({**data_of("published/g"), **change})
    assert str(error.value).isprintable()


def test_a_domain_is_the_same_after_rounding():
    data = data_of("published/r")
    data["arguments"][0]["domain"][0] = float(np.float32(0.15))
    data["arguments"][1]["domain"][1] = 1.570796
    assert form_of(data).axes[0].lower == 0.15


def test_a_family_is_told_by_its_shape():
    data = data_of("best/r-25")
    assert form_of(data).form.shape == data["shape"]
    data["shape"]["numerator"] = data["shape"]["numerator"][::-1]
    with pytest.raises(ValueError, match="the name of coefficient 0 as"):
        form_of(data)
