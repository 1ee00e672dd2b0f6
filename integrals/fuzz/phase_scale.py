"""s(a; α), the scale of the phase function of a fibre that is reciprocal and conserves energy.

p(u, v) = D_F(h) / (4 s(u·t) s(v·t)) is symmetric. Its integral over v is one for all u if

    s(u·t) = ∫ D_F(h) / (4 s(v·t)) dω_v   over the whole sphere.

Each of two methods here discretises this equation and solves it, without the other: a rule over v·t
with Newton's method, and a rule over the visible normals with Sinkhorn's iteration. They have in
common only that ln(s/√σ_F) is a polynomial. docs/ambient-light.md derives the first rule.
`shading.reciprocal_scale` approximates s. All functions here are NumPy in float64.
"""

from collections.abc import Callable

import numpy as np
from numpy.polynomial import chebyshev, legendre

# The rules of both methods have this many nodes a panel and an axis.
_PANEL = 40
# Sinkhorn's iteration halves the error or better; Newton's method squares it.
_ITERATIONS = 60
_CONVERGED = 1e-14

Values = np.ndarray


class _Basis:
    """Polynomials in η², with √κ a = sin η: smooth at a = ±1, and even, as s is.

    `angles` are the collocation points η in (0, η₁), and `cosines` their a.
    """

    def __init__(self, alpha: float, count: int):
        self.kappa = (1 - alpha) * (1 + alpha)
        self.largest = np.arcsin(np.sqrt(self.kappa))
        nodes = np.cos((np.arange(count) + 0.5) * np.pi / count)
        self.angles = self.largest * np.sqrt((nodes + 1) / 2)
        self.cosines = np.sin(self.angles) / np.sqrt(self.kappa)
        self.inverse = np.linalg.inv(chebyshev.chebvander(nodes, count - 1))

    def rows(self, angles: Values) -> Values:
        """Return the matrix (n, count) that takes values at the collocation points to `angles`."""
        place = 2 * (angles / self.largest) ** 2 - 1
        return chebyshev.chebvander(place, len(self.angles) - 1) @ self.inverse

    def scale(self, logarithms: Values) -> Callable[[Values], Values]:
        """Return s as a function of a, from ln(s/√σ_F) at the collocation points."""

        def value(cos_t):
            inside = np.sqrt(self.kappa) * np.clip(np.abs(cos_t), 0, 1)
            area = np.sqrt(1 - inside**2)
            return np.sqrt(area) * np.exp(self.rows(np.arcsin(inside)) @ logarithms)

        return value


def scale_by_cosines(alpha: float, count: int = 48) -> Callable[[Values], Values]:
    """Return s(a; α) as a function of arrays of a = ω·t in [−1, 1], for `alpha` in (0, 1).

    The azimuth about t is integrated in closed form. The equation holds at `count` values of a.
    Raises ValueError for another α.
    """
    _require_roughness(alpha)
    basis = _Basis(alpha, count)
    rules = [_rule_of_cosines(alpha, angle) for angle in basis.angles]
    areas = np.sqrt(1 - basis.kappa * basis.cosines**2)
    weights = np.stack([weight for _, weight in rules])
    rows = np.stack([basis.rows(angles) for angles, _ in rules])
    weights /= np.sqrt(np.cos(np.stack([angles for angles, _ in rules])))
    found = np.zeros(count)
    for _ in range(_ITERATIONS):
        terms = weights * np.exp(-(rows @ found))
        total = terms.sum(axis=1)
        residual = np.log(total) - np.log(areas) / 2 - found
        slopes = -np.einsum("nq,nqk->nk", terms, rows) / total[:, None] - np.eye(count)
        step = np.linalg.solve(slopes, -residual)
        found += step
        if np.abs(step).max() < _CONVERGED:
            break
    return basis.scale(found)


def scale_by_normals(alpha: float, count: int = 24, nodes: int = 48) -> Callable[[Values], Values]:
    """Return the same as `scale_by_cosines` by a rule with `nodes`² visible normals."""
    _require_roughness(alpha)
    basis = _Basis(alpha, count)
    seen = np.stack([_scattered_cosines(alpha, a, nodes) for a in basis.cosines])
    inside = np.sqrt(basis.kappa) * np.clip(np.abs(seen), 0, 1)
    rows = basis.rows(np.arcsin(inside).ravel()).reshape(*seen.shape, count)
    weights = np.repeat(_disk_rule(nodes)[2], 2 * nodes) / (2 * nodes)
    halves = np.sqrt(np.sqrt(1 - inside**2))
    areas = np.sqrt(1 - basis.kappa * basis.cosines**2)
    found = np.zeros(count)
    for _ in range(_ITERATIONS):
        averages = areas * ((np.exp(-(rows @ found)) / halves) @ weights)
        # The geometric mean of s and of its image is Sinkhorn's iteration for a symmetric kernel.
        new = (found + np.log(averages) - np.log(areas) / 2) / 2
        change, found = np.abs(new - found).max(), new
        if change < _CONVERGED:
            break
    return basis.scale(found)


