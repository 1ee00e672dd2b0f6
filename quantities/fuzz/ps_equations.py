"""The equations of the forms of P_s, as text.

Their names are those of the exported code: c = u·n and a = u·t, m0, m1, … for what the first stage
returns, and C[k] for the coefficients.
"""

import itertools

from fitting.shapes.surfaces import surface_text

# The two arguments of the second stage. A header has the names in the shader in their place.
_DIRECTION = (
    "{n} = cos(θu)",
    "{t} = sin(θu)·cos(φ)·sin(θf) + {n}·cos(θf)",
)
# The elements of the vector x of Eq. (2) and (5) in b = β, g = γ and d = δ
TERMS = ["b", "g", "d", "b²", "g²", "b·g", "b·d", "b³", "g³", "d³", "b²·g", "b²·d", "b·g²"]
_MATERIAL = ("b = cos(θf)", "y = b²", "β = 1 − α", "κ = β·(1 + α)")


def rational_ps_equation() -> str:
    """Return Eq. (1) and (2); row k of the coefficients begins at C[27 k]."""
    span = 1 + 2 * len(TERMS)
    rows = [f"c{k} = {'1/2 + ' if k == 0 else ''}r({span * k})" for k in range(6)]
    return _joined(
        *_direction("n", "t"),
        *_variables(),
        f"s(i) = {_weighted(TERMS, ['i', *(f'i+{k}' for k in range(1, len(TERMS)))])}",
        f"r(i) = b·(C[i] + s(i+1))/(1 + s(i+{1 + len(TERMS)}))",
        *rows,
        "P_s = c0 + c1·n + c2·t + c3·n² + c4·n·t + c5·t²",
    )


def _variables() -> tuple[str, ...]:
    """Return the definitions of b, g and d, which are β, γ and δ in Eq. (2) and (5)."""
    return "b = 1 − α", "g = cos(θf)", "d = sin(θf)"


def rational_r_equation(below: int) -> str:
    """Return Eq. (5), whose denominator has the first `below` terms."""
    split = 1 + len(TERMS)
    return _joined(
        *_variables(),
        f"numerator = C[0] + {_weighted(TERMS, [str(k) for k in range(1, split)])}",
        f"denominator = 1 + {_weighted(TERMS[:below], [str(split + k) for k in range(below)])}",
        "R = 1/2 + b·numerator/denominator",
    )


def _weighted(terms: list[str], places: list[str]) -> str:
    """Write a sum of terms with the coefficients at these places."""
    return " + ".join(f"C[{place}]·{term}" for place, term in zip(places, terms, strict=True))


def one_root_equation(skew: int, degree: int) -> str:
    """Return the equation of `one_root_ps`."""
    surfaces = 6 if skew else 4
    materials = ["m0 = −β·u0", "m1 = κ·b·u1", "m2 = 1 − κ·y", "m3 = u2", "m4 = u3"]
    above, below = "m0·c + m1·a", "m2 + m3·c + m4·a²"
    if skew:
        materials += ["m5 = b·u4", "m6 = β·b·u5"]
        above, below = "m0·c + a·(m1 + m6·c)", "m2 + m3·c + a·(m4·a + m5·c)"
    return _joined(
        *_direction("c", "a"),
        *_MATERIAL,
        *_surfaces(surfaces, degree),
        *materials,
        f"P_s = 1/2 + ({above})/√({below})",
    )


def two_root_equation(terms: int, degree: int, least: str) -> str:
    """Return the equation of `two_root_ps`; `least` is the limit of the denominator."""
    if terms == 3:
        materials = ["m2 = β·u0²/q", "m3 = (2·u1 + β·u2)/√q", "m4 = u1/q"]
    else:
        materials = [
            "h0 = β·u1 − u0²/4",
            "m2 = u0²/q",
            "m3 = (2·(u2 − h0) + β·u3)/√q",
            "m4 = u2/q",
            "m5 = h0/√q",
            *(["m6 = β·u4/q"] if terms > 4 else []),
        ]
    slope = "(m4 + m6·c)" if terms > 4 else "m4"
    return _joined(
        *_direction("c", "a"),
        *_MATERIAL,
        "q = 1 − κ·y",
        *_surfaces(terms, degree),
        "m0 = κ",
        "m1 = κ·b/√q",
        *materials,
        "σ = √(1 − m0·a²)",
        f"h = σ − m1·a{' + m5·c' if terms > 3 else ''}",
        "R = √(h² + m2·c)",
        "t = h + R",
        f"below = max(σ·R + {slope}·c, {least})",
        "P_s = 1 − t·(t + m3·c)/(8·below)",
    )


def cubic_equation(steps: int, degree: int, least: str) -> str:
    """Return the equation of `cubic_ps`; `least` is the limit of λ and of denominators."""
    free = degree < 0
    root, newton = "root", []
    if steps:
        root = f"root_{steps + 1}"
        named = ["root", *(f"root_{k + 2}" for k in range(steps))]
        newton = [
            "b = E + 2·T",
            "w = 1 − σ2 − m3",
            "z(x) = (x + b)·x + w",
            f"slope(x) = max((2·x + b)·x + z(x), {least})",
            f"step(x) = max(x − (z(x)·x − E)/slope(x), {least})",
            *(f"{new} = step({old})" for old, new in itertools.pairwise(named)),
            f"ellipse = 3·{root} + 2·b + w/{root}",
        ]
    closing = newton or [
        "top = root + T",
        "ellipse = (top² − S²)/root + 2·(top + E)",
    ]
    # A single coefficient is called m5 itself.
    some = [f"u = {surface_text(degree, 'α', 'y', '')}"] if degree > 0 else []
    bent = "m5" if degree else "m5·β·α²"
    return _joined(
        *_direction("c", "a"),
        "y = cos(θf)²",
        "β = 1 − α",
        "κ = β·(1 + α)",
        "q = 1 − κ·y",
        *some,
        "m0 = κ",
        "m1 = α²",
        "m2 = κ·cos(θf)",
        "m3 = q",
        "m4 = √q",
        *(["m5 = u·β·α²"] if some else []),
        "σ2 = 1 − m0·a²",
        "S = m4·√σ2",
        "T = m2·a",
        "E = m1·c",
        f"g = {'max(S, T)' if free else f'√(S² + T² + {bent}·c)'}",
        "e = E/(S + g + E)",
        "h = (S − T)·(1 − e)/2",
        f"root = max(h + √(h² + e), {least})",
        *closing,
        f"P_s = 1 − √(({root} + c)·({root} + E/σ2))/max(ellipse, {least})",
    )


def _surfaces(count: int, degree: int) -> list[str]:
    if degree == 0:
        return []  # The coefficients are called u0, u1, … themselves.
    size = (degree + 1) * (degree + 2) // 2
    named = [f"u{k} = u({k * size})" for k in range(count)]
    return [f"u(i) = {surface_text(degree, 'α', 'y', 'i')}", *named]


def _direction(n: str, t: str) -> list[str]:
    return [each.format(n=n, t=t) for each in _DIRECTION]


def _joined(*statements: str) -> str:
    return "; ".join(statements)
