"""The message about a denominator that fails: which it is, and where."""

import jax.numpy as jnp

from fitting.proofs.failing_denominator import failing_denominator
from tests.fitting.toys import toy_form


def test_the_denominator_with_a_zero_is_named_with_its_place():
    form = toy_form(lambda c, x, y: 1 / (2 + x) + 1 / (c[0] - y), ["b"])
    told = failing_denominator(form.fitted(jnp.array([1.5])))
    assert told.startswith(
        "a denominator that is not shown to be positive on its whole domain: b − y is -"
    )
    assert "y = " in told


def test_a_radicand_that_becomes_negative_is_called_a_radicand():
    form = toy_form(lambda c, x, y: jnp.sqrt(c[0] - y) / (2 + x), ["b"])
    told = failing_denominator(form.fitted(jnp.array([1.5])))
    assert told.startswith("a radicand that is not shown to be positive")
    assert ": b − y is -" in told


def test_a_form_without_denominators_has_none_to_name():
    form = toy_form(lambda c, x, y: c[0] * x * y, ["a"])
    told = failing_denominator(form.fitted(jnp.array([1.0])))
    assert told == "a value that is not shown to be finite on its whole domain"
