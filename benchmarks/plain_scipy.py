"""The refit of all four tables, as it would be written in plain NumPy and SciPy.

There are no closed forms, so all exact values are numeric integrals of the definitions: P_s by a
product rule of 64×128 views, G and Q by `quad`. Each fit is made by `curve_fit`. The integrals of
P_s and R would take too long. They are timed for a few cells, that is, materials of the grid, and
the time for all cells is extrapolated. The data that the fits need come from a file. The joint fit
of P_s, the errors off the grid and the proofs are left out, which makes this script faster than the
real task. It prints one JSON object.
"""

import argparse
import json
import time

import numpy as np
from scipy.integrate import quad
from scipy.optimize import curve_fit

NODES = 65
LIGHTS_PER_ANGLE = 48  # 2,304 lights a cell, as the refit has
LIGHTS_PER_ANGLE_R = 32
VIEW_NODES = 64  # Gauss–Legendre in θv; twice as many midpoints in φv
DENSITY = (0.001, 0.5)
COS_V = (0.001, 1.0)
# `curve_fit` gives up after this many evaluations.
EVALUATIONS = 20_000


def directions(theta, phi):
    sin = np.sin(theta)
    return np.stack([sin * np.cos(phi), sin * np.sin(phi), np.cos(theta) + 0 * phi], axis=-1)


def views():
    """Return the nodes (n, 3) and weights (n,) of a product rule over the hemisphere of views."""
    x, w = np.polynomial.legendre.leggauss(VIEW_NODES)
    theta = np.pi / 4 * (x + 1)
    phi = (np.arange(2 * VIEW_NODES) + 0.5) * np.pi / VIEW_NODES
    weights = np.outer(np.pi / 4 * w * np.sin(theta), np.full(len(phi), np.pi / VIEW_NODES))
    return directions(*np.meshgrid(theta, phi, indexing="ij")).reshape(-1, 3), weights.ravel()


def scattered_fraction(alpha, theta_f, lights, view, weights):
    """Return P_s of one material for lights (n, 3), by integration over the views."""
    fibre = np.array([np.sin(theta_f), 0.0, np.cos(theta_f)])
    kappa = 1 - alpha**2
    along_u, along_v = lights @ fibre, view @ fibre
    values = np.empty(len(lights))
    for first in range(0, len(lights), 256):
        part = slice(first, first + 256)
        # (h·t)² with h = (u + v)/|u + v| and |u + v|² = 2 (1 + u·v)
        cosine = (along_u[part, None] + along_v) ** 2 / (2 * (1 + lights[part] @ view.T))
        distribution = alpha**3 / (np.pi * (cosine * kappa + alpha**2) ** 2)
        sigma = np.sqrt(1 - along_u[part] ** 2 * kappa)
        values[part] = 1 - (distribution @ weights) / (4 * sigma)
    return values


def lights_of(count):
    """Return θu and φ (count²,) in [0, π/2] × [0, π], and weights that are uniform in both."""
    x, w = np.polynomial.legendre.leggauss(count)
    theta = np.repeat(np.pi / 4 * (x + 1), count)
    phi = np.tile((np.arange(count) + 0.5) * np.pi / count, count)
    return theta, phi, np.repeat(w / 2, count) / count


def fit_cell(alpha, theta_f, view, weights):
    """Return the best c₀ … c₅ of one material (6,), and the exact P_s for the lights."""
    theta, phi, light_weights = lights_of(LIGHTS_PER_ANGLE)
    lights = directions(theta, phi)
    exact = scattered_fraction(alpha, theta_f, lights, view, weights)
    n = lights[:, 2]
    t = lights @ [np.sin(theta_f), 0.0, np.cos(theta_f)]
    matrix = np.stack([np.ones_like(n), n, t, n * n, n * t, t * t], axis=1)
    root = np.sqrt(light_weights)
    return np.linalg.lstsq(matrix * root[:, None], exact * root, rcond=None)[0], exact


def average_fraction(alpha, theta_f, view, weights):
    theta, phi, light_weights = lights_of(LIGHTS_PER_ANGLE_R)
    exact = scattered_fraction(alpha, theta_f, directions(theta, phi), view, weights)
    # The integral of P_s (u·n)/π over all φ is twice that over [0, π], by symmetry.
    return float(np.pi * light_weights @ (exact * np.sin(theta) * np.cos(theta)))


