"""Boxes of the proofs for P_s, replayed by mpmath's interval arithmetic with derivatives."""

import mpmath
import numpy as np
import pytest

from coefficients.catalogue import resolve
from programs.bounding.compiled import compiler_missing
from programs.bounding.largest import bound_largest
from programs.functions import Function, Parameter
from programs.program import Program
from programs.tracing.tracer import trace
from quantities.fuzz import ps_error
from tests.programs.interval_jets import IV, Jet, evaluated, variables

pytestmark = pytest.mark.skipif(compiler_missing() is not None, reason="no C compiler")


def program_of(call, names: tuple[str, ...], results: int) -> Program:
    parameters = tuple(Parameter(each, (-1.0, 1.0)) for each in names)
    return trace(Function("value", "", parameters, results, "results", call))


GEOMETRY = program_of(ps_error._geometry, ps_error._GEOMETRY, 6)
SIZES = program_of(ps_error.sizes, ps_error.SIZES, 2)
FACTORS = program_of(ps_error.factors, (*ps_error.SIZES, "sigma2", "q"), 3)


def cut(jet: Jet, low, high) -> Jet:
    value = IV.mpf([max(jet.value.a, low), min(jet.value.b, high)])
    return Jet(value, jet.centre, jet.gradient, jet.radii)


def root_of(p, r, m):
    """Return the root of λ (λ − p)(λ + r) = m (1 − λ²) by bisection, to 40 digits."""
    low, high = mpmath.mpf(0), mpmath.mpf(1)
    p, r, m = (mpmath.mpf(x) for x in (p, r, m))
    for _ in range(140):
        x = (low + high) / 2
        below = x < p or x * (x - p) * (x + r) < m * (1 - x * x)
        low, high = (x, high) if below else (low, x)
    return low, high


def roots(p, r, m):
    low, high = root_of(p.a, r.b, m.a)[0], root_of(p.b, r.a, m.b)[1]
    return IV.mpf([low, high])


def cubic_root(p: Jet, r: Jet, m: Jet, alpha2: Jet) -> tuple[Jet, Jet]:
    """Return λ and λ − p, with the derivatives of the implicit equation."""
    value, centre = roots(p.value, r.value, m.value), roots(p.centre, r.centre, m.centre)
    value = IV.mpf([max(value.a, alpha2.value.a), value.b])
    gap = value - p.value
    other = m.value * (1 - value**2) / (value * (value + r.value))
    gap = IV.mpf([max(gap.a, other.a, 0), min(gap.b, other.b)])
    a, b, c = gap * (value + r.value), value * (value + r.value), value * gap
    slope = a + b + c + 2 * m.value * value
    partials = b / slope, -c / slope, (1 - value**2) / slope

    def jet(value, centre, by_p):
        gradient = tuple(
            by_p * x + partials[1] * y + partials[2] * z
            for x, y, z in zip(p.gradient, r.gradient, m.gradient, strict=True)
        )
        return Jet(value, centre, gradient, p.radii).tightened()

    away = -(a + c + 2 * m.value * value) / slope
    return jet(value, centre, partials[0]), jet(gap, centre - p.centre, away)


def largest_on(error: Program, box: np.ndarray) -> float:
    """Bound |P̃_s − P_s| on a box of α, tan(θf/2), tan(θu/2) and cos φ; ∞ if there is no bound."""
    x = variables(box)
    alpha2, kappa, a, b, c, sine = evaluated(GEOMETRY, x)
    a, c = cut(a, -1, 1), cut(c, 0, 1)
    light = [alpha2, kappa, a, b, c]
    sizes = [cut(each, alpha2.value.a, 1) for each in evaluated(SIZES, light)]
    p, r, m = evaluated(FACTORS, [*light, *sizes])
    p, r, m = cut(p, -1, 1), cut(r, c.value.a, 2), cut(m, 0, 1)
    try:
        root, gap = cubic_root(p, r, m, alpha2)
        found = evaluated(error, [x[0], *light, *sizes, p, r, m, root, gap, sine])[0].value
    except (ZeroDivisionError, ValueError, mpmath.libmp.ComplexResult):
        return np.inf
    return float(max(-found.a, found.b))


@pytest.mark.slow
@pytest.mark.parametrize(("name", "count"), [("best/ps-11", 60), ("best/ps-36-wide", 60)])
def test_random_boxes_of_a_proof_are_replayed(name, count):
    fitted = resolve(name).require_fitted()
    code, shape = ps_error.error_code(fitted), fitted.form.shape
    if "steps" in shape:
        call, results = ps_error.factored_error(fitted, shape["steps"], shape["degree"]), 2
    else:
        call, results = ps_error.plain_error(fitted), 1
    error = program_of(call, ps_error._LIGHT, results)
    leaves = np.full((4_000_000, 2, 4), np.nan)
    found = bound_largest(code.kernel(), code.box, 1.05, threads=1, leaves=leaves)
    assert found.upper is not None
    kept = leaves[~np.isnan(leaves[:, 0, 0])]
    for leaf in np.random.default_rng(11).permutation(kept)[:count]:
        stack = [leaf.T]
        while stack:
            box = stack.pop()
            if largest_on(error, box) > found.upper:
                # Derivatives are less tight than the kernel's slopes: the box is divided.
                size = (box[:, 1] - box[:, 0]) / (code.box[:, 1] - code.box[:, 0])
                side = np.argmax(size)
                assert size[side] > 1e-6
                first, second = box.copy(), box.copy()
                first[side, 1] = second[side, 0] = box[side].mean()
                stack += [first, second]
