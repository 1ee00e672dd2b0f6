"""What rules and interpolants leave out of R: the bounds hold at complex arguments, and in sums."""

import itertools

import jax
import numpy as np
import pytest

from integrals.fuzz.ps import fraction_at
from quantities.fuzz import r_bounds

# A rule in the unit disk
RADII, WEIGHTS = np.polynomial.legendre.leggauss(90)
ANGLES = (np.arange(180) + 0.5) * np.pi / 90
X = ((RADII + 1) / 2)[:, None] * np.cos(ANGLES)
Y = ((RADII + 1) / 2)[:, None] * np.sin(ANGLES)
AREAS = (WEIGHTS * (RADII + 1) / 4)[:, None] * np.full(180, np.pi / 90)


def microflake(z):
    """Return h and u in the axes (e_φ, k, n), and x_e/x_m, for the points of the disk."""
    c = np.sin(z) ** 2
    cosine, sine = np.sqrt((1 + c) / 2), np.sqrt((1 + c) / 2) * np.cos(z) / np.sqrt(1 + c)
    along_e, along_k = X / 2**0.5, Y / np.sqrt(1 + c)
    along_m = np.sqrt(1 - along_e**2 - along_k**2)
    h = sine * along_m + cosine * along_e, along_k, cosine * along_m - sine * along_e
    return h, (2 * sine * cosine, 0.0, c), along_e / along_m * sine / cosine


def goes_up(alpha, theta_f, z, phi):
    """Return 1 − P_s as the integral over the disk of docs/r-theorem.md; arguments may be complex.

    cos θu = sin²z.
    """
    h, u, ratio = microflake(z)
    fibre = np.sin(theta_f) * np.cos(phi), -np.sin(theta_f) * np.sin(phi), np.cos(theta_f)
    kappa = 1 - alpha**2
    along, light = (sum(a * b for a, b in zip(each, fibre, strict=True)) for each in (h, u))
    density = alpha**3 / np.pi / (alpha**2 + kappa * along**2) ** 2
    return np.sum(AREAS * density * (1 + ratio)) / (2 * np.sqrt(1 - kappa * light**2))


def arguments(count, seed):
    low, high = (0.3, 0.0, 0.3, 0.0), (0.9, 1.55, 1.4, 3.1)
    return np.random.default_rng(seed).uniform(low, high, (count, 4))


def test_the_integral_over_the_disk_is_the_closed_form():
    closed_form = jax.jit(fraction_at)
    for alpha, theta_f, z, phi in arguments(20, 1):
        exact = 1 - float(closed_form(alpha, theta_f, np.arccos(np.sin(z) ** 2), phi))
        assert goes_up(alpha, theta_f, z, phi) == pytest.approx(exact, abs=1e-9)


def test_the_bound_for_a_complex_roughness_holds():
    for alpha, theta_f, z, phi in arguments(40, 2):
        for angle in (0.3, 0.8, 1.2):
            value = goes_up(alpha * np.exp(1j * angle), theta_f, z, phi)
            assert abs(value) <= np.cos(angle) ** -2.5 * (1 + 1e-6)


@pytest.mark.parametrize("which", ["theta_f", "phi"])
def test_the_bound_for_a_complex_fibre_holds(which):
    for alpha, theta_f, z, phi in arguments(40, 3):
        for part in (0.3, 0.7, 0.9):
            # `part` of the strip in which |1 − P_s| is bounded
            size = part * alpha / np.sqrt(1 - alpha**2)
            if which == "theta_f":
                value = goes_up(alpha, theta_f + 1j * np.arcsinh(size), z, phi)
            else:
                length = np.arcsinh(size / np.sin(theta_f))
                value = goes_up(alpha, theta_f, z, phi + 1j * length)
            bound = float(r_bounds.complex_fibre(alpha, np.array(size)))
            assert bound == pytest.approx((1 - part**2) ** -2.5)
            assert abs(value) <= bound


def test_the_bounds_for_a_complex_light_hold():
    rng, near = np.random.default_rng(4), 0.0
    for alpha, theta_f, z, phi in arguments(150, 4):
        x = rng.choice([z, 0.1 * z, 0.02 * z, np.pi / 2 - 0.1 * z])
        y = rng.uniform(0, 0.6) * min(alpha, np.sin(x))
        h, u, _ = microflake(x + 1j * y)
        of_h, of_u = r_bounds.imaginary_parts(*(np.array([v]) for v in (x, x, y)))
        found_h = np.sqrt(sum(np.imag(part) ** 2 for part in h)).max()
        found_u = np.sqrt(sum(np.imag(part) ** 2 for part in u))
        assert found_h <= of_h[0] and found_u <= of_u[0] * (1 + 1e-12)
        near = max(near, found_h / of_h[0])
        bound = r_bounds.complex_light(alpha, *(np.array([v]) for v in (x, x, y)))[0]
        assert abs(goes_up(alpha, theta_f, x + 1j * y, phi)) <= bound
    # The bound is not far too large, else the rules would have far too many nodes.
    assert near > 0.7


