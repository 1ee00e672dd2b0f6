"""The forms of the supplement to "Samurai Shading in Ghost of Tsushima": Eq. (1) to (5)."""

from dataclasses import replace

import jax.numpy as jnp
from jax import Array

from fitting.form import Form
from integrals import PS, G, Q, R
from shading import direction_cosines
from shading.types import Scalar

# The terms of the vector x of Eq. (2) and (5), in the order of Listing 1.
TERMS = ["β", "γ", "δ", "β²", "γ²", "βγ", "βδ", "β³", "γ³", "δ³", "β²γ", "β²δ", "βγ²"]


def terms(alpha: Scalar, theta_f: Scalar) -> Array:
    """Give x (13,) of Eq. (2) with β = 1 − α, γ = cos θf, δ = sin θf."""
    # notation: β, γ, δ of Eq. (2).
    b, g, d = 1 - jnp.asarray(alpha), jnp.cos(theta_f), jnp.sin(theta_f)
    b2, g2, d2 = b * b, g * g, d * d
    return jnp.stack(
        [b, g, d, b2, g2, b * g, b * d, b2 * b, g2 * g, d2 * d, b2 * g, b2 * d, b * g2]
    )


def direction_basis(cos_un: Scalar, cos_ut: Scalar) -> Array:
    """Give the six functions of direction (6,) that Eq. (1) combines."""
    n, t = jnp.asarray(cos_un), jnp.asarray(cos_ut)
    return jnp.stack([jnp.ones_like(n * t), n, t, n * n, n * t, t * t])


class RationalPs(Form):
    """P̃_s of Eq. (1), its six coefficients the rational functions of Eq. (2).

    `coefficients` (6, 27): rows c₀ … c₅ in the order of Eq. (1), each t, p₁ … p₁₃, q₁ … q₁₃.
    """

    name = "rational-ps"
    equation = "Eq. (1) and (2)"
    integral = PS
    axes = (
        replace(PS.axes[0], lower=0.15, open_below=False),
        replace(PS.axes[1], lower=0.1),
        PS.axes[2],
        PS.axes[3],
    )

    def material(self, alpha: Scalar, theta_f: Scalar) -> Array:
        """Give c₀ … c₅ (6,) of one material (Eq. 2)."""
        x, beta = terms(alpha, theta_f), 1 - jnp.asarray(alpha)
        numerator = self.coefficients[:, 0] + self.coefficients[:, 1:14] @ x
        denominator = 1 + self.coefficients[:, 14:] @ x
        offset = jnp.array([0.5, 0, 0, 0, 0, 0])
        return offset + beta * numerator / denominator

    def positive(self, alpha: Scalar, theta_f: Scalar, theta_u: Scalar, phi: Scalar) -> Array:
        """Give the least of the six denominators."""
        return jnp.min(1 + self.coefficients[:, 14:] @ terms(alpha, theta_f))

    def __call__(self, alpha: Scalar, theta_f: Scalar, theta_u: Scalar, phi: Scalar) -> Array:
        """Evaluate P̃_s at one material and one direction of light."""
        cosines = direction_cosines(theta_f, theta_u, jnp.cos(phi))
        return self.material(alpha, theta_f) @ direction_basis(*cosines)

    @classmethod
    def coefficient_names(cls) -> list:
        """Name the coefficients by row and, within it, by the term that each multiplies."""
        row = ["t", *(f"p {x}" for x in TERMS), *(f"q {x}" for x in TERMS)]
        return [[f"c{i}: {name}" for name in row] for i in range(6)]


