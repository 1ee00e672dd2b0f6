"""Known values that every leg must give, exact values with 50 digits, and difficult points.

The exact values come from other formulas than those of the package: P_s from the eigenvectors of
the cone, G and Q from E₁ alone. Those formulas cancel, so they are evaluated with more digits.
"""

from dataclasses import dataclass

import mpmath as mp
import numpy as np

RIGHT = np.pi / 2
DIGITS = 50


@dataclass(frozen=True)
class KnownValue:
    """A point of a quantity where the exact value is elementary, and the reason `why`."""

    quantity: str
    arguments: tuple[float, ...]
    exact: float
    why: str


def _grazing(alpha, theta_f, phi):
    """P_s at u·n = 0, where the constant of the cubic is zero: ½ (1 + κ (u·t)(n·t) / (σ_u σ_n))."""
    kappa, a, b = 1 - alpha**2, np.sin(theta_f) * np.cos(phi), np.cos(theta_f)
    return (1 + kappa * a * b / np.sqrt((1 - kappa * a * a) * (1 - kappa * b * b))) / 2


def _upright(alpha, theta_u):
    """P_s at t = n, where u, n and t are in one plane and λ is the root of a quadratic."""
    kappa, c = 1 - alpha**2, np.cos(theta_u)
    h = -kappa * c / 2
    size = np.hypot(h, alpha)
    root = alpha**2 / (size - h)
    return 1 - root**2 / (2 * alpha * size * np.sqrt(1 - kappa * c * c))


def _across(alpha, theta_u):
    """P_s where t is at right angles to u and n, so that λ = 1."""
    c = np.cos(theta_u)
    return 1 - np.sqrt((1 + c) / (1 + alpha**2 * c)) / 2


def upright_average(alpha):
    """R at t = n: atan2(s (1 + α²), 1 + α² + 2α⁴) / s, where s = 2α √(1 − α²)."""
    s = 2 * alpha * np.sqrt((1 - alpha) * (1 + alpha))
    return np.arctan2(s * (1 + alpha**2), 1 + alpha**2 + 2 * alpha**4) / s if s else 0.5


def _table() -> list[KnownValue]:
    values = [
        KnownValue("ps", (1.0, theta_f, theta_u, phi), 0.5, "no preferred direction")
        for theta_f, theta_u, phi in ((0, 0, 0), (0.7, 1.1, 2.0), (RIGHT, RIGHT, 0), (0.3, 0, 1))
    ]
    for alpha in (0.15, 0.4, 0.9):
        values += [
            KnownValue("ps", (alpha, 0, 0, 0), 1 / (1 + alpha**2), "u = t = n"),
            KnownValue(
                "ps",
                (alpha, RIGHT, 0, 0),
                1 - 1 / np.sqrt(2 * (1 + alpha**2)),
                "u = n across the fibre",
            ),
            KnownValue("ps", (alpha, 0, 1.0, 2.0), _upright(alpha, 1.0), "coplanar"),
            KnownValue(
                "ps", (alpha, RIGHT, 1.2, RIGHT), _across(alpha, 1.2), "u, n across the fibre"
            ),
            KnownValue("ps", (alpha, 0.8, RIGHT, 0.5), _grazing(alpha, 0.8, 0.5), "grazing"),
            KnownValue("ps", (alpha, 0.8, RIGHT, np.pi), _grazing(alpha, 0.8, np.pi), "grazing"),
            KnownValue("r", (alpha, 0.0), float(upright_average(alpha)), "upright fibre"),
        ]
    values += [KnownValue("r", (1.0, theta), 0.5, "P_s = 1/2") for theta in (0.0, 0.6, RIGHT)]
    values += [
        KnownValue("g", (d, nu), 1 - nu * np.log1p(1 / nu), "opaque layer")
        for d, nu in ((750.0, 1.0), (1e6, 0.3), (1e9, 1e-3))
    ]
    values += [KnownValue("g", (d, 0.0), 1.0, "grazing view") for d in (1e-6, 0.5, 30.0)]
    values += [KnownValue("g", (0.0, nu), 0.0, "no layer") for nu in (1e-3, 1.0)]
    values += [
        KnownValue("q", (0.0,), 1.0, "no layer"),
        KnownValue("q", (1.0,), float(mp.e1(1)), "E₃(1) = E₁(1)/2"),
        KnownValue("q", (1e4,), 0.0, "opaque layer"),
        KnownValue("velvet", (0.0,), 1.0, "isotropic lobe"),
        KnownValue("velvet", (-np.sqrt(0.5),), np.pi / (4 * np.sqrt(2) + 2 * np.pi), "x = s"),
    ]
    # GGX at α = 1: the half vectors of all lights are equally likely.
    values += [
        KnownValue("ggx-directional-albedo", (mu, 1.0), 1 - mu * np.log1p(1 / mu), "α = 1")
        for mu in (0.1, 0.5, 1.0)
    ]
    values += [
        KnownValue("ggx-directional-albedo", (0.0, 0.3), 1.0, "grazing light is not masked"),
        KnownValue("ggx-bias", (0.0, 1.0), 1 / 21, "α = 1, μ = 0"),
        KnownValue("ggx-scale", (0.0, 1.0), 20 / 21, "α = 1, μ = 0"),
        KnownValue("ggx-average-albedo", (1.0,), 4 / 3 * (1 - np.log(2)), "average of α = 1"),
    ]
    # Without a spread, the lobe is that of the texels. Skin without curvature is a plane.
    values += [
        KnownValue("sggx-filter", (0.0,), 1.0, "no spread"),
        KnownValue("sggx-filter-axes", (0.0, 0.0), 1.0, "no spread"),
    ]
    values += [
        KnownValue(f"skin-{surface}-{channel}", (cosine, 0.0), max(cosine, 0.0), "a plane")
        for surface in ("cylinder", "sphere")
        for channel in ("red", "green", "blue")
        for cosine in (-0.5, 0.25, 1.0)
    ]
    values += [
        KnownValue(f"skin-lobe-{surface}", (cosine, 0.0), max(cosine, 0.0), "a plane")
        for surface in ("cylinder", "sphere")
        for cosine in (-0.5, 0.25, 1.0)
    ]
    values += [
        KnownValue(f"skin-band-{band}-{channel}", (0.0,), 1.0, "a plane")
        for band in (1, 2)
        for channel in ("red", "green", "blue")
    ]
    return values


