"""Largest errors as theorems: replayed by other arithmetic, and refuted where they are wrong."""

import ctypes
import itertools

import jax.numpy as jnp
import mpmath
import numpy as np
import pytest

from coefficients.catalogue import resolve
from fitting import form_values
from fitting.form import traced
from fitting.proofs import largest_error
from fitting.proofs.largest_error import certify_largest_error, difference_code
from programs.bounding import compiled
from programs.bounding.compiled import Kernel, compiler_missing
from programs.bounding.denominators import DenominatorBound
from programs.bounding.largest import LargestValue, bound_largest
from programs.functions import Function, Parameter
from programs.program import interpret
from programs.tracing.tracer import trace
from quantities import problem
from quantities.fuzz import ps_error
from tests.fitting.toys import AXES, PLANE, QUOTIENT, TOY, toy_form
from tests.programs.interval_jets import bounds

needs_compiler = pytest.mark.skipif(compiler_missing() is not None, reason="no C compiler")


def exact(x, y):
    return jnp.exp(-x) * (2 + jnp.sin(y))


FITTED = QUOTIENT.fitted(np.array([2.0, -0.5, 1.1, 0.6, 0.2]))
MIDDLE = np.array([[0.5, 0.5]])


def sampled(fitted) -> float:
    lines = [np.linspace(axis.lower, axis.upper, 201) for axis in AXES]
    points = np.stack([each.ravel() for each in np.meshgrid(*lines)], axis=1)
    return float(np.abs(form_values(fitted, points) - TOY.values(points)).max())


@needs_compiler
@pytest.mark.parametrize("fitted", [FITTED, PLANE.fitted(np.array([2.0, -1.0, 0.3]))])
def test_a_form_of_a_users_closed_form_is_proven(fitted):
    found = certify_largest_error(fitted, difference_code(fitted, exact, 1e-15), 1.01, MIDDLE)
    assert found.lower <= found.upper <= 1.0101 * found.lower
    assert sampled(fitted) <= found.upper
    assert found.lower <= sampled(fitted) * 1.001
    at = np.array([list(found.at.values())])
    error = abs(form_values(fitted, at) - TOY.values(at))[0]
    assert error == pytest.approx(found.lower, rel=1e-9)


@needs_compiler
def test_a_claim_below_the_true_error_is_refuted_with_its_point():
    true = sampled(FITTED)
    code = difference_code(FITTED, exact, 1e-15)
    wrong = certify_largest_error(FITTED, code, 1.01, MIDDLE, claim=0.99 * true)
    assert wrong.refuted and wrong.upper is None
    at = np.array([list(wrong.at.values())])
    assert abs(form_values(FITTED, at) - TOY.values(at))[0] > 0.99 * true
    right = certify_largest_error(FITTED, code, 1.01, MIDDLE, claim=1.01 * true)
    assert not right.refuted and right.upper <= 1.01 * true


@needs_compiler
def test_what_the_closed_form_may_be_wrong_by_widens_both_bounds():
    sharp, wide = (
        certify_largest_error(FITTED, difference_code(FITTED, exact, inexact), 1.01, MIDDLE)
        for inexact in (0.0, 1e-3)
    )
    # Both climb to the same place. The second search leaves room for what is added.
    assert wide.lower == pytest.approx(sharp.lower - 1e-3, rel=1e-9)
    assert 1e-3 + sharp.lower <= wide.upper <= 1.01 * wide.lower


@needs_compiler
def test_a_form_with_a_pole_is_not_proven():
    fitted = QUOTIENT.fitted(np.array([2.0, -0.5, 1.1, -1.3, 0.0]))
    found = certify_largest_error(fitted, difference_code(fitted, exact, 1e-15), 1.01, MIDDLE)
    assert found.upper is None and not found.refuted


def test_without_a_compiler_a_slow_search_proves_the_same(monkeypatch):
    monkeypatch.setattr(largest_error, "compiler_missing", lambda: "gcc is not on PATH")
    code = difference_code(FITTED, exact, 1e-15)
    found = certify_largest_error(FITTED, code, 1.05, MIDDLE)
    assert sampled(FITTED) <= found.upper <= 1.06 * sampled(FITTED)
    with pytest.raises(ValueError, match="needs a C compiler: gcc is not on PATH"):
        certify_largest_error(FITTED, code, 1.05, MIDDLE, claim=1.0)


@needs_compiler
def test_a_compiler_that_fails_is_one_line(monkeypatch):
    monkeypatch.setattr(compiled, "_FLAGS", ("-no-such-option",))
    with pytest.raises(ValueError, match=r"^the search in interval arithmetic does not compile.*$"):
        certify_largest_error(FITTED, difference_code(FITTED, exact, 1e-15), 1.01, MIDDLE)


