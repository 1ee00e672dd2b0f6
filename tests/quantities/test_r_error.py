"""R in interval arithmetic, its polynomials on patches, and the proofs of its tables."""

import dataclasses

import mpmath
import numpy as np
import pytest

from coefficients.catalogue import resolve
from coefficients.certify import certify
from fitting import form_values
from fitting.proofs.largest_error import certify_largest_error
from programs.bounding import compiled
from programs.bounding.compiled import compiler_missing
from quantities import problem
from quantities.fuzz import r_error, r_patches
from quantities.fuzz.r_forms import monomial_r
from quantities.fuzz.r_patches import average, patches

pytestmark = pytest.mark.skipif(compiler_missing() is not None, reason="no C compiler")

R = problem("r")


def bounds_at(alpha: float, theta_f: float, tolerance: float) -> tuple[float, float]:
    """Bound R at one point: the middle of an interval without width."""
    return average(*(np.array([x, 0, 0, 1.0]) for x in (alpha, theta_f)), tolerance)


@pytest.mark.parametrize("alpha", [0.15, 0.3, 0.55, 0.9, 1.0])
def test_the_closed_form_for_the_upright_fibre_is_inside(alpha):
    with mpmath.workdps(40):
        a = mpmath.mpf(alpha)
        s = 2 * a * mpmath.sqrt(1 - a**2)
        exact = mpmath.atan2(s * (1 + a**2), 1 + a**2 + 2 * a**4) / s if s else mpmath.mpf(0.5)
    for tolerance in (1e-4, 1e-7, 1e-10):
        low, high = bounds_at(alpha, 0.0, tolerance)
        assert low <= exact <= high
        # The tolerance is for what the rule leaves out. Rounding comes on top.
        assert high - low <= 3 * tolerance


def test_the_quadrature_of_the_reference_is_inside():
    points = np.random.default_rng(1).uniform([0.2, 0.0], [1.0, np.pi / 2], (6, 2))
    points = np.concatenate([points, [[0.2, np.pi / 2], [1.0, 1.0]]])
    for point, exact in zip(points, R.reference.values(points), strict=True):
        low, high = bounds_at(*point, 1e-8)
        assert low - 2e-9 <= exact <= high + 2e-9


def test_a_coarse_rule_contains_a_fine_one():
    """A rule that leaves out more than it states would be found."""
    rng = np.random.default_rng(2)
    for alpha, theta_f in rng.uniform([0.15, 0.0], [0.8, np.pi / 2], (8, 2)):
        fine = bounds_at(alpha, theta_f, 1e-9)
        for tolerance in (0.2, 1e-2, 1e-4, 1e-6):
            low, high = bounds_at(alpha, theta_f, tolerance)
            assert low <= fine[0] <= fine[1] <= high


def test_a_processor_that_does_not_round_upward_gives_no_bounds(monkeypatch):
    right = bounds_at(0.5, 1.0, 1e-3)
    original = compiled.compile_kernel

    def to_nearest(parts, sides, **_):
        code = "#include <fenv.h>\n#undef FE_UPWARD\n#define FE_UPWARD FE_TONEAREST\n"
        return original([code, *parts], sides)

    monkeypatch.setattr(r_patches, "compile_kernel", to_nearest)
    monkeypatch.setattr(r_patches, "_averages", r_patches._averages.__wrapped__)
    assert np.isfinite(right).all()
    assert not np.isfinite(bounds_at(0.5, 1.0, 1e-3)).any()


def test_polynomials_on_patches_are_near_r():
    small = patches(0.6, 1.0, 1e-6)
    assert 1e-8 < small.error <= 2e-6
    rng = np.random.default_rng(3)
    for slab, upper in enumerate(small.slab_ends):
        lower = 0.6 if slab == 0 else small.slab_ends[slab - 1]
        first, last = small.slab_first[slab : slab + 2]
        points = rng.uniform([lower, 0.0], [upper, np.pi / 2], (40, 2))
        points = np.concatenate([points, [[lower, 0.0], [upper, np.pi / 2]]])
        count = np.clip(
            (points[:, 1] / (np.pi / 2) * (last - first)).astype(int), 0, last - first - 1
        )
        for (alpha, theta_f), exact, at in zip(
            points, R.reference.values(points), first + count, strict=True
        ):
            middle, half, theta, half_theta = small.places[at]
            x, y = (alpha - middle) / half, (theta_f - theta) / half_theta
            assert max(abs(x), abs(y)) <= 1
            found = np.polynomial.polynomial.polyval2d(x, y, small.powers[at])
            assert abs(found - exact) <= small.error + 2e-8