KNOWN_VALUES = _table()


def exact_ps(alpha, theta_f, theta_u, phi) -> mp.mpf:
    """Return P_s of a fibre with 50 digits, for float64 arguments taken as exact."""
    with mp.workdps(DIGITS):
        alpha, theta_f, theta_u, phi = map(mp.mpf, map(float, (alpha, theta_f, theta_u, phi)))
        fiber = mp.matrix([mp.sin(theta_f), 0, mp.cos(theta_f)])
        return _cone_fraction(mp.eye(3) - (1 - alpha) * (fiber * fiber.T), _light(theta_u, phi))


def exact_sggx(matrix, theta_u, phi) -> mp.mpf:
    """Return P_s of an SGGX matrix with 50 digits, for float64 arguments taken as exact."""
    with mp.workdps(DIGITS):
        values, vectors = mp.eigsy(mp.matrix(np.asarray(matrix).tolist()))
        root = vectors * mp.diag([mp.sqrt(value) for value in values]) * vectors.T
        return _cone_fraction(root, _light(mp.mpf(float(theta_u)), mp.mpf(float(phi))))


def _light(theta_u, phi):
    sine = mp.sin(theta_u)
    return mp.matrix([sine * mp.cos(phi), sine * mp.sin(phi), mp.cos(theta_u)])


def _cone_fraction(root, light):
    """P_s = 1 − |e₁·ẑ| λ₁ / √((λ₁ − λ₂)(λ₁ − λ₃)), where λᵢ are the eigenvalues of S^½ B S^½."""
    normal = mp.matrix([0, 0, 1])
    cone = light * normal.T + normal * light.T - light[2] * mp.eye(3)
    image = root * cone * root
    values, vectors = mp.eigsy((image + image.T) / 2)
    seen = root * light
    alignment = abs((vectors[:, 2].T * seen)[0]) / mp.norm(seen)
    return 1 - alignment * values[2] / mp.sqrt((values[2] - values[1]) * (values[2] - values[0]))


def exact_g(density, cos_v) -> mp.mpf:
    """Return G with 50 digits for d, ν > 0."""
    # Terms of order one cancel and leave G ~ d/ν. The extra digits make up for it.
    with mp.workdps(DIGITS + int(max(0, -np.log10(density)) + max(0, -np.log10(cos_v)))):
        d, nu = mp.mpf(float(density)), mp.mpf(float(cos_v))
        e1 = _e1(d)
        escaped = mp.exp(-d / nu) * (mp.exp(-d) - d * e1 - nu * e1)
        return 1 - nu * mp.log(1 + 1 / nu) - escaped - nu * _e1(d + d / nu)


def exact_q(density) -> mp.mpf:
    """Return Q with 50 digits for d > 0."""
    with mp.workdps(DIGITS + 10):
        d = mp.mpf(float(density))
        return mp.exp(-d) - d * (mp.exp(-d) - d * _e1(d))


def _e1(x):
    return mp.e1(x) if x < 10000 else mp.mpf(0)


def distance(values, exact) -> np.ndarray:
    """Return |value − exact| for each element, rounded to float64 only after the subtraction."""
    pairs = zip(np.asarray(values), exact, strict=True)
    return np.array([float(abs(mp.mpf(float(value)) - truth)) for value, truth in pairs])


def awkward_points(seed: int, count: int, least_alpha: float) -> np.ndarray:
    """Return points (α, θf, θu, φ), shape (4, count), many of them where P_s is hard to evaluate.

    Angles are at the ends of their domain, close to them (down to a fraction of 1e-12), at quarters
    of it, or anywhere. In some points the light is within a few α of the fibre or of its opposite,
    or both are near the horizon. α is log-uniform from `least_alpha` to 1.
    """
    rng = np.random.default_rng(seed)
    alpha = np.exp(rng.uniform(np.log(least_alpha), 0, count))

    def bunched():
        near = 10 ** rng.uniform(-12, 0, count)
        kinds = (near, 1 - near, rng.integers(0, 5, count) / 4, rng.integers(0, 2, count))
        return np.choose(rng.integers(0, 5, count), (*kinds, rng.random(count)))

    theta_f, theta_u, phi = RIGHT * bunched(), RIGHT * bunched(), np.pi * bunched()
    offsets = alpha * 10 ** rng.uniform(-3, 1, count) * rng.normal(size=(3, count))
    kind = rng.integers(0, 4, count)

    def fold(angle):
        return np.clip(np.abs(angle), 0, RIGHT)

    theta_f = np.where(kind == 1, fold(RIGHT - np.abs(offsets[0])), theta_f)
    theta_u = np.select(
        [kind == 0, kind == 1],
        [fold(theta_f + offsets[1]), fold(RIGHT - np.abs(offsets[1]))],
        theta_u,
    )
    phi = np.where(kind <= 1, np.clip(np.abs(offsets[2]), 0, np.pi), phi)
    phi = np.where((kind <= 1) & (rng.random(count) < 0.5), np.pi - phi, phi)
    return np.stack([alpha, theta_f, theta_u, phi])
