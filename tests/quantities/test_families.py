import itertools
import json
import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from fitting.families import FAMILIES, candidates, form_class
from fitting.families.g import decay_g, tied_g
from fitting.families.ps import cubic_ps, one_root_ps, two_root_ps
from fitting.families.q import pole_q
from fitting.families.r import monomial_r
from fitting.solvers.minimax import linear_parts
from integrals import PS

R_SHAPE = {
    "variable": "1-alpha",
    "numerator": [[0, 0], [0, 1], [2, 1]],
    "denominator": [[1, 0], [1, 1]],
    "least_alpha": 0.15,
}
P_S = {
    "one-root": one_root_ps(skew=1, degree=1, least_alpha=0.15),
    "two-root 3": two_root_ps(terms=3, degree=1, least_alpha=0.15),
    "two-root 4": two_root_ps(terms=4, degree=1, least_alpha=0.15),
    "two-root 5": two_root_ps(terms=5, degree=1, least_alpha=0.15),
    "cubic": cubic_ps(steps=0, degree=1, least_alpha=0.15),
}


def some(form) -> jnp.ndarray:
    """Give coefficients near a start that are not zero, so that every term counts."""
    size = len(form.coefficient_names())
    start = form.starts()[0] if form.starts() else np.zeros(size)
    return jnp.asarray(start + 0.02 * np.cos(np.arange(size)))


@pytest.mark.parametrize("quantity", ["q", "g", "ps"])
def test_every_candidate_is_made_again_from_its_family_and_shape(quantity):
    for form in candidates(quantity):
        shape = json.loads(json.dumps(form.shape))
        assert form_class(form.name, shape) is form
        assert {len(form.coefficient_names())} == {len(start) for start in form.starts()}
        assert form.integral.name == quantity


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
    ],
)
def test_a_shape_that_is_not_allowed_is_refused_in_one_line(family, shape, message):
    with pytest.raises(ValueError, match=message) as caught:
        form_class(family, shape)
    assert "\n" not in str(caught.value)