def terms(points):
    alpha, theta_f = points
    b, g, d = 1 - alpha, np.cos(theta_f), np.sin(theta_f)
    x = [b, g, d, b * b, g * g, b * g, b * d, b**3, g**3, d**3, b * b * g, b * b * d, b * g * g]
    return b, np.stack(x)


def surface(points, *c):
    beta, x = terms(points)
    c = np.array(c)
    return beta * (c[0] + c[1:14] @ x) / (1 + c[14:] @ x[: len(c) - 14])


def fit_surface(points, target, denominator_terms):
    """Fit Eq. (2) or (5), starting from the best polynomial. Returns coefficients and rms error."""
    beta, x = terms(points)
    start = np.linalg.lstsq((beta * np.vstack([np.ones_like(beta), x])).T, target, rcond=None)[0]
    start = np.concatenate([start, np.zeros(denominator_terms)])
    try:
        found, _ = curve_fit(surface, points, target, start, maxfev=EVALUATIONS)
    except RuntimeError:  # It did not converge; a user is left with the polynomial.
        found = start
    return found, float(np.sqrt(np.mean((surface(points, *found) - target) ** 2)))


def exact_g(density, nu):
    def kernel(mu):
        return mu * -np.expm1(-density * (mu + nu) / (mu * nu)) / (mu + nu)

    return quad(kernel, 0, 1, epsabs=1e-10, limit=200)[0]


def exact_q(density):
    return 2 * quad(lambda mu: mu * np.exp(-density / mu), 0, 1, epsabs=1e-10, limit=200)[0]


def rational_g(points, a, b, c, e):
    d, nu = points
    return d * (1 + nu * (a + nu * b)) / (d + nu * (c + nu * nu * e))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("surfaces", help=".npz of c (6, 65²), r (65²) and P_s of the sampled cells")
    parser.add_argument("--cells", type=int, default=5)
    options = parser.parse_args()
    data = np.load(options.surfaces)
    seconds, notes, start = {}, {}, time.process_time()

    view, weights = views()
    chosen = np.random.default_rng(2).choice(NODES**2, options.cells, replace=False)
    largest = 0.0
    clock = time.process_time()
    for cell, known in zip(chosen, data["ps_exact"], strict=True):
        _, exact = fit_cell(*data["ps_points"][cell], view, weights)
        largest = max(largest, float(np.abs(exact - known).max()))
    sampled = time.process_time() - clock
    seconds["reference and cells of P_s (extrapolated)"] = sampled * NODES**2 / options.cells
    notes["largest error of P_s by this rule"] = largest

    clock = time.process_time()
    points = data["ps_points"].T
    rms = [fit_surface(points, target, 13)[1] for target in data["cells"]]
    seconds["six fits of 27 coefficients"] = time.process_time() - clock
    notes["rms error of c0 to c5"] = rms

    clock = time.process_time()
    apart = [
        abs(average_fraction(*data["r_points"][cell], view, weights) - data["r"][cell])
        for cell in chosen
    ]
    sampled = time.process_time() - clock
    seconds["reference of R (extrapolated)"] = sampled * NODES**2 / options.cells
    notes["largest error of R by this rule"] = float(max(apart))
    clock = time.process_time()
    notes["rms error of R"] = fit_surface(data["r_points"].T, data["r"] - 0.5, 3)[1]
    seconds["fit of R"] = time.process_time() - clock

    clock = time.process_time()
    grid = np.meshgrid(np.linspace(*DENSITY, NODES), np.linspace(*COS_V, NODES), indexing="ij")
    d, nu = (each.ravel() for each in grid)
    exact = np.array([exact_g(*pair) for pair in zip(d, nu, strict=True)])
    found, _ = curve_fit(rational_g, (d, nu), exact, [-0.5, 0.1, 0.5, -0.1], maxfev=EVALUATIONS)
    notes["rms error of G"] = float(np.sqrt(np.mean((rational_g((d, nu), *found) - exact) ** 2)))
    seconds["G, reference and fit"] = time.process_time() - clock

    clock = time.process_time()
    d = np.linspace(0, 0.5, NODES)
    exact = np.array([exact_q(each) for each in d])
    matrix = np.stack([d, d * d], axis=1)
    found = np.linalg.lstsq(matrix, exact - 1, rcond=None)[0]
    notes["rms error of Q"] = float(np.sqrt(np.mean((1 + matrix @ found - exact) ** 2)))
    seconds["Q, reference and fit"] = time.process_time() - clock

    measured = time.process_time() - start
    print(json.dumps({"seconds": seconds, "measured": measured, "notes": notes}))


if __name__ == "__main__":
    main()
