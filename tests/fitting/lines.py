"""A small quantity with one axis, for tests of shapes."""

import jax.numpy as jnp

from fitting.form import Form, traced
from integrals import Axis, Estimate, Reference, Sampling
from programs.cost import count_operations

AXIS = Axis("eta", 1.0, 3.0, "η")
LINE = Reference(
    name="line",
    symbol="f",
    meaning="a smooth function of one argument",
    definition="ln η / η",
    axes=(AXIS,),
    sampling=Sampling(fitted=7, checked=8, judged=9),
    closed_form=lambda eta: Estimate(jnp.log(eta) / eta, jnp.full((), 1e-15)),
)


def operations(form: Form, coefficients) -> int:
    """Count the operations of a form whose coefficients are constants."""
    fitted = form.fitted(coefficients)
    return count_operations(traced(fitted, fitted, form.axes)).operations
