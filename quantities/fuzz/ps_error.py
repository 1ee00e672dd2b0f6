"""The error of forms of P_s in interval arithmetic, for proofs of the largest error.

The variables are α, tan(θf/2), tan(θu/2) and cos φ. In them the domain is a box, and sines and
cosines are rational. The positive root λ of the cubic is one operation (`kernel/cubic_root.h`).
"""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.form import FittedForm
from fitting.proofs.largest_error import ENOUGH, ErrorCode, printed
from fitting.proofs.pole_proof import certify_denominators
from programs.functions import Function, Parameter
from programs.jax_operations import JAX_OPERATIONS
from programs.program import interpret
from programs.tracing.tracer import trace
from quantities.fuzz.ps_forms import LEAST

KERNEL = Path(__file__).parent / "kernel"
_MOST_COEFFICIENTS = 75
_GEOMETRY = ("alpha", "half_f", "half_u", "cos_phi")
SIZES = ("alpha2", "kappa", "a", "b", "c")
_LIGHT = ("alpha", *SIZES, "sigma2", "q", "p", "r", "m", "lam", "gap", "sin_f")

_ENTRY = """
static jet error_at(boxes *K, const jet *x) {
    jet g[6], s[2], f[3], root, gap;
    geometry(K, x[0], x[1], x[2], x[3], g);
    cubic_at(K, g, s, f, &root, &gap);
    jet e[2];
    error(K, x[0], g[0], g[1], g[2], g[3], g[4], s[0], s[1], f[0], f[1], f[2], root, gap, g[5], e);
    if (RESULTS > 1) K->bad |= ~(-e[1].v.n > LEAST);
    return e[0];
}
"""


class _Angle(NamedTuple):
    """An angle of which only the cosine and the sine are known."""

    cosine: Array
    sine: Array


def material_of(fitted: FittedForm) -> Callable[[Array, Array, Array], tuple[Array, ...]]:
    """Return the first stage of a form as a function of α, cos θf and sin θf.

    Raises ValueError for a form that uses θf otherwise.
    """
    parameters = (Parameter("alpha", (0.0, 1.0)), Parameter("theta_f", (0.0, 1.6)))
    count = len(fitted.first(1.0, 0.0))

    def stage(alpha, theta_f):
        return tuple(jnp.asarray(x) for x in fitted.form.first(fitted.constants, alpha, theta_f))

    program = trace(Function("material", "", parameters, count, "m", stage))
    table = {name: _of_numbers(name, operation) for name, operation in JAX_OPERATIONS.items()}
    table["cos"] = lambda x: x.cosine if isinstance(x, _Angle) else jnp.cos(x)
    table["sin"] = lambda x: x.sine if isinstance(x, _Angle) else jnp.sin(x)

    def material(alpha: Array, cosine: Array, sine: Array) -> tuple[Array, ...]:
        return interpret(program, [alpha, _Angle(cosine, sine)], table, jnp.asarray)

    return material


def _of_numbers(name: str, operation: Callable) -> Callable:
    def apply(*operands):
        if any(isinstance(each, _Angle) for each in operands):
            raise ValueError(f"{name!r} of an angle in a form of P_s: allowed are cos and sin")
        return operation(*operands)

    return apply


def _geometry(alpha, half_f, half_u, cos_phi):
    near_f, near_u = 2 / (1 + half_f * half_f), 2 / (1 + half_u * half_u)
    b, c = near_f - 1, near_u - 1
    a = (half_f * near_f) * (half_u * near_u) * cos_phi + b * c
    return alpha * alpha, (1 - alpha) * (1 + alpha), a, b, c, half_f * near_f


def sizes(alpha2, kappa, a, b, c):
    """Return σ_u² and σ_n²."""
    return 1 - kappa * (a * a), 1 - kappa * (b * b)


def factors(alpha2, kappa, a, b, c, sigma2, q):
    """Return p, r and m of the cubic λ (λ − p)(λ + r) = m (1 − λ²)."""
    s, t = jnp.sqrt(sigma2 * q), kappa * (a * b)
    return s - t, s + t, alpha2 * c


def complement(c, sigma2, r, m, root, gap):
    """Return 1 − P_s = √((λ + c)(λ + m/σ²)) / (λ + r + (λ − p) + m + m/λ²)."""
    root2 = root * root
    return jnp.sqrt((root + c) * (root + m / sigma2)) / (root + r + gap + m + m / root2)


def plain_error(fitted: FittedForm) -> Callable[..., tuple[Array]]:
    """Return P̃_s − P_s as a function of the numbers in `_LIGHT`."""
    material, along = material_of(fitted), fitted.form.stages[1].call

    def error(alpha, alpha2, kappa, a, b, c, sigma2, q, p, r, m, root, gap, sin_f):
        value = along(material(alpha, b, sin_f), c, a)
        return (value - 1 + complement(c, sigma2, r, m, root, gap),)

    return error