def small_code(scale: float = 1.0):
    """Return a form of few coefficients in a small domain, and the code of its error."""
    shape = {
        "variable": "1-alpha",
        "numerator": ((0, 0), (0, 1), (1, 0), (1, 1)),
        "denominator": ((1, 0),),
    }
    form = monomial_r(**shape, least_alpha=0.6)
    # A fit to R in this domain
    fitted = form.fitted(scale * np.array([-0.192, 0.575, -0.092, 0.306, -0.35]))
    code = r_error.error_code(fitted)
    return fitted, code


@pytest.fixture
def coarse(monkeypatch):
    monkeypatch.setattr(r_error, "TOLERANCE", 1e-6)


def test_the_error_of_a_form_is_enclosed(coarse):
    fitted, code = small_code()
    kernel, rng = code.kernel(), np.random.default_rng(4)
    refused = 0
    for point in rng.uniform(*code.box.T, (40, 2)):
        box = np.clip(np.stack([point - 4e-3, point + 4e-3], axis=1), *code.box.T[:, :, None])
        low, high, *_ = kernel.enclose(box)
        refused += not np.isfinite(low)
        inside = np.concatenate([rng.uniform(*box.T, (6, 2)), box.T])
        errors = form_values(fitted, inside) - R.reference.values(inside)
        slack = code.inexact + 2e-8
        assert low - slack <= errors.min() <= errors.max() <= high + slack
        assert high - low <= 0.05 or not np.isfinite(low)
    assert refused < 10

    # A box that is on no patch
    assert not np.isfinite(kernel.enclose(code.box)[:2]).any()
    assert np.isfinite(kernel.enclose(np.array([[0.7, 0.7001], [0.3, 0.3001]]))).all()


def test_the_largest_error_of_a_form_is_proven(coarse):
    fitted, code = small_code()
    found = certify_largest_error(fitted, code, 1.01, np.array([[0.8, 0.5]]))
    lines = [np.linspace(axis.lower, axis.upper, 25) for axis in fitted.axes]
    points = np.stack([each.ravel() for each in np.meshgrid(*lines)], axis=1)
    sampled = np.abs(form_values(fitted, points) - R.reference.values(points)).max()
    assert found.lower <= found.upper <= 1.01 * found.lower
    assert sampled - 2e-8 <= found.upper and 0.9 * found.lower <= sampled


def test_a_form_for_a_smaller_roughness_is_not_proven():
    table = resolve("best/r-25").require_fitted()
    axes = (dataclasses.replace(table.axes[0], lower=0.01), *table.axes[1:])
    form = dataclasses.replace(table.form, axes=axes)
    assert r_error.error_code(form.fitted(table.coefficients)) is None


def test_no_proof_begins_without_a_compiler(monkeypatch):
    monkeypatch.setattr(r_error, "compiler_missing", lambda: "gcc is not on PATH")
    with pytest.raises(ValueError, match="needs a C compiler: gcc is not on PATH"):
        certify(resolve("r"))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["r", "published/r", "best/r-25", "best/r-36", "best/r-45"])
def test_the_largest_errors_of_tables_are_proven(name):
    done = certify(resolve(name))
    assert done.state == "proven"
    found, fitted = done.found, resolve(name).require_fitted()
    assert found.lower <= found.upper <= 1.01 * found.lower
    points = np.random.default_rng(5).uniform(
        *np.array([[x.lower, x.upper] for x in fitted.axes]).T, (400, 2)
    )
    points = np.concatenate([points, [list(found.at.values())]])
    errors = np.abs(form_values(fitted, points) - R.reference.values(points))
    # The reference states an error of 2e-8.
    assert errors.max() <= found.upper + 2e-8
    assert errors[-1] >= found.lower - 2e-8
