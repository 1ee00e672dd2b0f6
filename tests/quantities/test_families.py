"""Families of forms: every candidate is made again from its shape, and wrong shapes are refused."""

import itertools
import json
import math

import pytest

from quantities import problem, problems

R_SHAPE = {
    "variable": "1-alpha",
    "numerator": [[0, 0], [0, 1], [2, 1]],
    "denominator": [[1, 0], [1, 1]],
    "least_alpha": 0.15,
}
MASKED = {"numerator": [[0, 1], [1, 0]], "denominator": [[0, 3], [3, 0]]}
SKIN = {"narrow": 0.1, "wide": 0.5, "numerator": [[5, 0]], "below": 0}
SHAPES = {
    "pole-q": {"structure": "free", "terms": 1, "poles": 1},
    "decay-g": {"decay": "power", "rate": "constant", "factor": "linear"},
    "tied-g": {"poles": 1, "root": 1},
    "monomial-r": R_SHAPE,
    "one-root-ps": {"skew": 1, "degree": 1, "least_alpha": 0.15},
    "two-root-ps": {"terms": 3, "degree": 1, "least_alpha": 0.15},
    "cubic-ps": {"steps": 0, "degree": 1, "least_alpha": 0.15},
    "masked-ggx-directional-albedo": MASKED,
    "masked-ggx-scale": MASKED,
    "masked-ggx-bias": MASKED,
    "quotient-ggx-average-albedo": {"structure": "log", "above": 1, "below": 0},
    "quotient-sggx-filter": {"above": 1, "below": 1},
    "quotient-sggx-filter-axes": {"numerator": [[1, 0]], "denominator": [[0, 1]]},
    "hyperbola-skin": SKIN,
    "lobe-skin": {**SKIN, "wide": 1.5},
    "quotient-skin": {"above": 1, "below": 1},
}
# Arguments that the function of a family limits more than their kind does.
LIMITED = {
    "quotient-sggx-filter-axes": {"numerator": [[[1, 0]], [[7, 7]]]},
    "hyperbola-skin": {"narrow": [0.05], "wide": [0.5], "numerator": [[[5, 0]], [[5, 7]]]},
    "lobe-skin": {"numerator": [[[5, 0]], [[5, 7]]]},
}
FAMILIES = {name: owner for owner in problems().values() for name in owner.families}


def form_of(family: str, shape: dict):
    owner = FAMILIES.get(family) or problem("q")
    return owner.find_form(family, shape)


@pytest.mark.parametrize(
    "quantity", ["q", "g", "ps", "ggx-directional-albedo", "ggx-bias", "ggx-scale"]
)
def test_every_candidate_is_made_again_from_its_family_and_shape(quantity):
    owner = problem(quantity)
    for form in owner.candidates({"alpha": 0.15}):
        shape = json.loads(json.dumps(form.shape))
        assert owner.find_form(form.name, shape) is form
        assert {form.size} == {len(start) for start in form.starts}
        assert form.reference is owner.reference


def test_candidates_begin_at_the_lower_ends_that_are_asked_for():
    for form in itertools.islice(problem("ps").candidates({"alpha": 0.05}), 3):
        assert form.axes[0].lower == form.shape["least_alpha"] == 0.05


@pytest.mark.parametrize(
    ("family", "shape", "message"),
    [
        ("pole-x", {}, "form 'pole-x' is not known"),
        ("pole-q", {"terms": 1}, "allowed are"),
        ("pole-q", {"structure": "free", "terms": 0, "poles": 0}, "at least one"),
        ("pole-q", {"structure": "__import__", "terms": 1, "poles": 1}, "structure ="),
        ("pole-q", {"structure": "free", "terms": 10**9, "poles": 1}, "terms ="),
        ("pole-q", {"structure": "free", "terms": True, "poles": 1}, "terms ="),
        ("monomial-r", {**R_SHAPE, "least_alpha": 0.0}, "least_alpha ="),
        ("monomial-r", {**R_SHAPE, "numerator": []}, "numerator"),
        ("monomial-r", {**R_SHAPE, "numerator": [[0, 0], [0, 0]]}, "numerator"),
        ("monomial-r", {**R_SHAPE, "numerator": [[0, 99]]}, "numerator"),
        ("monomial-r", {**R_SHAPE, "denominator": [[0, 0]]}, "denominator"),
        ("cubic-ps", {"steps": 9, "degree": 0, "least_alpha": 0.1}, "steps ="),
        ("quotient-sggx-filter-axes", {"numerator": [[0, 0]], "denominator": []}, "numerator ="),
        ("hyperbola-skin", {**SKIN, "numerator": [[6, 1]]}, "term"),
        ("hyperbola-skin", {**SKIN, "numerator": [[0, 0]]}, "term"),
        ("hyperbola-skin", {**SKIN, "narrow": 0.6}, "narrow ="),
    ],
)
def test_a_shape_that_is_not_allowed_is_refused_in_one_line(family, shape, message):
    with pytest.raises(ValueError, match=message) as caught:
        form_of(family, shape)
    assert "\n" not in str(caught.value)


# Values that no argument of any family may have.
WRONG = (
    *(None, True, -2, 10**9, 10**400, 0.0, 1e308, math.inf, math.nan, "", "x" * 2000, "\x1b[2J"),
    *([[]], [None], ["ab"], [["a", "b"]], [[True, 0]], [[0.5, 1]], [[10**400, 1]], [[[0], [0]]]),
    *([[1, 1], [1, 1]], [[i // 8, i % 8] for i in range(64)], [[0, 0]] * 10**3, {}, {"a": 1}),
)


@pytest.mark.parametrize("family", FAMILIES)
def test_an_argument_of_a_shape_that_has_no_allowed_value_is_refused(family):
    for name, value in itertools.product(SHAPES[family], WRONG):
        with pytest.raises(ValueError, match=f"^{name} = ") as caught:
            form_of(family, {**SHAPES[family], name: value})
        assert str(caught.value).isprintable()
        assert len(str(caught.value)) < 300
    with pytest.raises(ValueError, match="shape of") as caught:
        form_of(family, {f"{k:064}": k for k in range(10**4)})
    assert len(str(caught.value)) < 1000


def extremes(allowed) -> list:
    """Return the first and the last value that an argument may have, or some of the right kind."""
    if isinstance(allowed, str):
        return {"fraction": [0.05, 0.5], "exponents": [[[0, 0]], [[7, 7]]]}.get(allowed, [[]])
    return [allowed[0], allowed[-1]]


@pytest.mark.parametrize("family", FAMILIES)
def test_every_allowed_shape_gives_a_form(family):
    arguments = FAMILIES[family].families[family].arguments
    assert set(arguments) == set(SHAPES[family])
    ends = {name: extremes(allowed) for name, allowed in arguments.items()}
    for values in itertools.product(*(ends | LIMITED.get(family, {})).values()):
        shape = dict(zip(arguments, values, strict=True))
        if shape.get("terms") == shape.get("poles") == 0:
            continue
        form = form_of(family, shape)
        assert (form.name, form.shape) == (family, shape)
        assert all(len(start) == form.size for start in form.starts)


def test_families_are_named_after_their_quantity():
    assert set(FAMILIES) == set(SHAPES)
    for name, owner in FAMILIES.items():
        # The quantities of skin share families, which have the name of their topic.
        assert name.endswith((f"-{owner.name}", f"-{owner.topic}"))
