"""Forms of P_s that have known properties of the exact function built in.

P_s depends on c = u·n, a = u·t, b = n·t and α. It is the same for t and −t, and ½ at α = 1. With
κ = 1 − α², T = κab, σ² = 1 − κa², q = 1 − κb² and S = σ√q, the closed form (docs/closed-form.md)
contains the positive root λ of λ (λ − S + T)(λ + S + T) = α²c (1 − λ²). Each form has a first stage
that is evaluated once for a material, and a short second stage for each direction of light.
"""

import functools
import itertools
from collections.abc import Iterator

import jax.numpy as jnp
import numpy as np
from jax import Array
from jax.ad_checkpoint import checkpoint_name

from fitting.form import Form
from fitting.shapes.surfaces import flat_start, surface_names, surface_values
from quantities.fuzz.material import DirectionProofs, material_form
from quantities.fuzz.ps_equations import cubic_equation, one_root_equation, two_root_equation
from shading.types import Scalar

MAX_DEGREE = 4
# A lower limit of denominators, of radicands and of λ. It changes no value for unit vectors u, n
# and t. It avoids division by zero after rounding, and for cosines that belong to no unit vectors.
LEAST = 1e-6
_LEAST_TEXT = "1e-6"


def _named(names: list[str], values: list[Array]) -> list[Array]:
    """Give values names that exported code uses for its variables."""
    return [checkpoint_name(value, name) for name, value in zip(names, values, strict=True)]


@functools.cache
def one_root_ps(*, skew: int, degree: int, least_alpha: float) -> Form:
    """Return ½ + (m₀c + m₁a [+ m₆ca]) / √(m₂ + m₃c + m₄a² [+ m₅ca]).

    The terms with the product ca are there only if `skew` is 1. The mᵢ depend on the material by
    polynomials in α and y = cos²θf of total degree `degree`: four, or six with `skew`. The value is
    ½ at α = 1.
    """
    surfaces = ["u0", "u1", "u2", "u3", "u4", "u5"][: 6 if skew else 4]

    def _above(m, c, a):
        return m[0] * c + a * (m[1] + m[6] * c) if skew else m[0] * c + m[1] * a

    def material(coefficients, alpha: Scalar, theta_f: Scalar) -> tuple[Array, ...]:
        """Return m₀ … m₄, and with `skew` also m₅ and m₆."""
        alpha = jnp.asarray(alpha)
        b = jnp.cos(theta_f)
        y = b * b
        beta = 1 - alpha
        kappa = beta * (1 + alpha)
        u = _named(surfaces, surface_values(coefficients, len(surfaces), degree, alpha, y))
        m = (-beta * u[0], kappa * b * u[1], 1 - kappa * y, u[2], u[3])
        return (*m, b * u[4], beta * b * u[5]) if skew else m

    def radicand(m: tuple, cos_un: Scalar, cos_ut: Scalar) -> Array:
        c, a = cos_un, cos_ut
        curved = a * (m[4] * a + m[5] * c) if skew else m[4] * a * a
        return m[2] + m[3] * c + curved

    def along(m: tuple, cos_un: Scalar, cos_ut: Scalar) -> Array:
        return 0.5 + _above(m, cos_un, cos_ut) / jnp.sqrt(radicand(m, cos_un, cos_ut))

    def limited(m: tuple, cos_un: Scalar, cos_ut: Scalar) -> Array:
        r = jnp.maximum(radicand(m, cos_un, cos_ut), LEAST)
        return 0.5 + _above(m, cos_un, cos_ut) / jnp.sqrt(r)

    def margins(m: tuple, _: Scalar, cos_un: Scalar, cos_ut: Scalar) -> tuple[Array, ...]:
        """Return r − 4N², where the form is ½ + N/√r (docs/range.md)."""
        twice = 2 * _above(m, cos_un, cos_ut)
        return (radicand(m, cos_un, cos_ut) - twice * twice,)

    # The start approximates P_s at grazing light, c = 0, where P_s = ½ + T/(2S), and for a light
    # along n.
    values = [0.2, 0.5, 0.0, -0.95, 0.0, 0.0][: len(surfaces)]
    return material_form(
        name="one-root-ps",
        equation=one_root_equation(skew, degree),
        least_alpha=least_alpha,
        shape={"skew": skew, "degree": degree, "least_alpha": least_alpha},
        coefficient_names=surface_names(surfaces, degree, "α", "y"),
        starts=(flat_start(values, degree, {3: (1.0, 1.7)}),),
        material=material,
        along=along,
        limited=limited,
        proofs=DirectionProofs(along, margins, radicand),
    )