def test_a_rectangle_has_the_bound_of_all_its_points():
    rng = np.random.default_rng(5)
    for _ in range(300):
        first, last = np.sort(rng.uniform(0.05, 3.0, 2))
        y = rng.uniform(0, 0.5) * min(np.sin(first), np.sin(last))
        inside = rng.uniform([first, 0], [last, y], (50, 2))
        whole = r_bounds.imaginary_parts(*(np.array([v]) for v in (first, last, y)))
        points = r_bounds.imaginary_parts(inside[:, 0], inside[:, 0], inside[:, 1])
        for bound, found in zip(whole, points, strict=True):
            assert found.max() <= bound[0] * (1 + 1e-12)


def test_lights_whose_cosine_may_have_no_positive_real_part_have_no_bound():
    found = r_bounds.imaginary_parts(
        np.array([0.1, 0.1]), np.array([0.2, 0.2]), np.array([0.09, 0.11])
    )
    assert np.isfinite(found[0]).tolist() == [True, False]


def test_the_rule_errs_by_its_defects():
    (nodes, weights), defects = r_bounds.rule()
    count = 2 * r_bounds.NODES
    values = np.polynomial.chebyshev.chebvander(nodes, count) * weights[:, None]
    exact = [0 if k % 2 else 2 / (1 - k * k) for k in range(count + 1)]
    found = np.abs(values.sum(axis=0) - exact)
    assert defects.max() < 1e-14
    np.testing.assert_allclose(found[:count], defects, atol=1e-14)
    # The rule is exact for polynomials below this degree only.
    assert found[count] > 0.1


def test_the_error_of_a_panel_is_bounded():
    """Compared with three panels. The average over φ is a sum over the same lights in both."""
    (nodes, weights), _ = r_bounds.rule()
    alpha, theta_f = 0.35, 0.8
    azimuths = (np.arange(20) + 0.5) * np.pi / 20

    def integrand(z):
        return (
            4
            * np.sin(z) ** 3
            * np.cos(z)
            * np.mean([goes_up(alpha, theta_f, z, p) for p in azimuths])
        )

    def integral(lower, upper):
        middle, half = (lower + upper) / 2, (upper - lower) / 2
        return half * sum(
            w * integrand(middle + half * x) for x, w in zip(nodes, weights, strict=True)
        )

    for lower, upper in ((0.3, 1.3), (0.15, 0.6)):
        steps = np.linspace(lower, upper, 4)
        fine = sum(integral(*ends) for ends in itertools.pairwise(steps))
        assert (
            abs(integral(lower, upper) - fine) <= r_bounds.panel_error(alpha, lower, upper) + 1e-10
        )


def test_the_panels_reach_the_tolerance_and_overlap_nowhere():
    for alpha, tolerance in ((0.15, 1e-9), (0.6, 1e-6), (1.0, 1e-9)):
        found = r_bounds.panels(alpha, tolerance)
        assert found.error <= tolerance
        assert np.all(np.diff(found.ends) > 0) and found.ends[0] > 0 and found.ends[-1] < np.pi / 2
        total = sum(
            r_bounds.panel_error(alpha, *ends)
            for ends in zip(found.ends, [*found.ends[1:], np.pi / 2], strict=True)
        )
        assert total + found.ends[0] ** 4 == pytest.approx(found.error, rel=1e-6)


def test_the_number_of_azimuths_is_enough():
    alpha, theta_f, z = 0.3, 1.2, 0.9

    def average(count):
        azimuths = (np.arange(count) + 0.5) * np.pi / count
        return np.mean([goes_up(alpha, theta_f, z, phi) for phi in azimuths])

    exact = average(64)
    for tolerance in (0.1, 1e-3, 1e-6):
        count, left = r_bounds.azimuths(alpha, np.sin(theta_f), tolerance)
        assert count % 8 == 0 and left <= tolerance
        assert abs(average(count) - exact) <= left + 1e-12


def test_interpolation_errs_by_no_more_than_its_bound():
    """1/(α + 0.001) is below 1/|α|, and so is not bounded; √α is bounded on each ellipse."""
    nodes = np.cos((np.arange(10) + 0.5) * np.pi / 10)
    for lower, upper in ((0.2, 0.4), (0.5, 1.0)):
        middle, half = (lower + upper) / 2, (upper - lower) / 2
        fitted = np.polynomial.chebyshev.chebfit(nodes, np.cos(middle + half * nodes), 9)
        x = np.linspace(-1, 1, 501)
        found = np.abs(np.polynomial.chebyshev.chebval(x, fitted) - np.cos(middle + half * x)).max()
        assert found <= r_bounds.over_alpha(lower, upper, 10)
    assert r_bounds.over_alpha(0.2, 0.4, 10) < r_bounds.over_alpha(0.2, 0.6, 10)
    assert r_bounds.over_theta(0.2, 0.1, 14) < r_bounds.over_theta(0.1, 0.1, 14)