class RationalG(Form):
    """G̃ of Eq. (3): d (1 + c₀ν + c₁ν²) / (d + c₂ν + c₃ν³), ν = v·n; `coefficients` (4,)."""

    name = "rational-g"
    equation = "Eq. (3)"
    integral = G
    axes = (
        replace(G.axes[0], lower=0.001, upper=0.5),
        replace(G.axes[1], lower=0.001),
    )

    def __call__(self, density: Scalar, cos_v: Scalar) -> Array:
        """Evaluate G̃ at one density and one cosine of the view."""
        c, d, nu = self.coefficients, jnp.asarray(density), jnp.asarray(cos_v)
        return d * (1 + nu * (c[0] + nu * c[1])) / (d + nu * (c[2] + nu * nu * c[3]))

    @classmethod
    def linear_parts(cls, density: Scalar, cos_v: Scalar) -> tuple[Array, Array, Array, Array]:
        """Give a₀, a, b₀, b with G̃ = (a₀ + a·c)/(b₀ + b·c) at one point."""
        d, nu, none = jnp.asarray(density), jnp.asarray(cos_v), jnp.zeros(())
        above = jnp.stack([d * nu, d * nu * nu, none, none])
        return d, above, d, jnp.stack([none, none, nu, nu**3])

    @classmethod
    def coefficient_names(cls) -> list:
        """Name the coefficients by the term that each multiplies."""
        return ["c0: dν", "c1: dν²", "c2: ν", "c3: ν³"]


class QuadraticQ(Form):
    """Q̃ of Eq. (4): 1 + c₀d + c₁d²; `coefficients` (2,)."""

    name = "quadratic-q"
    equation = "Eq. (4)"
    integral = Q
    axes = (replace(Q.axes[0], upper=0.5),)

    def __call__(self, density: Scalar) -> Array:
        """Evaluate Q̃ at one density."""
        c, d = self.coefficients, jnp.asarray(density)
        return 1 + d * (c[0] + d * c[1])

    @classmethod
    def linear_parts(cls, density: Scalar) -> tuple[Array, Array, Array, Array]:
        """Give a₀, a, b₀, b with Q̃ = (a₀ + a·c)/(b₀ + b·c) at one point."""
        d, one = jnp.asarray(density), jnp.ones(())
        return one, jnp.stack([d, d * d]), one, jnp.zeros(2)

    @classmethod
    def coefficient_names(cls) -> list:
        """Name the coefficients by the term that each multiplies."""
        return ["c0: d", "c1: d²"]


class RationalR(Form):
    """R̃ of Eq. (5): ½ + β (t + pᵀx) / (1 + qᵀy); `coefficients` (17,): t, p₁ … p₁₃, q₁ … q₃."""

    name = "rational-r"
    equation = "Eq. (5)"
    integral = R
    axes = (replace(R.axes[0], lower=0.15, open_below=False), R.axes[1])

    def __call__(self, alpha: Scalar, theta_f: Scalar) -> Array:
        """Evaluate R̃ at one material."""
        c, x, beta = self.coefficients, terms(alpha, theta_f), 1 - jnp.asarray(alpha)
        return 0.5 + beta * (c[0] + c[1:14] @ x) / (1 + c[14:] @ x[:3])

    def positive(self, alpha: Scalar, theta_f: Scalar) -> Array:
        """Give the denominator."""
        return 1 + terms(alpha, theta_f)[:3] @ jnp.asarray(self.coefficients[14:])

    @classmethod
    def linear_parts(cls, alpha: Scalar, theta_f: Scalar) -> tuple[Array, Array, Array, Array]:
        """Give a₀, a, b₀, b with R̃ = (a₀ + a·c)/(b₀ + b·c) at one point."""
        x, beta, one = terms(alpha, theta_f), 1 - jnp.asarray(alpha), jnp.ones(())
        above = jnp.concatenate([beta[None], beta * x, 0.5 * x[:3]])
        return jnp.asarray(0.5), above, one, jnp.concatenate([jnp.zeros(14), x[:3]])

    @classmethod
    def coefficient_names(cls) -> list:
        """Name the coefficients by the term that each multiplies."""
        return ["t", *(f"p {x}" for x in TERMS), *(f"q {x}" for x in TERMS[:3])]


PAPER_FORMS: dict[str, type[Form]] = {
    form.name: form for form in (RationalPs, RationalG, QuadraticQ, RationalR)
}
