"""Fits of the largest error reach known best approximations, and prove that they are the best."""

import functools
from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import linprog

from fitting import Form, Goal, Stage, form_values
from fitting.fit import fit
from integrals import Axis, Estimate, Reference, Sampling
from tests.fitting.toys import TOY, toy_form

# A fit may exceed the least largest error by this part of it.
CLOSE = 1e-4
SLOW = pytest.mark.slow


@functools.cache
def line(name: str, lower: float) -> Reference:
    """Return a function on [lower, 1] as a quantity. `climbs` lets the solver ask for points."""
    function = {"exp": jnp.exp, "abs": jnp.abs, "sqrt": jnp.sqrt}[name]
    return Reference(
        name=name,
        symbol="f",
        meaning="a function of one argument",
        definition=name,
        axes=(Axis("x", lower, 1.0),),
        sampling=Sampling(fitted=7, checked=8, judged=9),
        closed_form=lambda x: Estimate(function(x), jnp.full((), 1e-17)),
        codomain=(0.0, 3.0),
    )


def polynomial(reference: Reference, degree: int, chebyshev: bool = False) -> Form:
    """Return Σ cₖxᵏ, or Σ cₖTₖ(x)."""

    def value(c, x):
        terms = [jnp.ones_like(x), x]
        for k in range(2, degree + 1):
            terms.append(2 * x * terms[-1] - terms[-2] if chebyshev else x**k)
        return sum(c[k] * term for k, term in enumerate(terms[: degree + 1]))

    names = [f"c{k}" for k in range(degree + 1)]
    return Form("polynomial", "Σ cₖ pₖ", reference, reference.axes, names, (Stage(value),))


def rational(reference: Reference, degree: int, of=lambda x: x) -> Form:
    """Return the quotient of two polynomials of z = of(x), with the denominator 1 at z = 0."""

    def value(c, x):
        z = of(x)
        above = sum(c[k] * z**k for k in range(1, degree + 1)) + c[0]
        return above / (1 + sum(c[degree + k] * z**k for k in range(1, degree + 1)))

    names = [f"a{k}" for k in range(degree + 1)] + [f"b{k + 1}" for k in range(degree)]
    return Form("rational", "N/D", reference, reference.axes, names, (Stage(value),))


def require_best(found) -> None:
    """Require that a fit's largest error is proven to be within CLOSE of the least."""
    assert found.converged
    assert found.least_error is not None
    assert found.least_error <= found.off_grid.largest <= found.least_error * (1 + 2 * CLOSE)


# The least largest errors of eˣ on [−1, 1], by the exchange of Remez in `remez`.
DEGREES = [1, 6, 10, *(pytest.param(n, marks=SLOW) for n in (2, 3, 4, 5, 7, 8, 9))]


@functools.cache
def remez(degree: int) -> float:
    """Return the least largest error of eˣ on [−1, 1]: one exchange of all extrema a round."""
    fine = np.cos(np.linspace(np.pi, 0, 20001))
    nodes = np.cos(np.linspace(np.pi, 0, degree + 2))
    for _ in range(5):
        signs = (-1.0) ** np.arange(degree + 2)
        matrix = np.column_stack([np.polynomial.chebyshev.chebvander(nodes, degree), signs])
        *c, level = np.linalg.solve(matrix, np.exp(nodes))
        error = np.exp(fine) - np.polynomial.chebyshev.chebval(fine, c)
        # Near its zeros the error may be rounding.
        some = np.nonzero(np.abs(error) > 0.01 * np.abs(error).max())[0]
        parts = np.split(some, np.nonzero(np.diff(np.sign(error[some])))[0] + 1)
        nodes = np.array([fine[part[np.argmax(np.abs(error[part]))]] for part in parts])
    return abs(float(level))


@pytest.mark.parametrize("degree", DEGREES)
def test_the_exponential_by_polynomials(degree):
    found = fit(polynomial(line("exp", -1.0), degree), Goal("linf"))
    require_best(found)
    # At degree 10 the error is 2.5e-11, of which rounding is 1e-5.
    assert found.off_grid.largest == pytest.approx(remez(degree), rel=CLOSE)


