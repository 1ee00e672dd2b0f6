"""Exact values in Arb's ball arithmetic, written anew from docs/closed-form.md and docs/brdf.md."""

import numpy as np
from flint import acb, arb, arb_mat

from tests.fitting.arb_jets import Angle, Jet, between, rising, variables


def q_exact(density: Jet) -> Jet:
    """Q = 2E₃(d), which falls with the slope −2E₂(d). Eₙ(0) = 1/(n − 1), and d ≥ 0."""

    def integral(n: int):
        return lambda x: x.expint(n) if x > 0 else arb(1) / (n - 1)

    value, slope = (2 * rising(integral(n), density.value) for n in (3, 2))
    return density.function(value, 2 * integral(3)(density.centre), -slope)


def g_exact(density: Jet, cosine: Jet) -> Jet:
    """G, which rises with d and falls with ν."""

    def at(d, nu):
        decay = (-d / nu).exp()
        logarithms = (1 + 1 / nu).log() + (d + d / nu).expint(1) - decay * d.expint(1)
        return 1 - decay * d.expint(2) - nu * logarithms

    d, nu = density.value, cosine.value
    value = at(d.lower(), nu.upper()).union(at(d.upper(), nu.lower()))
    path = rising(lambda x: x, d) / nu
    decay = rising(lambda x: (-x).exp(), path)
    first, second = (rising(lambda x, n=n: x.expint(n), d) for n in (1, 2))
    total = d + path
    by_density = decay / nu * second
    logarithms = (1 + 1 / nu).log() + rising(lambda x: x.expint(1), total) - decay * first
    by_cosine = path * decay * (first - second / nu) - logarithms
    by_cosine = by_cosine + (1 - rising(lambda x: (-x).exp(), total)) / (1 + nu)
    pairs = zip(density.slopes, cosine.slopes, strict=True)
    slopes = [by_density * a + by_cosine * b for a, b in pairs]
    return Jet(value, at(density.centre, cosine.centre), slopes, density.radii)


def velvet_exact(asymmetry: Jet) -> Jet:
    """r(k), for x = −k near zero by the integral's power series, whose terms are positive."""
    x = -asymmetry
    if x.value < 0.3:
        sines = [arb.pi(), arb(2)]
        for m in range(2, 62):
            sines.append(sines[m - 2] * (m - 1) / m)
        # The terms left out: a_n ≤ 2 (n + 1), so that their sum is below 2 · 61 · 0.3⁶⁰/0.7².
        total = x * 0 + arb(0, 1e-28)
        for n in reversed(range(60)):
            total = total * x + 2 / arb.pi() * (n + 1) * sines[n + 2]
        return 1 / ((1 - x * x) * total)
    s = ((1 - x) * (1 + x)).sqrt()
    bracket = (2 * x.asin() + arb.pi()) * (2 * (x * x) - 1) + 2 * (x * s) + s * s * s * arb.pi()
    return arb.pi() / 2 * (x * x) * s / bracket


def cubic_root(p: Jet, r: Jet, m: Jet) -> Jet:
    """The positive root λ of λ (λ − p)(λ + r) = m (1 − λ²); it rises with p and m, falls with r."""

    def root(p, r, m, up: bool):
        low, high = arb(0), arb(1)
        for _ in range(60):
            x = ((low + high) / 2).mid()
            sign = x * (x - p) * (x + r) - m * (1 - x * x)
            if sign > 0:
                high = x
            elif sign < 0:
                low = x
            else:
                break
        return high if up else low

    ends = [
        root(f.lower(), g.upper(), h.lower(), False) for f, g, h in ((p.value, r.value, m.value),)
    ]
    ends += [
        root(f.upper(), g.lower(), h.upper(), True) for f, g, h in ((p.value, r.value, m.value),)
    ]
    value = between(*ends)
    centre = between(*(root(p.centre, r.centre, m.centre, up) for up in (False, True)))
    gap = value - p.value
    slope = gap * (value + r.value) + value * (value + r.value) + value * gap + 2 * m.value * value
    partials = value * (value + r.value) / slope, -value * gap / slope, (1 - value**2) / slope
    slopes = None
    if slope > 0 and all(each.slopes is not None for each in (p, r, m)):
        triples = zip(p.slopes, r.slopes, m.slopes, strict=True)
        slopes = [sum(a * b for a, b in zip(partials, each, strict=True)) for each in triples]
    return Jet(value, centre, slopes, p.radii)


def ps_exact(alpha: Jet, half_f: Jet, half_u: Jet, cos_phi: Jet) -> tuple[Jet, list]:
    """P_s from α, the tangents of half of θf and of θu, and cos φ; and the arguments of a table."""
    angles = []
    for half in (half_f, half_u):
        square = half * half
        angles.append(Angle((1 - square) / (1 + square), 2 * half / (1 + square)))
    arguments = [alpha, *angles, Angle(cos_phi, None)]
    b, c = (each.cosine.cut(0, 1) for each in angles)
    a = (angles[0].sine * angles[1].sine * cos_phi + b * c).cut(-1, 1)
    kappa = (1 - alpha) * (1 + alpha)
    sigma2, other2 = (1 - kappa * (x * x) for x in (a, b))
    least = float(alpha.value.lower()) ** 2 * (1 - 1e-9)
    sigma2, other2 = sigma2.cut(least, 1), other2.cut(least, 1)
    t, s = kappa * (a * b), (sigma2 * other2).sqrt()
    m = alpha * alpha * c
    root = cubic_root(s - t, s + t, m).cut(least, 1)
    root2 = root * root
    above = root2 * ((root + c) * (root + m / sigma2)).sqrt()
    return 1 - above / (2 * root * root2 + (m + 2 * t) * root2 + m), arguments


