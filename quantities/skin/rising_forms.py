"""Forms of the light on curved skin that rise with the cosine and stay in [0, 1], which is proven.

They are those of `hyperbola_forms`, fitted under constraints. It is enough that D' ≥ 0, D(−1) ≥ 0
and D(1) ≤ 1, where D' is the derivative in the cosine c. All three are linear in the coefficients
after multiplication by the denominator B.

For κ → 0 the form tends to max(0, c), where D' is 0 for c < 0. The proof therefore divides by what
vanishes. With the largest curvature m it takes |c| = x u and κ = x v, where (u, v) is (1, m t) or
(t, m), and x and t are in [0, 1]: these reach the whole domain. For c < 0 then

    B D' = v² G + x v R,   G = a²B/(2q̂(q̂ + u)) + a₅₀ u (A² − a²)/(q̂ Q̂ (q̂ + Q̂)),

with q = x q̂ and Q = x Q̂. R has the other terms of N. Both summands have a factor v, and v = m t may
be 0. After division by it, t m G + x R is left, which is divided by the larger of x and t.
"""

import functools
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import jax.numpy as jnp
from jax import Array

from fitting.form import Form, Proofs
from fitting.shapes.monomial_sums import ONE, nested_horner
from fitting.shapes.monomials import Exponents
from fitting.solvers.within_margins import WithinMargins
from integrals.reference import Axis, Reference
from quantities.skin.hyperbola_forms import CHOSEN, MOST_CURVATURE, hyperbola_form
from shading.types import Scalar

PROOF_AXES = (Axis("y", 0.0, 1.0), Axis("s", 0.0, 1.0))
# Widths of q and Q in mm. The terms are those of the forms without constraints.
WIDTHS = {"red": (0.35, 0.9), "green": (0.15, 0.4), "blue": (0.13, 0.6)}


@dataclass(frozen=True)
class _Terms:
    """The terms of a form with some coefficients: those of N without a factor κ, and B."""

    coefficients: Any
    narrow: float
    wide: float
    numerator: Exponents

    def sums(self, k: Array) -> list[Any]:
        """Return Σ aᵢⱼ κʲ⁻¹ over j ≥ 1 for each function i of the cosine."""
        found: list[Any] = [0.0] * 6
        for i in range(6):
            terms: dict[tuple[int, ...], Any] = {
                (j - 1,): self.coefficients[n]
                for n, (function, j) in enumerate(self.numerator)
                if function == i and j
            }
            if terms:
                found[i] = nested_horner(terms, (k,))
        return found

    @property
    def first(self) -> Any:
        """The coefficient of p alone, which has no factor κ."""
        return self.coefficients[self.numerator.index((5, 0))] if (5, 0) in self.numerator else 0.0

    def below(self, k: Array) -> Any:
        """Return B."""
        start = len(self.numerator)
        terms: dict[tuple[int, ...], Any] = {(0,): ONE}
        count = len(self.coefficients) - start
        return nested_horner(
            {**terms, **{(j + 1,): self.coefficients[start + j] for j in range(count)}}, (k,)
        )

    def slope(self, sign: float, x, u, v) -> tuple[Array, Array, Array]:
        """Return the parts of B D' at c = ±x u and κ = x v: without N, of p alone, and R.

        The first two are divided by v² if the sign is negative, and R is multiplied by κ in B D'.
        """
        near = jnp.sqrt(u * u + self.narrow**2 * (v * v))
        far = jnp.sqrt(u * u + self.wide**2 * (v * v))
        _, one, two, four, q, p = self.sums(x * v)
        # c/Q − c/q without cancellation, over v²
        bend = u * (self.wide**2 - self.narrow**2) / (near * far * (near + far))
        of_q = sign * u / near
        c = sign * x * u
        rest = one + 2 * c * two + 4 * (c * c * c) * four + of_q * q - sign * bend * (v * v) * p
        if sign < 0:
            plain = self.narrow**2 / (2 * near * (near + u)) * self.below(x * v)
            return plain, self.first * bend, rest
        return (1 + u / near) / 2 * self.below(x * v), -self.first * bend * (v * v), rest

    def end(self, sign: float, k) -> Array:
        """Return B D(−1)/κ, or B (1 − D(1))/κ for the positive sign."""
        near, far = (jnp.sqrt(1 + width**2 * (k * k)) for width in (self.narrow, self.wide))
        one, c, two, four, q, p = self.sums(k)
        bend = (self.wide**2 - self.narrow**2) / (far + near)
        total = one + sign * c + two + four + near * q + bend * (k * k) * p
        plain = self.narrow**2 / (2 * (near + 1)) * self.below(k)
        return -sign * (k * (plain + self.first * bend) + total)


@functools.cache
def rising_form(
    reference: Reference, *, narrow: float, wide: float, numerator: Exponents, below: int
) -> Form:
    """Return the form of `hyperbola_form` with the same arguments and with the constraints."""
    plain = hyperbola_form(reference, narrow=narrow, wide=wide, numerator=numerator, below=below)
    m = MOST_CURVATURE

    def margins(c, y: Scalar, s: Scalar) -> tuple[Array, ...]:
        y, s = jnp.asarray(y), jnp.asarray(s)
        terms = _Terms(c, narrow, wide, numerator)

        def shadow(x, u, v, of_g, of_r) -> Array:
            g, g0, r = terms.slope(-1.0, x, u, v)
            return of_g * m * (g + g0) + of_r * r

        def light(x, u, v) -> Array:
            g, g0, r = terms.slope(1.0, x, u, v)
            return g + g0 + x * v * r

        one = jnp.ones(())
        return (
            shadow(y, one, m * (s * y), s, 1.0),
            shadow(s * y, one, m * y, 1.0, s),
            shadow(y, s, m * one, 1.0, y),
            light(y, one, m * s),
            light(y, s, m * one),
            terms.end(-1.0, m * y),
            terms.end(1.0, m * y),
        )

    def value(c, y: Scalar, s: Scalar) -> Array:
        return plain.stages[0].call(c, 2 * y - 1, m * s)

    return replace(
        plain,
        name="rising-skin",
        proofs=Proofs(axes=PROOF_AXES, value=value, margins=margins),
        scattered_solver=WithinMargins(),
    )


def rising_candidates(reference: Reference) -> Iterator[Form]:
    """Yield the rising forms of a channel that a search tries."""
    channel = reference.name.rpartition("-")[2]
    (narrow, wide), (_, _, numerator, below) = WIDTHS[channel], CHOSEN[channel]
    yield rising_form(reference, narrow=narrow, wide=wide, numerator=numerator, below=below)