@pytest.mark.parametrize("degree", [20, pytest.param(40, marks=SLOW)])
def test_the_absolute_value_by_polynomials(degree):
    found = fit(polynomial(line("abs", -1.0), degree, chebyshev=True), Goal("linf"))
    require_best(found)
    # Varga and Carpenter 1985: n times the least error of degree n tends to 0.2801694990.
    assert degree * found.off_grid.largest == pytest.approx(0.28017, rel=2e-3)


# Varga, Ruttan and Carpenter 1991: best rational approximations of degree (2n, 2n) of |x| on
# [−1, 1], which are those of degree (n, n) of √x on [0, 1], at x².
OF_ROOT = {1: 4.36890127e-2, 2: 8.50148470e-3, 3: 2.28210601e-3, 4: 7.36563614e-4}


@pytest.mark.parametrize("degree", [2, 4, pytest.param(1, marks=SLOW), pytest.param(3, marks=SLOW)])
def test_the_square_root_by_rational_functions(degree):
    found = fit(rational(line("sqrt", 0.0), degree), Goal("linf"))
    require_best(found)
    assert found.off_grid.largest == pytest.approx(OF_ROOT[degree], rel=CLOSE)


def test_the_absolute_value_by_rational_functions():
    found = fit(rational(line("abs", -1.0), 2, lambda x: x * x), Goal("linf"))
    require_best(found)
    assert found.off_grid.largest == pytest.approx(OF_ROOT[2], rel=CLOSE)


@pytest.mark.slow
def test_a_best_approximation_that_has_fewer_coefficients_is_found():
    """The best quotient of degree (4, 4) for |x| is even: its odd terms are superfluous."""
    found = fit(rational(line("abs", -1.0), 4), Goal("linf"))
    require_best(found)
    assert found.off_grid.largest == pytest.approx(OF_ROOT[2], rel=CLOSE)


def test_a_plane_of_two_variables_against_an_independent_linear_program():
    form = toy_form(lambda c, x, y: c[0] + c[1] * x + c[2] * y + c[3] * x * y, list("abcd"))
    found = fit(form, Goal("linf"))
    x, y = (each.ravel() for each in np.meshgrid(np.linspace(0, 1, 81), np.linspace(-1, 2, 161)))
    exact = np.exp(-x) * (2 + np.sin(y))
    matrix = np.column_stack([np.ones(len(x)), x, y, x * y])
    rows = np.block([[matrix, -np.ones((len(x), 1))], [-matrix, -np.ones((len(x), 1))]])
    solved = linprog(
        [0, 0, 0, 0, 1], rows, np.concatenate([exact, -exact]), bounds=[(None, None)] * 5
    )
    require_best(found)
    # The grid of the linear program leaves out a part of the domain.
    assert solved.fun <= found.off_grid.largest * (1 + 1e-7)
    assert found.off_grid.largest == pytest.approx(solved.fun, rel=5e-4)
    points = np.column_stack([x, y])
    on_grid = np.abs(form_values(found.fitted, points) - exact).max()
    assert on_grid <= solved.fun * (1 + 5e-4)


@pytest.mark.slow
def test_a_quotient_of_monomials_that_the_linear_problem_fits_with_a_pole():
    """The exact values fall to zero: the errors times the denominator are small at a pole."""
    narrow = replace(
        TOY,
        closed_form=lambda x, y: Estimate(
            jnp.exp(-8 * (x * x + (y - 0.5) ** 2)) + 1e-3 * x, jnp.full((), 1e-15)
        ),
    )
    powers = [(i, j) for i in range(3) for j in range(3 - i)]

    def value(c, x, y):
        above = sum(c[k] * x**i * y**j for k, (i, j) in enumerate(powers))
        return above / (1 + sum(c[5 + k] * x**i * y**j for k, (i, j) in enumerate(powers) if k))

    form = replace(toy_form(value, [f"c{k}" for k in range(11)]), reference=narrow)
    squares, largest = (fit(form, goal) for goal in (Goal(), Goal("linf")))
    assert largest.least_error is not None
    assert largest.least_error > 0.98 * largest.on_grid.largest
    assert largest.off_grid.largest < squares.off_grid.largest
    assert np.abs(largest.fitted.constants).max() < 1e3