SHAPES = {
    "pole-q": {"structure": "free", "terms": 1, "poles": 1},
    "decay-g": {"decay": "power", "rate": "constant", "factor": "linear"},
    "tied-g": {"poles": 1, "root": 1},
    "monomial-r": R_SHAPE,
    "one-root-ps": {"skew": 1, "degree": 1, "least_alpha": 0.15},
    "two-root-ps": {"terms": 3, "degree": 1, "least_alpha": 0.15},
    "cubic-ps": {"steps": 0, "degree": 1, "least_alpha": 0.15},
}
# Values of no argument of any family.
WRONG = (
    *(None, True, -2, 10**9, 10**400, 0.0, 1e308, math.inf, math.nan, "", "x" * 2000, "\x1b[2J"),
    *([[]], [None], ["ab"], [["a", "b"]], [[True, 0]], [[0.5, 1]], [[10**400, 1]], [[[0], [0]]]),
    *([[1, 1], [1, 1]], [[i // 8, i % 8] for i in range(64)], [[0, 0]] * 10**3, {}, {"a": 1}),
)


@pytest.mark.parametrize("family", FAMILIES)
def test_no_argument_of_a_shape_is_what_none_may_be(family):
    for name, value in itertools.product(SHAPES[family], WRONG):
        with pytest.raises(ValueError, match=f"^{name} = ") as caught:
            form_class(family, {**SHAPES[family], name: value})
        assert str(caught.value).isprintable()
        assert len(str(caught.value)) < 300
    with pytest.raises(ValueError, match="shape of") as caught:
        form_class(family, {f"{k:064}": k for k in range(10**4)})
    assert len(str(caught.value)) < 1000


@pytest.mark.parametrize("structure", ["one", "slope", "log"])
def test_q_is_one_at_zero_density_and_falls_twice_as_fast_where_that_is_built_in(structure):
    form = pole_q(structure=structure, terms=2, poles=0 if structure == "log" else 1)
    fitted = form(some(form))
    assert float(fitted(0.0)) == 1.0
    if structure != "one":
        slope = (float(fitted(1e-9)) - 1) / 1e-9
        assert slope == pytest.approx(-2, abs=1e-6)


def test_g_has_its_limits_where_they_are_built_in():
    form = tied_g(poles=1, root=1)
    fitted = form(some(form))
    assert float(fitted(0.3, 1e-6)) == pytest.approx(1, abs=1e-5)
    # The slope at d = 0 is 1/ν for every ν.
    for nu in (0.1, 0.5, 1.0):
        slope = float(jax.grad(lambda d, nu=nu: fitted(d, nu))(1e-14))
        assert slope == pytest.approx(1 / nu, rel=1e-4)
    form = decay_g(decay="power", rate="pole", factor="inverse")
    assert float(form(some(form))(0.3, 1e-7)) == pytest.approx(1, abs=1e-5)


def test_r_is_a_half_for_isotropic_layers_and_the_same_for_both_ends_of_a_fibre():
    fitted = form_class("monomial-r", R_SHAPE)(jnp.array([0.3, -0.2, 0.1, 0.4, 0.2]))
    assert float(fitted(1.0, 0.7)) == 0.5
    assert float(fitted(0.3, 0.7)) == pytest.approx(float(fitted(0.3, np.pi - 0.7)), rel=1e-14)


@pytest.mark.parametrize("variable", ["1-alpha", "1-alpha^2", "(1-alpha)/(1+alpha)"])
def test_the_linear_parts_of_r_are_the_form(variable):
    shape = {**R_SHAPE, "variable": variable}
    form, c = form_class("monomial-r", shape), np.array([0.3, -0.2, 0.1, 0.4, 0.2])
    points = np.array([[0.2, 0.1], [0.6, 1.2], [1.0, 0.4]])
    a0, a, b0, b = linear_parts(form, points)
    values = [float(form(jnp.asarray(c))(*point)) for point in points]
    np.testing.assert_allclose((a0 + a @ c) / (b0 + b @ c), values, rtol=1e-14)


@pytest.mark.parametrize("name", P_S)
def test_p_s_keeps_the_integrals_symmetries(name):
    form = P_S[name]
    fitted = form(some(form))
    for alpha, theta_f, theta_u, phi in itertools.product((0.2, 0.7), (0.3, 1.2), (0.4, 1.3), (2,)):
        value = float(fitted(alpha, theta_f, theta_u, phi))
        mirrored = float(fitted(alpha, theta_f, theta_u, -phi))
        # t and −t are one fibre: u·t and n·t change their signs together.
        turned = float(fitted(alpha, np.pi - theta_f, theta_u, np.pi + phi))
        assert mirrored == pytest.approx(value, rel=1e-14)
        assert turned == pytest.approx(value, rel=1e-12)
        assert float(fitted(1.0, theta_f, theta_u, phi)) == pytest.approx(0.5, abs=1e-12)
        upright = [float(fitted(alpha, 0.0, theta_u, p)) for p in (0.0, 1.0, 3.0)]
        np.testing.assert_allclose(upright, upright[0], rtol=1e-14)


@pytest.mark.parametrize("name", [name for name in P_S if name != "one-root"])
def test_p_s_is_exact_at_grazing_light_where_that_is_built_in(name):
    form = P_S[name]
    fitted = form(some(form))
    for alpha, theta_f, phi in itertools.product((0.2, 0.5), (0.4, 1.2), (0.3, 2.0)):
        exact = float(PS.value(alpha, theta_f, np.pi / 2, phi))
        assert float(fitted(alpha, theta_f, np.pi / 2, phi)) == pytest.approx(exact, abs=1e-9)


def test_steps_of_the_cubics_root_end_at_the_closed_form():
    lights = [(0.3, 0.4, 0.6, 1.0), (0.15, 1.2, 1.1, 3.0), (0.8, 0.1, 0.2, 2.0)]
    largest = []
    for steps in range(4):
        fitted = cubic_ps(steps=steps, degree=-1, least_alpha=0.15)(jnp.zeros(0))
        largest.append(max(abs(float(fitted(*x) - PS.value(*x))) for x in lights))
    assert largest[0] > 1e-4
    assert all(after < 0.1 * before for before, after in itertools.pairwise(largest[:3]))
    assert largest[3] < 1e-9


def test_every_family_names_its_arguments():
    for name, family in FAMILIES.items():
        assert family.arguments
        assert name.rpartition("-")[2] in ("q", "g", "r", "ps")
    assert (
        monomial_r(variable="1-alpha", numerator=((0, 0),), denominator=(), least_alpha=0.5)
        .axes[0]
        .domain
        == "[0.5, 1]"
    )
