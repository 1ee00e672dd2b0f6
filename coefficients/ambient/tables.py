"""G, Q and R of the tables that the exported ambient functions use, and P_s in closed form.

docs/ambient-light.md has the errors with other tables, from which these were chosen.
"""

import functools
from collections.abc import Callable
from dataclasses import replace

import jax
from jax import Array

from coefficients.agreement import fitted_form
from coefficients.packaged import packaged_table
from quantities import problem
from shading.fuzz.lit_cone import FEWEST_STEPS, scattered_fraction
from shading.types import Scalar

G, Q, R = "best/g-17", "best/q-5", "best/r-40-wide"


@functools.cache
def table_call(name: str) -> Callable[..., Array]:
    """Return the exported function of a table with one function, clamps included.

    Cosines stand for angles: R takes the roughness α and n·t.
    """
    table = packaged_table(name)
    owner = problem(table.quantity)
    calling = replace(owner.calling, cosines=any(each.cosine for each in owner.calling.arguments))
    # The first call may be made while another function is traced.
    with jax.ensure_compile_time_eval():
        (only,) = calling.functions(fitted_form(table, owner))
    return only.call


def scattering(cos_v: Scalar, density: Scalar) -> Array:
    """Return G(d, v)."""
    return table_call(G)(cos_v, density)


def average_penetration(density: Scalar) -> Array:
    """Return Q(d)."""
    return table_call(Q)(density)


def average_scattered(alpha: Scalar, cos_nt: Scalar) -> Array:
    """Return R(α, θf), which is even in n·t."""
    return table_call(R)(alpha, abs(cos_nt))


def scattered(cos_v: Scalar, cos_vt: Scalar, cos_nt: Scalar, alpha: Scalar) -> Array:
    """Return P_s(v)."""
    return scattered_fraction(cos_v, cos_vt, cos_nt, alpha, FEWEST_STEPS)