def factored_error(fitted: FittedForm, steps: int, degree: int) -> Callable[..., tuple]:
    """Return P̃_s − P_s of a form with the cubic, as a product that cancels nothing.

    With f the cubic, Q(x) = f(x)/(x − λ) and H(x) = x √((x + c)(x + m/σ²)) / f′(x), P_s is
    1 − H(λ). The first λ̃ of the form has the distance d = f(λ̃)/Q(λ̃) from λ, and a Newton step
    changes d to d² (2λ̃ + λ + A)/f′(λ̃). The error is −d (H(λ̃) − H(λ))/(λ̃ − λ), and this quotient
    is written out.

    The second result is the least number that the form keeps above `LEAST`. If it is above `LEAST`,
    these limits have no effect, and the first result is the error.
    """
    material = material_of(fitted)

    def error(alpha, alpha2, kappa, a, b, c, sigma2, q, p, r, m, root, gap, sin_f):
        # notation: x = λ̃, total = λ + A = (λ − p) + r + m, as a sum of what is not negative
        s, t = (p + r) / 2, (r - p) / 2
        total = gap + r + m
        if degree < 0:
            frozen = s + jnp.maximum(s, t)
        else:
            guess = material(alpha, b, sin_f)[5]
            frozen = s + jnp.sqrt(s * s + t * t + guess * c)
        part = m / (frozen + m)
        half = p * (0.5 - 0.5 * part)
        start = half + jnp.sqrt(half * half + part)
        # The bounds are true of the exact value (docs/closed-form.md).
        x = jnp.minimum(jnp.maximum(start, jnp.maximum(p, 0.0)), 1.0)
        rate = m * ((1 - x) * (1 + x)) / frozen
        # λ̃ + r − g, which is λ̃ − max(p, 0) without coefficients
        apart = x + r - frozen if degree >= 0 else jnp.minimum(x, rate / x)
        quotient = x * (x + total) + m / root
        d = rate * apart / quotient
        least = x
        for _ in range(steps):
            x = root + d
            rise = 2 * x + total
            slope = x * (x + total) + m / root + d * rise
            least = jnp.minimum(jnp.minimum(least, x), slope)
            d = d * d * rise / slope
        x = root + d
        slope = x * (x + total) + m / root + d * (2 * x + total)
        least = jnp.minimum(jnp.minimum(least, x), slope / x)
        # f′(λ), as a sum of what is not negative
        at_root = gap * (root + r) + root * (root + r) + root * gap + 2 * m * root
        ratio = m / sigma2
        above, above_root = jnp.sqrt((x + c) * (x + ratio)), jnp.sqrt((root + c) * (root + ratio))
        divided = (x + root + c + ratio) / (above + above_root)
        fraction = root * above_root / at_root
        bend = 3 * (x + root) + 2 * (m + r - p)
        return -d * ((above + root * divided - fraction * bend) / slope), least

    return error


def error_code(fitted: FittedForm) -> ErrorCode:
    """Return the code of P̃_s − P_s for a form of two stages.

    No radicand of P_s is negative. Those of the form are proven not to be, if possible.
    """
    shape = fitted.form.shape or {}
    if "steps" in shape:
        error, results = factored_error(fitted, shape["steps"], shape["degree"]), 2
    else:
        error, results = plain_error(fitted), 1
    parts = (
        printed("geometry", _GEOMETRY, _geometry, 6),
        printed("sizes", SIZES, sizes, 2),
        printed("factors", (*SIZES, "sigma2", "q"), factors, 3),
        (KERNEL / "cubic_root.h").read_text("utf-8"),
        printed("error", _LIGHT, error, results),
        f"#define RESULTS {results}\n#define LEAST {LEAST!r}",
        _ENTRY,
    )
    alpha, theta_f = fitted.axes[:2]
    half_f = np.tan(theta_f.lower / 2) * (1 - 1e-15), 1.0
    box = np.array([[alpha.lower, alpha.upper], half_f, [0.0, 1.0], [-1.0, 1.0]])
    proven = certify_denominators(fitted, ENOUGH).holds
    # Code of many coefficients compiles for minutes, and its search is short.
    long = fitted.form.size <= _MOST_COEFFICIENTS
    return ErrorCode(parts, box, _to_axes, _from_axes, roots_are_defined=proven, long=long)


def _to_axes(points: np.ndarray) -> np.ndarray:
    alpha, half_f, half_u, cos_phi = points.T
    return np.stack(
        [alpha, 2 * np.arctan(half_f), 2 * np.arctan(half_u), np.arccos(cos_phi)], axis=1
    )


def _from_axes(points: np.ndarray) -> np.ndarray:
    alpha, theta_f, theta_u, phi = points.T
    return np.stack([alpha, np.tan(theta_f / 2), np.tan(theta_u / 2), np.cos(phi)], axis=1)