# R by rigorous integration, which finds by itself how far functions can be continued


def _root_of(a: acb, e: acb, m: acb) -> acb:
    """Enclose the continuation of the positive root of x³ + ax² − ex − m; NaN if that fails.

    The sets a, e and m are connected and contain real numbers. Krawczyk's operator shows that the
    cubic has exactly one root in a square, for all of them. At the real middle it is the positive
    one.
    """
    by_a, by_e, by_m = (float(each.real.mid()) for each in (a, e, m))
    x = 1.0
    for _ in range(80):
        slope = (3 * x + 2 * by_a) * x - by_e
        step = (((x + by_a) * x - by_e) * x - by_m) / slope
        x -= step
        if abs(step) < 1e-15:
            break
    middle, rate = acb(x), acb(1 / slope)
    newton = (((middle + a) * middle - e) * middle - m) * rate
    size = float(newton.abs_upper()) * 2 + 1e-20
    if not size < 1:
        return acb("nan")
    away = acb(arb(0, size), arb(0, size))
    square = middle + away
    found = middle - newton + (1 - ((3 * square + 2 * a) * square - e) * rate) * away
    return found if square.contains_interior(found) else acb("nan")


def _with_real_part(x: acb) -> acb:
    return acb(x.real, x.imag.union(arb(0)))


def _goes_up(alpha: arb, theta_f: arb, theta_u: acb, phi: acb, analytic: bool) -> acb:
    """1 − P_s, or its continuation to complex angles of the light."""
    b, kappa = theta_f.cos(), (1 - alpha) * (1 + alpha)
    coefficients = []
    for theta, azimuth in ((_with_real_part(theta_u), _with_real_part(phi)), (theta_u, phi)):
        c = theta.cos()
        a = theta.sin() * theta_f.sin() * azimuth.cos() + b * c
        m = alpha**2 * c
        coefficients.append((m + 2 * kappa * b * a, 1 - kappa * (a * a + b * b), m))
    root, (total, _, m) = _root_of(*coefficients[0]), coefficients[1]
    above = ((root + c) * (root + m / (1 - kappa * a * a))).sqrt(analytic=analytic) * root**2
    return above / ((2 * root + total) * root**2 + m)


def r_exact(alpha: float, theta_f: float, tolerance: float) -> arb:
    """Enclose R by nested integration over θu and φ."""
    roughness, fibre, pieces = arb(alpha), arb(theta_f), 24

    def over_azimuth(theta_u: acb, analytic: bool) -> acb:
        def value(phi: acb, analytic: bool = analytic) -> acb:
            return _goes_up(roughness, fibre, theta_u, phi, analytic)

        if float(theta_u.real.rad()) + float(theta_u.imag.abs_upper()) < 1e-12:
            whole = acb.integral(value, 0, arb.pi(), abs_tol=tolerance, rel_tol=tolerance)
        else:
            # A set of values is enough, as a bound or to see that it has to be divided.
            width, whole = arb.pi() / pieces, acb(0)
            for k in range(pieces):
                whole += value(acb((width * k).union(width * (k + 1)))) * width
        return theta_u.cos() * theta_u.sin() * whole

    half = acb.integral(over_azimuth, 0, arb.pi() / 2, abs_tol=tolerance, rel_tol=tolerance)
    return 1 - 2 / arb.pi() * half.real


def r_on_patches(places: np.ndarray, powers: list[arb_mat], box: np.ndarray) -> Jet | None:
    """Evaluate the polynomial of a patch that contains a box of α and θf; None if no patch does."""
    x, ends = variables(box), box.T
    on = np.abs(ends[None] - places[:, None, ::2]) <= places[:, None, 1::2]
    found = np.flatnonzero(on.all(axis=(1, 2)))
    if len(found) == 0:
        return None
    place, matrix = places[found[0]], powers[found[0]]
    local = [
        (each - arb(float(middle))) / arb(float(half))
        for each, middle, half in zip(x, place[::2], place[1::2], strict=True)
    ]

    def powers_of(number: arb, count: int) -> tuple[list, list]:
        values = [arb(1)]
        for _ in range(count - 1):
            values.append(values[-1] * number)
        return values, [k * values[k - 1] if k else arb(0) for k in range(count)]

    sums = []
    sizes = matrix.nrows(), matrix.ncols()
    for part in ("centre", "value"):
        rows, columns = (
            powers_of(getattr(each, part), n) for each, n in zip(local, sizes, strict=True)
        )
        row = [arb_mat(1, sizes[0], each) * matrix for each in rows]
        column = [arb_mat(sizes[1], 1, each) for each in columns]
        sums.append([(row[i] * column[j])[0, 0] for i, j in ((0, 0), (1, 0), (0, 1))])
    slopes = [sums[1][k + 1] * local[k].slopes[k] for k in range(2)]
    return Jet(sums[1][0], sums[0][0], slopes, x[0].radii)
