"""The forms of the supplement to "Samurai Shading in Ghost of Tsushima": Eq. (1) to (5)."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.form import Form, Proofs, Stage, unguarded
from fitting.points.grids import gauss_grid, trapezoid_grid
from fitting.shapes.quotients import Quotients
from fitting.solvers.on_grid import MARQUARDT, OnGrid
from fitting.solvers.quotients import fit_quotient_on_grid
from fitting.solvers.separable import Separable
from integrals import PS, G, Q, R
from integrals.reference import restricted
from quantities.fuzz.lights import cosines_of_light, light_directions
from quantities.fuzz.ps_equations import rational_ps_equation, rational_r_equation
from shading.fuzz.lit_cone import scattered_fraction
from shading.types import Scalar

# The elements of the vector x of Eq. (2) and (5), in the order of Listing 1.
TERMS = ["β", "γ", "δ", "β²", "γ²", "βγ", "βδ", "β³", "γ³", "δ³", "β²γ", "β²δ", "βγ²"]
# The denominator of Eq. (5) takes only this many of them, the first ones.
_BELOW_R = 3
# P_s is fitted with 48² = 2,304 lights for each material. The least rms error that Eq. (1) can have
# changes by less than 1e-6 with 96² lights (tests/fitting/test_separable.py).
LIGHTS_PER_ANGLE = 48


def terms(alpha: Scalar, theta_f: Scalar) -> Array:
    """Return x (13,) of Eq. (2) with β = 1 − α, γ = cos θf, δ = sin θf."""
    # notation: b, g, d are β, γ, δ of Eq. (2).
    b = 1 - jnp.asarray(alpha)
    g = jnp.cos(theta_f)
    d = jnp.sin(theta_f)
    b2, g2, d2 = b * b, g * g, d * d
    return jnp.stack(
        [b, g, d, b2, g2, b * g, b * d, b2 * b, g2 * g, d2 * d, b2 * g, b2 * d, b * g2]
    )


def beta(alpha: Scalar, _: Scalar) -> Array:
    """Return β = 1 − α, which multiplies the quotients of Eq. (2) and (5)."""
    return 1 - jnp.asarray(alpha)


def direction_basis(cos_un: Scalar, cos_ut: Scalar) -> Array:
    """Return the six functions of direction (6,) that Eq. (1) combines."""
    n, t = jnp.asarray(cos_un), jnp.asarray(cos_ut)
    return jnp.stack([jnp.ones_like(n * t), n, t, n * n, n * t, t * t])


def _combined(c, cos_un: Scalar, cos_ut: Scalar) -> Array:
    """Return P_s by Eq. (1): the functions of direction, weighted by a material's c₀ … c₅."""
    return jnp.asarray(c) @ direction_basis(cos_un, cos_ut)


PS_ROWS = Quotients(terms, beta, (0.5, 0.0, 0.0, 0.0, 0.0, 0.0), len(TERMS), len(TERMS))
# The least denominators of the published and of the refitted table are 0.0043 and 0.0195.
# A limit just below them changes no value; without it, half precision would round some to 0.
LIMITED_PS_ROWS = replace(PS_ROWS, least=2.0**-8)
R_QUOTIENT = Quotients(terms, beta, 0.5, len(TERMS), _BELOW_R)

_ROW_NAMES = ["t", *(f"p {x}" for x in TERMS), *(f"q {x}" for x in TERMS)]

RATIONAL_PS = Form(
    name="rational-ps",
    equation=rational_ps_equation(),
    printed="Eq. (1) and (2)",
    reference=PS,
    axes=restricted(PS.axes, alpha=(0.15, 1.0), theta_f=(0.1, np.pi / 2)),
    coefficient_names=[[f"c{i}: {name}" for name in _ROW_NAMES] for i in range(6)],
    stages=(
        Stage(
            PS_ROWS,
            "Coefficients c of {name} for one material (Eq. 2); clamps to the domain.",
            limited=LIMITED_PS_ROWS,
        ),
        Stage(
            _combined,
            "P_s for one direction of light (Eq. 1): c[3] goes with (u·n)², c[4] with (u·n)(u·t).",
        ),
    ),
    shared=2,
    inputs=cosines_of_light,
    proofs=Proofs(
        positive=lambda c, alpha, theta_f, *_: PS_ROWS.positive(c, alpha, theta_f),
        first_split=(64, 8),
    ),
    solver=Separable(
        PS_ROWS,
        rule=lambda measure: light_directions(LIGHTS_PER_ANGLE, measure),
        exact=lambda alpha, theta_f, cos_un, cos_ut: scattered_fraction(
            cos_un, cos_ut, jnp.cos(theta_f), alpha
        ),
    ),
)


def _rational_g(c, density: Scalar, cos_v: Scalar) -> Array:
    d, nu = jnp.asarray(density), jnp.asarray(cos_v)
    return d * (1 + nu * (c[0] + nu * c[1])) / (d + nu * (c[2] + nu * nu * c[3]))


RATIONAL_G = Form(
    name="rational-g",
    equation="G = d·(1 + ν·(c0 + ν·c1))/(d + ν·(c2 + ν²·c3))",
    printed="Eq. (3)",
    reference=G,
    axes=restricted(G.axes, density=(0.001, 0.5), cos_v=(0.001, 1.0)),
    coefficient_names=["c0: dν", "c1: dν²", "c2: ν", "c3: ν³"],
    stages=(Stage(_rational_g),),
    proofs=Proofs(positive=unguarded),
    solver=OnGrid(gauss_grid),
)


def _quadratic_q(c, density: Scalar) -> Array:
    d = jnp.asarray(density)
    return 1 + d * (c[0] + d * c[1])


QUADRATIC_Q = Form(
    name="quadratic-q",
    equation="Q = 1 + d·(c0 + d·c1)",
    printed="Eq. (4)",
    reference=Q,
    axes=restricted(Q.axes, density=(0.0, 0.5)),
    coefficient_names=["c0: d", "c1: d²"],
    stages=(Stage(_quadratic_q),),
    solver=OnGrid(gauss_grid),
)

RATIONAL_R = Form(
    name="rational-r",
    equation=rational_r_equation(_BELOW_R),
    printed="Eq. (5)",
    reference=R,
    axes=restricted(R.axes, alpha=(0.15, 1.0)),
    coefficient_names=["t", *(f"p {x}" for x in TERMS), *(f"q {x}" for x in TERMS[:_BELOW_R])],
    stages=(Stage(R_QUOTIENT),),
    proofs=Proofs(positive=R_QUOTIENT.positive),
    solver=OnGrid(
        trapezoid_grid,
        lambda grid, exact: fit_quotient_on_grid(R_QUOTIENT, grid, exact),
        MARQUARDT,
    ),
)