def reciprocal_energy(
    alpha: float, cos_t: float, scale: Callable[[Values], Values], panels: int = 8
) -> float:
    """Return ∫ D_F(h) / (4 s(u·t) s(v·t)) dω_v for any function s of v·t; `cos_t` is u·t."""
    _require_roughness(alpha)
    root = np.sqrt((1 - alpha) * (1 + alpha))
    angles, weights = _rule_of_cosines(alpha, np.arcsin(root * cos_t), panels)
    total = np.sum(weights / scale(np.sin(angles) / root))
    return float(total / scale(np.array([cos_t]))[0])


def _rule_of_cosines(alpha: float, angle: float, panels: int = 6) -> tuple[Values, Values]:
    """Return angles η of v, and weights with which a function of v·t is integrated over D_F/4.

    The weight of the azimuth has a kink at v·t = −u·t. By symmetry it is moved to +u·t, at η =
    `angle`, where the range is split.
    """
    kappa = (1 - alpha) * (1 + alpha)
    largest = np.arcsin(np.sqrt(kappa))
    ends = [
        np.linspace(low, high, panels + 1) for low, high in ((-largest, angle), (angle, largest))
    ]
    x, w = legendre.leggauss(_PANEL)
    middle = np.concatenate([(each[1:] + each[:-1]) / 2 for each in ends])
    half = np.concatenate([np.diff(each) / 2 for each in ends])
    nodes = (middle[:, None] + half[:, None] * x).ravel()
    weights = (half[:, None] * w).ravel() * np.cos(nodes) / np.sqrt(kappa)
    a, cosines = np.sin(angle) / np.sqrt(kappa), np.sin(nodes) / np.sqrt(kappa)
    return nodes, weights * _over_azimuth(alpha, a, cosines) / (2 * alpha)


def _over_azimuth(alpha: float, a: float, cosines: Values) -> Values:
    """Return the mean of (1 − K/Y)² over the azimuth, 1 − 2K/r + K²P/r³."""
    # notation: as in docs/ambient-light.md for whole circles, with −s in the place of s.
    kappa, gap = (1 - alpha) * (1 + alpha), np.maximum(np.abs(a - cosines), 1e-150)
    big_k, turn = kappa * gap**2, 1 - a * cosines
    slope = np.sqrt(kappa * big_k + 4 * alpha**2 * (alpha**2 + kappa * turn))
    k = kappa * gap / slope
    return 1 - 2 * k + k * k * (2 * alpha**2 * turn + big_k) / (gap * slope)


def _disk_rule(nodes: int) -> tuple[Values, Values, Values]:
    """Return radii of the unit disk, heights √(1 − r²), and weights with sum one."""
    x, w = legendre.leggauss(nodes)
    height = (1 + x) / 2
    return np.sqrt(1 - height**2), height, w * height


def _scattered_cosines(alpha: float, a: float, nodes: int) -> Values:
    """Return v·t of the light from u, with u·t = a, that is reflected at each visible normal."""
    radius, height, _ = _disk_rule(nodes)
    azimuth = (np.arange(2 * nodes) + 0.5) * np.pi / nodes
    # t is the z axis. The normals are w = Mp, with p on the half sphere about Mu/σ.
    u = np.array([np.sqrt(1 - a * a), 0.0, a])
    axis = u * [1, 1, alpha]
    axis /= np.linalg.norm(axis)
    side = np.array([axis[2], 0.0, -axis[0]])
    across = radius[:, None] * np.cos(azimuth), radius[:, None] * np.sin(azimuth)
    p = np.stack(
        [
            across[0] * side[0] + height[:, None] * axis[0],
            across[1],
            across[0] * side[2] + height[:, None] * axis[2],
        ]
    ).reshape(3, -1)
    w = p * np.array([1, 1, alpha])[:, None]
    return 2 * (u @ w) * w[2] / np.sum(w * w, axis=0) - a


def _require_roughness(alpha: float) -> None:
    if not 0 < alpha < 1:
        raise ValueError(f"alpha is {alpha!r}; allowed: above 0 and below 1")
