"""Functions that are compiled for few calls."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from integrals.compilation import FEW_CALLS, jit_for_few_calls


@jit_for_few_calls
def _doubled(x):
    return 2 * x


@jit_for_few_calls(static=(0,))
def _power(exponent, x):
    return x**exponent if exponent > 1 else x


def test_values_are_those_of_the_function():
    x = np.arange(3.0)
    np.testing.assert_array_equal(_doubled(x), [0, 2, 4])
    np.testing.assert_array_equal(_power(3, x), [0, 1, 8])


def test_the_compiler_knows_the_options():
    # An option that it does not know is refused.
    function = jax.jit(lambda x: x, compiler_options={**FEW_CALLS, "xla_no_such_option": True})
    with pytest.raises(jax.errors.JaxRuntimeError, match="xla_no_such_option"):
        function(1.0)


def test_it_is_not_called_inside_a_traced_function():
    with pytest.raises(ValueError, match="top-level"):
        jax.jit(lambda x: _doubled(x) + 1)(jnp.ones(2))