@functools.cache
def two_root_ps(*, terms: int, degree: int, least_alpha: float) -> Form:
    """Return 1 − t (t + m₃c) / (8 (σR + m₄c [+ m₆c²])), h = σ − m₁a [+ m₅c], R = √(h² + m₂c).

    t = h + R is the positive root of t² = 2ht + m₂c; at c = 0, √q h = S − T. The mᵢ depend on the
    material by `terms` (3, 4 or 5) polynomials in α and y = cos²θf of total degree `degree`. The
    term with m₅ is there for 4 or 5 polynomials, that with m₆ for 5. The form is exact at c = 0,
    and ½ at α = 1.
    """
    surfaces = ["u0", "u1", "u2", "u3", "u4"][:terms]

    def _parts(m, c, a):
        # notation: h and R of the equation
        sigma = jnp.sqrt(1 - m[0] * a * a)
        h = sigma - m[1] * a
        if terms > 3:
            h = h + m[5] * c
        R = jnp.sqrt(h * h + m[2] * c)
        return sigma, h, R

    def _slope(m, c):
        return m[4] + m[6] * c if terms > 4 else m[4]

    def material(coefficients, alpha: Scalar, theta_f: Scalar) -> tuple[Array, ...]:
        """Return m₀ … m₄, and m₅ and m₆ if the form has them."""
        alpha = jnp.asarray(alpha)
        b = jnp.cos(theta_f)
        y = b * b
        beta = 1 - alpha
        kappa = beta * (1 + alpha)
        q = 1 - kappa * y
        root = jnp.sqrt(q)
        u = _named(surfaces, surface_values(coefficients, terms, degree, alpha, y))
        if terms == 3:
            return (
                kappa,
                kappa * b / root,
                beta * u[0] * u[0] / q,
                (2 * u[1] + beta * u[2]) / root,
                u[1] / q,
            )
        h = beta * u[1] - u[0] * u[0] / 4
        m = (
            kappa,
            kappa * b / root,
            u[0] * u[0] / q,
            (2 * (u[2] - h) + beta * u[3]) / root,
            u[2] / q,
            h / root,
        )
        return m if terms == 4 else (*m, beta * u[4] / q)

    def along(m: tuple, cos_un: Scalar, cos_ut: Scalar, least: float = LEAST) -> Array:
        c, a = cos_un, cos_ut
        sigma, h, root = _parts(m, c, a)
        t = h + root
        below = jnp.maximum(sigma * root + _slope(m, c) * c, least)
        return 1 - 0.125 * t * (t + m[3] * c) / below

    def positive(m: tuple, cos_un: Scalar, cos_ut: Scalar) -> Array:
        """Return the denominator over its value at c = 0."""
        sigma, _, root = _parts(m, cos_un, cos_ut)
        return 1 + _slope(m, cos_un) * cos_un / (sigma * root)

    def margins(m: tuple, cos_nt: Scalar, cos_un: Scalar, cos_ut: Scalar) -> tuple[Array, ...]:
        """Return m₂, t + m₃c, and a lower bound of (t/c) times the numerator of P̃_s."""
        # notation: docs/range.md; q = 1 − κb². t ≥ 0 if m₂ ≥ 0, but intervals would not show it.
        c, a = cos_un, cos_ut
        sigma, h, root = _parts(m, c, a)
        t, slope = jnp.maximum(h + root, 0), _slope(m, c)
        rise = 2 / jnp.sqrt(1 - m[0] * cos_nt * cos_nt) - (2 * m[5] if terms > 3 else 0) - m[3]
        return m[2], t + m[3] * c, t * (t * rise + 8 * slope - m[2]) + 4 * sigma * m[2]

    # In the start m₂ = (1.7 α)²/q, for 3 terms times 1 − α.
    values = [0.0, 0.03, 0.0] if terms == 3 else [0.0, 0.0, 0.03, 0.0, 0.0]
    return material_form(
        name="two-root-ps",
        equation=two_root_equation(terms, degree, _LEAST_TEXT),
        least_alpha=least_alpha,
        shape={"terms": terms, "degree": degree, "least_alpha": least_alpha},
        coefficient_names=surface_names(surfaces, degree, "α", "y"),
        starts=(flat_start(values[:terms], degree, {0: (1.7, 0.0)}),),
        material=material,
        along=along,
        proofs=DirectionProofs(
            lambda m, cos_un, cos_ut: along(m, cos_un, cos_ut, -np.inf), margins, positive
        ),
    )


def _improved(root: Array, b: Array, w: Array, E: Array, steps: int) -> Array:
    """Improve the root of λ³ + bλ² − wλ = E by Newton steps, each of them one quotient."""
    for _ in range(steps):
        product = (root + b) * root
        rising = root * root + product
        slope = jnp.maximum(rising + (product - w), LEAST)
        root = jnp.maximum((rising * root + E) / slope, LEAST)
    return root


