"""The refit of the four tables in plain NumPy and SciPy, by someone who knows all closed forms.

The grids are those of `shadefit refit`, P_s and R have as many lights, and all fits have analytic
derivatives. Left out are: the joint fit of the 162 coefficients of P_s (its six surfaces are fitted
one by one, which has a larger error), errors off the grid and the search for the largest, error
bounds of the exact values, proofs that there is no pole, the bounds of the values, and the files of
the tables. It prints one JSON object.
"""

import json
import time

import numpy as np
from scipy.linalg import solve_triangular
from scipy.optimize import least_squares
from scipy.special import exp1, expn

NODES = 65
LIGHTS_PER_ANGLE = 48
LIGHTS_PER_ANGLE_R = 32
DENSITY = (0.001, 0.5)
COS_V = (0.001, 1.0)
# Newton's steps from the start below reach the precision of float64.
STEPS = 4
# A start of Newton's method that is near the root for all arguments
WIDTH = 0.42
# One of the surfaces of P_s gains only 0.6 % by 2,000 steps.
MOST = 50


def scattered_fraction(c, a, b, alpha):
    """Return P_s in closed form; see docs/closed-form.md for the names."""
    alpha2 = alpha * alpha
    kappa = 1 - alpha2
    sigma2 = 1 - kappa * a * a
    t = kappa * a * b
    s = np.sqrt(sigma2 * (1 - kappa * b * b))
    p, r, m = s - t, s + t, alpha2 * c
    half = p / 2
    frozen = r + half + np.sqrt(half * half + WIDTH * alpha2)
    h = half * frozen
    root = (h + np.sqrt(h * h + m * (frozen + m))) / (frozen + m)
    linear, constant = m + 2 * t, p * r
    for _ in range(STEPS):
        value = ((root + linear) * root - constant) * root - m
        root = root - value / ((3 * root + 2 * linear) * root - constant)
    square = root * root
    ellipse = square * np.sqrt((root + c) * (root + m / sigma2))
    return 1 - ellipse / ((2 * root + linear) * square + m)


def materials():
    return np.linspace(0.15, 1, NODES), np.linspace(0, np.pi / 2, NODES)


def lights(count):
    """Return n·u, the horizontal part of u, θu and weights in both angles, of `count`² lights."""
    x, w = np.polynomial.legendre.leggauss(count)
    theta = np.repeat(np.pi / 4 * (x + 1), count)
    phi = np.tile((np.arange(count) + 0.5) * np.pi / count, count)
    return np.cos(theta), np.sin(theta) * np.cos(phi), theta, np.repeat(w / 2, count) / count


def terms(alpha, theta_f):
    """Return β and the features x (13, n) of Eq. (2) and (5)."""
    b, g, d = 1 - alpha, np.cos(theta_f), np.sin(theta_f)
    x = [b, g, d, b * b, g * g, b * g, b * d, b**3, g**3, d**3, b * b * g, b * b * d, b * g * g]
    return b, np.stack(x)


def fit_surface(alpha, theta_f, target, below, root):
    """Fit β (t + pᵀx)/(1 + qᵀy), from the best polynomial. Returns coefficients and rms error."""
    beta, x = terms(alpha, theta_f)
    above = np.vstack([np.ones_like(beta), x]).T
    y, split = x[:below].T, 14
    start = np.linalg.lstsq((root * beta)[:, None] * above, root * target, rcond=None)[0]

    def residual(c):
        return root * (beta * (above @ c[:split]) / (1 + y @ c[split:]) - target)

    def slopes(c):
        denominator = 1 + y @ c[split:]
        factor = root * beta / denominator
        quotient = -factor * (above @ c[:split]) / denominator
        return np.hstack([factor[:, None] * above, quotient[:, None] * y])

    found = least_squares(
        residual, np.r_[start, np.zeros(below)], slopes, method="lm", max_nfev=MOST
    )
    return found.x, np.sqrt(np.sum(found.fun**2))


def trapezoid():
    line = np.full(NODES, 1 / (NODES - 1))
    line[[0, -1]] /= 2
    return np.outer(line, line).ravel()