@needs_compiler
@pytest.mark.slow
def test_a_compiler_that_does_not_know_the_processor_is_enough(monkeypatch):
    monkeypatch.setattr(compiled, "_FASTER", ("-march=no-such-processor",))
    found = certify_largest_error(FITTED, difference_code(FITTED, exact, 1e-15), 1.05, MIDDLE)
    assert sampled(FITTED) <= found.upper <= 1.06 * sampled(FITTED)


@needs_compiler
def test_a_radicand_that_is_zero_on_the_boundary_is_proven_defined_first():
    form = toy_form(lambda c, x, y: jnp.sqrt(1 - x * x) + c[0] + 0 * y, ["a"])
    fitted = form.fitted(np.array([0.3]))
    found = certify_largest_error(fitted, difference_code(fitted, exact, 1e-15), 1.01, MIDDLE)
    assert sampled(fitted) <= found.upper <= 1.02 * sampled(fitted)


@pytest.mark.parametrize("proven", [True, False])
@pytest.mark.parametrize("first", [None, 0.3])
def test_the_negative_part_of_a_radicand_is_left_out_only_after_a_proof(monkeypatch, first, proven):
    """The number of sides of these kernels says whether roots are taken to be defined."""
    searched = []

    def compiled_for(parts, sides, roots_are_defined, long):
        return Kernel(ctypes.CDLL(None), int(roots_are_defined))

    def search(kernel, *_, **__):
        searched.append(kernel.sides)
        return LargestValue(0.1, (0.5, 0.5), 0.2 if kernel.sides else first, 1)

    monkeypatch.setattr(largest_error, "compiler_missing", lambda: None)
    monkeypatch.setattr(largest_error, "compile_kernel", compiled_for)
    monkeypatch.setattr(largest_error, "bound_largest", search)
    bound = DenominatorBound(1.0 if proven else -np.inf, 1)
    monkeypatch.setattr(largest_error, "prove_no_pole", lambda *_: bound)
    found = certify_largest_error(FITTED, difference_code(FITTED, exact, 0.0), 1.01, MIDDLE)
    again = first is None and proven
    assert searched == ([0, 1] if again else [0])
    assert found.upper == (np.nextafter(0.2, 1) if again else first and np.nextafter(first, 1))


# Replay


def replayed(name: str, ratio: float = 1.02) -> int:
    """Prove a table's largest error, and check each box of the proof by mpmath's intervals."""
    fitted = resolve(name).require_fitted()
    code = resolve(name).problem.code_of_error(fitted)
    leaves = np.full((200_000, 2, len(code.box)), np.nan)
    found = bound_largest(code.kernel(), code.box, ratio, threads=1, leaves=leaves)
    kept = leaves[~np.isnan(leaves[:, 0, 0])]
    volume = np.prod((kept[:, 1] - kept[:, 0]) / (code.box[:, 1] - code.box[:, 0]), axis=1)
    assert np.sum(volume) == pytest.approx(1, abs=1e-9)
    assert found.upper is not None
    for leaf in kept:
        stack = [leaf.T]
        # The slopes of the kernel are tighter than derivatives: a box may have to be divided.
        while stack:
            box = stack.pop()
            low, high = bounds(code.program, box)
            if max(-low, high) > found.upper:
                assert np.max(box[:, 1] - box[:, 0]) > 1e-9
                side = np.argmax((box[:, 1] - box[:, 0]) / (code.box[:, 1] - code.box[:, 0]))
                first, second = box.copy(), box.copy()
                first[side, 1] = second[side, 0] = box[side].mean()
                stack += [first, second]
    return len(kept)


@needs_compiler
@pytest.mark.slow
def test_a_proof_is_replayed_by_other_interval_arithmetic():
    assert replayed("best/q-4") > 50


@needs_compiler
@pytest.mark.slow
@pytest.mark.parametrize("name", ["best/q-5", "best/q-9", "best/q-12", "best/q-12-log"])
def test_longer_proofs_are_replayed(name):
    assert replayed(name) > 50


# P_s: the code of its errors is written otherwise than its forms.

MP = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "sqrt": mpmath.sqrt,
    "cos": mpmath.cos,
    "sin": mpmath.sin,
    "max": max,
    "min": min,
    "abs": abs,
    "lt": lambda a, b: a < b,
    "select": lambda which, a, b: a if which else b,
}
PS = ["best/ps-11", "best/ps-21", "best/ps-40", "best/ps-61-wide"]
SLOW_PS = ["best/ps-25", "best/ps-36-wide", "best/ps-40-wide", "best/ps-49-wide", "ps"]


def exactly(call, names: tuple[str, ...], values, results: int | None = None):
    """Evaluate a JAX function with mpmath."""
    parameters = tuple(Parameter(each, (-1.0, 1.0)) for each in names)
    program = trace(Function("value", "", parameters, results, "results", call))
    found = interpret(program, [mpmath.mpf(x) for x in values], MP, mpmath.mpf)
    return found[0] if results is None else found