@functools.cache
def cubic_ps(*, steps: int, degree: int, least_alpha: float) -> Form:
    """Return the closed form with an approximate root λ of the cubic.

    P̃_s = 1 − √((λ + c)(λ + E/σ²)) / D, E = α²c, D = ((λ + T)² − S²)/λ + 2 (λ + T + E). If the
    factor λ + S + T of the cubic is replaced by a number g, a quadratic remains. Its positive root
    is the first λ, and `steps` Newton steps follow. If `degree` is −1, g = S + max(S, T), and the
    form has no coefficients. Otherwise g = S + √(S² + T² + m₅c), where m₅ contains a polynomial in
    α and y = cos²θf of total degree `degree`.

    With two steps the form is so precise that rounding would be seen. Then q and σ² are sums of
    positive numbers, S² − T² is a product, and a step is one quotient, which saves what σ² costs.
    """
    precise = steps > 1

    def material(coefficients, alpha: Scalar, theta_f: Scalar) -> tuple[Array, ...]:
        """Return κ, α², κb, q, √q, and m₅ if the form has it."""
        alpha = jnp.asarray(alpha)
        b = jnp.cos(theta_f)
        y = b * b
        square = alpha * alpha
        beta = 1 - alpha
        kappa = beta * (1 + alpha)
        sine = jnp.sin(theta_f)
        q = square + kappa * (sine * sine) if precise else 1 - kappa * y
        m = (kappa, square, kappa * b, q, jnp.sqrt(q))
        if degree < 0:
            return m
        (u,) = surface_values(coefficients, 1, degree, alpha, y)
        return (*m, u * beta * square)

    def along(m: tuple, cos_un: Scalar, cos_ut: Scalar) -> Array:
        # notation: as above, root is λ; the cubic is λ³ + bλ² ± wλ − E, with w = ±(T² − S²).
        c, a = cos_un, cos_ut
        sigma2 = m[1] + m[0] * ((1 - a) * (1 + a)) if precise else 1 - m[0] * a * a
        S = m[4] * jnp.sqrt(sigma2)
        T = m[2] * a
        E = m[1] * c
        square = S * S if degree >= 0 or not steps else None
        g = jnp.maximum(S, T) if degree < 0 else jnp.sqrt(square + T * T + m[5] * c)
        e = E / (S + g + E)
        h = (S - T) * (0.5 - 0.5 * e)
        root = jnp.maximum(h + jnp.sqrt(h * h + e), LEAST)
        ellipse = None
        if precise:
            p = S - T
            r = S + T
            b = E + (r - p)
            w = p * r
            root = _improved(root, b, w, E, steps)
            ellipse = 3 * root + (b + b) - w / root
        elif steps:
            b = E + T + T
            w = (1 - sigma2) - m[3]
            for _ in range(steps):
                y = root + b
                z = y * root + w
                slope = jnp.maximum((y + root) * root + z, LEAST)
                root = jnp.maximum(root - (z * root - E) / slope, LEAST)
            ellipse = 3 * root + (b + b) + w / root
        else:
            top = root + T
            both = top + E
            ellipse = (top * top - square) / root + (both + both)
        return 1 - jnp.sqrt((root + c) * (root + E / sigma2)) / jnp.maximum(ellipse, LEAST)

    def margins(m: tuple, _: Scalar, cos_un: Scalar, cos_ut: Scalar) -> tuple[Array, ...]:
        """Return the radicand in g, if g has one. docs/range.md proves that no more is needed."""
        if degree < 0:
            return ()
        s2, t = (1 - m[0] * cos_ut * cos_ut) * m[3], m[2] * cos_ut
        return (s2 + t * t + m[5] * cos_un,)

    return material_form(
        name="cubic-ps",
        equation=cubic_equation(steps, degree, _LEAST_TEXT),
        least_alpha=least_alpha,
        shape={"steps": steps, "degree": degree, "least_alpha": least_alpha},
        coefficient_names=surface_names(["m5"], degree, "α", "y") if degree >= 0 else [],
        starts=(flat_start([2.0], degree) if degree >= 0 else np.zeros(0),),
        material=material,
        along=along,
        proofs=DirectionProofs(along, margins),
    )


def candidates(least_alpha: float) -> Iterator[Form]:
    """Yield the forms of P_s that a search tries, for α ≥ `least_alpha`."""
    for skew, degree in itertools.product(range(2), (1, 2, 3)):
        yield one_root_ps(skew=skew, degree=degree, least_alpha=least_alpha)
    for terms, degree in itertools.product((3, 4, 5), (2, 3, 4)):
        yield two_root_ps(terms=terms, degree=degree, least_alpha=least_alpha)
    for steps in range(4):
        yield cubic_ps(steps=steps, degree=-1, least_alpha=least_alpha)
    for degree in (0, 2, 4):
        yield cubic_ps(steps=0, degree=degree, least_alpha=least_alpha)