def fit_ps():
    """Fit every cell by QR, then each of the six surfaces of their coefficients."""
    alphas, angles = np.linspace(0.15, 1, NODES), np.linspace(0.1, np.pi / 2, NODES)
    n, along, _, weights = lights(LIGHTS_PER_ANGLE)
    root = np.sqrt(weights)
    cells, cell_rms = np.empty((NODES, NODES, 6)), np.empty((NODES, NODES))
    for k, angle in enumerate(angles):
        t = along * np.sin(angle) + n * np.cos(angle)
        matrix = np.stack([np.ones_like(n), n, t, n * n, n * t, t * t], axis=1)
        q, r = np.linalg.qr(matrix * root[:, None])
        exact = scattered_fraction(n, t, np.cos(angle), alphas[:, None]) * root
        projection = exact @ q
        cells[:, k] = solve_triangular(r, projection.T).T
        cell_rms[:, k] = np.sum((exact - projection @ q.T) ** 2, axis=1)
    alpha, theta_f = (each.ravel() for each in np.meshgrid(alphas, angles, indexing="ij"))
    targets = cells.reshape(-1, 6).T.copy()
    targets[0] -= 0.5
    rms = [fit_surface(alpha, theta_f, each, 13, np.sqrt(trapezoid()))[1] for each in targets]
    return [float(each) for each in rms]


def fit_r():
    alphas, angles = materials()
    n, along, theta, weights = lights(LIGHTS_PER_ANGLE_R)
    # The mean over φ, and the integral of P_s (u·n) sin θu over θu, doubled so that R(1) = 1/2
    weights = np.pi * weights * np.sin(theta) * np.cos(theta)
    r = np.empty((NODES, NODES))
    for k, angle in enumerate(angles):
        t = along * np.sin(angle) + n * np.cos(angle)
        r[:, k] = scattered_fraction(n, t, np.cos(angle), alphas[:, None]) @ weights
    alpha, theta_f = (each.ravel() for each in np.meshgrid(alphas, angles, indexing="ij"))
    return float(fit_surface(alpha, theta_f, r.ravel() - 0.5, 3, np.sqrt(trapezoid()))[1])


def ends(lower, upper):
    """Return Gauss–Legendre nodes and weights, whose sum is one."""
    x, w = np.polynomial.legendre.leggauss(NODES)
    return lower + (upper - lower) * (x + 1) / 2, w / 2


def fit_g():
    (densities, one), (cosines, other) = ends(*DENSITY), ends(*COS_V)
    d, nu = (each.ravel() for each in np.meshgrid(densities, cosines, indexing="ij"))
    root = np.sqrt(np.outer(one, other).ravel())
    escape = np.exp(-d / nu)
    logarithms = np.log1p(1 / nu) + exp1(d + d / nu) - escape * exp1(d)
    exact = 1 - escape * expn(2, d) - nu * logarithms

    def parts(c):
        above, below = 1 + nu * (c[0] + nu * c[1]), d + nu * (c[2] + nu**2 * c[3])
        return d * above / below, below

    def residual(c):
        return root * (parts(c)[0] - exact)

    def slopes(c):
        value, below = parts(c)
        columns = [d * nu / below, d * nu**2 / below, -value * nu / below, -value * nu**3 / below]
        return root[:, None] * np.stack(columns, axis=1)

    # The errors times the denominator are linear in the coefficients, and give the start.
    matrix = np.stack([d * nu, d * nu**2, -exact * nu, -exact * nu**3], axis=1)
    start = np.linalg.lstsq(root[:, None] * matrix, root * d * (exact - 1), rcond=None)[0]
    found = least_squares(residual, start, slopes, method="lm", max_nfev=MOST)
    return float(np.sqrt(np.sum(found.fun**2)))


def fit_q():
    d, weights = ends(0, 0.5)
    root, exact = np.sqrt(weights), 2 * expn(3, d)
    matrix = np.stack([d, d * d], axis=1)
    found = np.linalg.lstsq(root[:, None] * matrix, root * (exact - 1), rcond=None)[0]
    return float(np.sqrt(np.sum((root * (1 + matrix @ found - exact)) ** 2)))


def main():
    seconds, notes = {}, {}
    for name, task in (("P_s", fit_ps), ("R", fit_r), ("G", fit_g), ("Q", fit_q)):
        clock = time.process_time()
        notes[name] = task()
        seconds[name] = time.process_time() - clock
    print(json.dumps({"seconds": seconds, "notes": notes}))


if __name__ == "__main__":
    main()