def root_of(p, r, m):
    """Return the positive root of λ (λ − p)(λ + r) = m (1 − λ²) by bisection, to 45 digits."""
    low, high = mpmath.mpf(0), mpmath.mpf(1)
    for _ in range(170):
        x = (low + high) / 2
        low, high = (x, high) if x * (x - p) * (x + r) < m * (1 - x * x) else (low, x)
    return (low + high) / 2


@pytest.mark.parametrize("name", [*PS, *(pytest.param(n, marks=pytest.mark.slow) for n in SLOW_PS)])
def test_the_factored_error_of_p_s_is_the_error_of_the_form(name):
    """The form minus the closed form as it stands, to 40 digits, at random points of the domain."""
    fitted = resolve(name).require_fitted()
    shape = fitted.form.shape or {}
    if "steps" in shape:
        error, results = ps_error.factored_error(fitted, shape["steps"], shape["degree"]), 2
    else:
        error, results = ps_error.plain_error(fitted), 1
    whole = traced(fitted, fitted, fitted.axes)
    rng = np.random.default_rng(7)
    with mpmath.workdps(50):
        for _ in range(6):
            alpha, half_f, half_u, psi = (
                mpmath.mpf(float(x))
                for x in rng.uniform([fitted.axes[0].lower, 0.06, 0, -1], [1, 1, 1, 1])
            )
            g = exactly(ps_error._geometry, ps_error._GEOMETRY, (alpha, half_f, half_u, psi), 6)
            light = g[:5]
            s = exactly(ps_error.sizes, ps_error.SIZES, light, 2)
            names = (*ps_error.SIZES, "sigma2", "q")
            p, r, m = exactly(ps_error.factors, names, (*light, *s), 3)
            root = root_of(p, r, m)
            values = (alpha, *light, *s, p, r, m, root, root - p, g[5])
            found = exactly(error, ps_error._LIGHT, values, results)
            angles = alpha, 2 * mpmath.atan(half_f), 2 * mpmath.atan(half_u), mpmath.acos(psi)
            (form,) = interpret(whole, list(angles), MP, mpmath.mpf)
            a, b, c, sigma2 = g[2], g[3], g[4], s[0]
            kappa = 1 - alpha**2
            t, size = kappa * a * b, mpmath.sqrt((1 - kappa * a**2) * (1 - kappa * b**2))
            assert abs(root * (root - size + t) * (root + size + t) - m * (1 - root**2)) < 1e-40
            above = root**2 * mpmath.sqrt((root + c) * (root + m / sigma2))
            closed = 1 - above / (2 * root**3 + (m + 2 * t) * root**2 + m)
            assert abs(found[0] - (form - closed)) < mpmath.mpf(10) ** -38
            if results == 2:
                assert found[1] > ps_error.LEAST


@needs_compiler
@pytest.mark.slow
def test_the_code_of_p_s_encloses_its_error():
    """Small boxes at random, and boxes at the corners of the domain."""
    fitted = resolve("best/ps-11").require_fitted()
    code = ps_error.error_code(fitted)
    kernel, rng = code.kernel(), np.random.default_rng(8)
    low, high = code.box.T
    corners = np.array(list(itertools.product(*code.box)))
    for point in [*rng.uniform(low, high, (60, 4)), *corners]:
        box = np.stack([point - 1e-3 * (high - low), point + 1e-3 * (high - low)], axis=1)
        box = np.clip(box, low[:, None], high[:, None])
        inner = rng.uniform(*box.T, (20, 4))
        points = code.to_axes(np.concatenate([inner, box.T]))
        errors = form_values(fitted, points) - problem("ps").reference.values(points)
        lower, upper, *_ = kernel.enclose(box)
        # Rounding of the form and of the closed form, in float64
        assert lower - 1e-12 <= errors.min() <= errors.max() <= upper + 1e-12


@needs_compiler
@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "ratio"),
    [("best/ps-11", 1.02), ("best/ps-36-wide", 1.02), ("best/ps-61-wide", 1.02), ("ps", 1.02)],
)
def test_p_s_is_proven_and_no_random_point_is_above(name, ratio):
    entry = resolve(name)
    fitted = entry.require_fitted()
    where = entry.require_table().errors.off_grid.where
    seeds = np.array([[where[axis.name] for axis in fitted.axes]])
    code = entry.problem.code_of_error(fitted)
    found = certify_largest_error(fitted, code, ratio, seeds)
    assert found.upper <= (ratio + 1e-6) * found.lower
    low, high = code.box.T
    points = code.to_axes(np.random.default_rng(9).uniform(low, high, (100_000, 4)))
    errors = form_values(fitted, points) - entry.problem.reference.values(points)
    assert np.abs(errors).max() <= found.upper
