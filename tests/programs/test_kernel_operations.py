"""Operations of the compiled interval arithmetic: values, slopes, conditions, what is undefined.

Slopes are not returned, but they cut the bounds of f(x) − k·x, whose operands alone would leave
bounds of the width of k·x. A slope that is too wide leaves them wide, and one that is too narrow
cuts off values.
"""

import functools
import itertools

import mpmath
import numpy as np
import pytest

from programs.bounding import compiled
from programs.bounding.compiled import Kernel, compile_kernel, compiler_missing

pytestmark = pytest.mark.skipif(compiler_missing() is not None, reason="no C compiler")

SMALLEST, NORMAL = 5e-324, 2.0**-1022
X, Y = "x[0]", "x[1]"

# C code, the function with 30 digits, and the middles of the boxes where it is tried: about the
# places where one series takes over from another, or the quadrant changes
FUNCTIONS = {
    "EXP(X)": (mpmath.exp, (-690.0, -3.2, -0.3466, 0.0, 0.34, 0.36, 7.0, 650.0)),
    "EXPM1(X)": (mpmath.expm1, (-30.0, -0.36, -0.35, -0.34, 1e-3, 0.3495, 0.3505, 9.0)),
    "EXP2(X)": (lambda x: mpmath.mpf(2) ** x, (-30.5, -0.51, 0.2, 9.0)),
    "LOG(X)": (mpmath.log, (1e-9, 0.3, 0.7071, 1.0, 1.41, 1.4147, 2.0, 5e7)),
    "LOG1P(X)": (mpmath.log1p, (-0.97, -0.281, -0.279, 1e-3, 0.3995, 0.4005, 30.0)),
    "SIN(X)": (mpmath.sin, (-990.0, -2.357, -1.0, 0.1, 0.786, 2.0, 3.9, 5.6, 700.5)),
    "COS(X)": (mpmath.cos, (-990.0, -2.357, -1.0, 0.1, 0.786, 2.0, 3.9, 5.6, 700.5)),
    "TAN(X)": (mpmath.tan, (-1.4, -0.2, 0.786, 2.5)),
    "ATAN(X)": (mpmath.atan, (-50.0, -1.0, 0.0, 0.3, 3.0)),
    "ASIN(X)": (mpmath.asin, (-0.95, -0.3, 0.0, 0.72)),
    "ACOS(X)": (mpmath.acos, (-0.95, -0.3, 0.0, 0.72)),
    "SINH(X)": (mpmath.sinh, (-3.0, 0.0, 1.5)),
    "COSH(X)": (mpmath.cosh, (-3.0, 0.0, 1.5)),
    "TANH(X)": (mpmath.tanh, (-2.0, 0.0, 1.5)),
    "SQRT(X)": (mpmath.sqrt, (0.04, 0.5, 9.0)),
    "RSQRT(X)": (lambda x: 1 / mpmath.sqrt(x), (0.04, 0.5, 9.0)),
    "POW(X, 2.3)": (lambda x: x ** mpmath.mpf(2.3), (0.04, 0.9, 5.0)),
    "POW(X, 1.0)": (lambda x: x, (0.04, 0.9, 5.0)),
    "POW(X, 0.4)": (lambda x: x ** mpmath.mpf(0.4), (0.04, 0.9, 5.0)),
    "POW(X, -1.5)": (lambda x: x ** mpmath.mpf(-1.5), (0.5, 0.9, 5.0)),
    "POW(1.7, X)": (lambda x: mpmath.mpf(1.7) ** x, (-2.0, 0.04, 5.0)),
    "ABS(X)": (abs, (-2.0, 0.3)),
    "MUL(X, X)": (lambda x: x * x, (-2.0, 0.0, 0.3)),
    "MUL(X, -0.3)": (lambda x: x * mpmath.mpf(-0.3), (-2.0, 0.0, 0.3)),
    "ADD(0.7, X)": (lambda x: x + mpmath.mpf(0.7), (-2.0, 0.3)),
    "SUB(0.7, X)": (lambda x: mpmath.mpf(0.7) - x, (-2.0, 0.3)),
    "SUB(X, 0.7)": (lambda x: x - mpmath.mpf(0.7), (-2.0, 0.3)),
    "DIV(-0.7, X)": (lambda x: mpmath.mpf(-0.7) / x, (-2.0, -0.3, 0.3, 4.0)),
    "DIV(X, -0.7)": (lambda x: x / mpmath.mpf(-0.7), (-2.0, 0.3)),
}
# Operations of two operands; the second code has the same value
PAIRS = {
    "ADD(X, Y)": (lambda x, y: x + y, "SUB(X, NEG(Y))"),
    "MUL(X, Y)": (lambda x, y: x * y, "DIV(MUL(X, MUL(Y, Y)), Y)"),
    "DIV(X, Y)": (lambda x, y: x / y, "MUL(DIV(1.0, Y), X)"),
    "MAX(X, Y)": (max, "NEG(MIN(NEG(X), NEG(Y)))"),
    "MIN(X, Y)": (min, "NEG(MAX(NEG(X), NEG(Y)))"),
    "SELECT(LT(X, Y), X, Y)": (min, "MIN(X, Y)"),
    "ATAN2(X, ABS(Y))": (lambda x, y: mpmath.atan2(x, abs(y)), "ATAN(DIV(X, ABS(Y)))"),
    "POW(ABS(X), Y)": (lambda x, y: abs(x) ** y, "EXP(MUL(LOG(ABS(X)), Y))"),
}
CONDITIONS = {
    "LT(X, Y)": lambda x, y: x < y,
    "LE(X, Y)": lambda x, y: x <= y,
    "GT(X, Y)": lambda x, y: x > y,
    "GE(X, Y)": lambda x, y: x >= y,
    "EQ(X, Y)": lambda x, y: x == y,
    "NE(X, Y)": lambda x, y: x != y,
    "AND(LT(X, Y), LT(X, 1.0))": lambda x, y: x < y and x < 1,
    "OR(LT(X, Y), LT(X, 1.0))": lambda x, y: x < y or x < 1,
    "NOT(LE(X, Y))": lambda x, y: not x <= y,
}
OTHERS = ("FLOOR(X)", "CEIL(X)", "ABS(X)", "SQRT(X)", "POW(X, 0.4)", "MAX(X, Y)", "ATAN2(X, Y)")
CODE = [*(f"SUB({code}, MUL(Y, X))" for code in FUNCTIONS), *FUNCTIONS, *OTHERS]
CODE += [*PAIRS, *(f"SUB({code}, {other})" for code, (_, other) in PAIRS.items())]
CODE += [f"SELECT({code}, 1.0, 0.0)" for code in CONDITIONS]
CODE += ["SUB(MAX(X, Y), X)", "SUB(MIN(X, Y), X)", "SUB(FLOOR(X), X)"]
PLACES = {code: k for k, code in enumerate(dict.fromkeys(CODE))}


def compile_all() -> Kernel:
    cases = "\n".join(
        f"static jet f{k}(boxes *K, const jet *x) {{ return JET({code}); }}"
        for code, k in (
            (code.replace("X)", f"{X})").replace("X,", f"{X},"), k) for code, k in PLACES.items()
        )
    ).replace("Y", Y)
    names = ", ".join(f"f{k}" for k in PLACES.values())
    table = f"static jet (*const all_of_them[])(boxes *, const jet *) = {{ {names} }};"
    entry = "static int place; void choose_place(int k) { place = k; }\n"
    entry += "static jet error_at(boxes *K, const jet *x) { return all_of_them[place](K, x); }"
    return compile_kernel([cases, table, entry], 2)


@functools.cache
def kernel() -> Kernel:
    return compile_all()


def bounds(code: str, x: tuple[float, float], y: tuple[float, float] = (0.0, 0.0)):
    """Bound code on a box, and at its centre."""
    return bounds_of(kernel(), code, x, y)


def bounds_of(compiled_kernel: Kernel, code: str, x: tuple, y: tuple = (0.0, 0.0)):
    compiled_kernel.library.choose_place(PLACES[code])
    return compiled_kernel.enclose(np.array([x, y]))


@pytest.mark.parametrize("code", FUNCTIONS)
def test_slopes_leave_bounds_of_the_second_order(code):
    exact, middles = FUNCTIONS[code]
    with mpmath.workdps(30):
        for middle, part in itertools.product(middles, (0.0, 1e-9, 1e-4)):
            scale = min(abs(middle) or 1, 1)
            width = part * scale
            low, high = middle - width, middle + width
            slope = float(mpmath.diff(exact, middle, h=1e-10 * scale))
            points = [mpmath.mpf(float(x)) for x in np.linspace(low, high, 5 if width else 1)]
            values = [exact(x) for x in points]
            plain = bounds(code, (low, high))
            # The middle of the box may be rounded.
            size = max(map(abs, values))
            assert plain[0] <= min(values) and max(values) <= plain[1]
            assert plain[2] - width * 1e-6 <= values[len(values) // 2] <= plain[3] + width * 1e-6
            spread = max(values) - min(values)
            # Tails of series, and what is left of large arguments
            rounding = 1e-13 * (size + abs(slope * middle)) + 1e-15 * (1 + abs(middle))
            bend = max(abs(mpmath.diff(exact, x, 2, h=1e-8 * scale)) for x in (low, middle, high))
            # SINH and the like consist of several operations, whose slopes are as large.
            second_order = 20 * (bend + abs(slope) / scale + 1) * width**2
            assert plain[1] - plain[0] <= 1.01 * spread + second_order + rounding
            cut = bounds(f"SUB({code}, MUL(Y, X))", (low, high), (slope, slope))
            values = [
                value - mpmath.mpf(slope) * x for x, value in zip(points, values, strict=True)
            ]
            assert cut[0] <= min(values) and max(values) <= cut[1]
            assert cut[1] - cut[0] <= second_order + 2 * rounding


@pytest.mark.parametrize("code", PAIRS)
def test_operations_of_two_operands_have_tight_bounds(code):
    exact, other = PAIRS[code]
    rng = np.random.default_rng(9)
    with mpmath.workdps(30):
        for k in range(60):
            low = rng.uniform(0.2, 2, 2) * rng.choice([-1, 1], 2)
            high = low + (0.0, 1e-4, 0.1)[k % 3]
            if (low * high < 0).any():
                continue
            found = bounds(code, *zip(low, high, strict=True))
            corners = itertools.product(
                *(map(mpmath.mpf, side) for side in zip(low, high, strict=True))
            )
            values = [exact(*corner) for corner in corners]
            assert found[0] <= min(values) and max(values) <= found[1]
            middle = exact(*map(mpmath.mpf, low * 0.5 + high * 0.5))
            assert found[2] - 1e-15 <= middle <= found[3] + 1e-15
            assert found[3] - found[2] <= 1e-13 or "SELECT" in code
            apart = bounds(f"SUB({code}, {other})", *zip(low, high, strict=True))
            assert apart[0] <= 0 <= apart[1]
            # An operation that returns an operand has the slopes of both where it is not decided.
            if code[:3] not in ("MAX", "MIN", "SEL") or high[0] < low[1] or high[1] < low[0]:
                assert found[1] - found[0] <= 1.2 * (max(values) - min(values)) + 1e-12
                assert apart[1] - apart[0] <= 400 * (high[0] - low[0]) ** 2 + 1e-12


SIDES = [(0.0, 1.0), (1.0, 1.0), (1.0, 2.0), (1.5, 2.0), (-1.0, 0.0), (0.5, 0.5), (0.25, 3.0)]


@pytest.mark.parametrize("code", CONDITIONS)
def test_a_condition_is_decided_where_it_holds_everywhere_or_nowhere(code):
    holds = CONDITIONS[code]
    for x, y in itertools.product(SIDES, SIDES):
        ends = {1.0, *x, *y, sum(x) / 2, sum(y) / 2}
        lines = ([at for at in ends if low <= at <= high] for low, high in (x, y))
        pairs = list(itertools.product(*lines))
        tried = [holds(*pair) for pair in pairs]
        low, high, *_ = bounds(f"SELECT({code}, 1.0, 0.0)", x, y)
        assert low <= min(tried) and max(tried) <= high
        # Two conditions that depend on each other are decided one by one.
        parts = [{a < b for a, b in pairs}, {a < 1 for a, _ in pairs}]
        if code[:2] not in ("AN", "OR") or max(map(len, parts)) == 1:
            assert (low, high) == (min(tried), max(tried))


KINKS = {
    # The box has its middle on one side of the kink; the range
    ("SUB(ABS(X), MUL(Y, X))", (-0.3, 1.0), (1.0, 1.0)): (0, 0.6),
    ("SUB(ABS(X), MUL(Y, X))", (-1.0, 0.3), (-1.0, -1.0)): (0, 0.6),
    ("SUB(MAX(X, Y), X)", (0.0, 1.0), (0.4, 0.4)): (0, 0.4),
    ("SUB(MAX(X, Y), X)", (0.0, 1.0), (0.6, 0.6)): (0, 0.6),
    ("SUB(MIN(X, Y), X)", (0.0, 1.0), (0.4, 0.4)): (-0.6, 0),
    ("SUB(MIN(X, Y), X)", (0.0, 1.0), (0.6, 0.6)): (-0.4, 0),
    ("SUB(FLOOR(X), X)", (0.1, 1.0), (0.0, 0.0)): (-1, 0),
}


@pytest.mark.parametrize("case", KINKS, ids=str)
def test_a_slope_on_one_side_of_a_kink_does_not_count_on_the_other(case):
    code, *sides = case
    low, high, *_ = bounds(code, *sides)
    least, most = KINKS[case]
    assert low <= least and most <= high
    assert high - low <= 2.7


INF = np.inf
AT_ENDS = {
    # code, sides of the box, and the bounds; infinite ones where it is not defined everywhere
    ("SQRT(X)", (0.0, 4.0)): (0, 2),
    ("SQRT(X)", (-SMALLEST, 4.0)): (-INF, INF),
    ("RSQRT(X)", (0.25, 4.0)): (0.5, 2),
    ("RSQRT(X)", (0.0, 4.0)): (-INF, INF),
    ("POW(X, 0.4)", (0.0, 32.0)): (0, 4),
    ("POW(X, 2.3)", (0.0, 1.0)): (0, 1),
    ("POW(X, 2.3)", (-SMALLEST, 1.0)): (-INF, INF),
    ("POW(X, -1.5)", (0.0, 1.0)): (-INF, INF),
    ("LOG(X)", (NORMAL, 1.0)): (-708.3964185322641, 0),
    ("LOG(X)", (0.0, 1.0)): (-INF, INF),
    ("LOG1P(X)", (-0.999, 0.0)): (np.log1p(-0.999), 0),
    ("LOG1P(X)", (-1.0, 0.0)): (-INF, INF),
    ("ASIN(X)", (-1.0, 1.0)): (-np.pi / 2, np.pi / 2),
    ("ASIN(X)", (-1.0, 1 + 2**-52)): (-INF, INF),
    ("ACOS(X)", (-1.0, 1.0)): (0, np.pi),
    ("ACOS(X)", (-1 - 2**-52, 1.0)): (-INF, INF),
    ("EXP(X)", (-1e300, 699.0)): (0, np.exp(699)),
    ("EXP(X)", (0.0, 701.0)): (-INF, INF),
    ("COS(X)", (-998.0, 998.0)): (-1, 1),
    ("COS(X)", (-1001.0, 999.0)): (-INF, INF),
    ("COS(X)", (0.5, 3.0)): (np.cos(3.0), np.cos(0.5)),
    ("COS(X)", (0.5, 3.2)): (-1, np.cos(0.5)),
    ("COS(X)", (-0.1, 3.0)): (np.cos(3.0), 1),
    ("COS(X)", (6.0, 7.0)): (np.cos(7.0), 1),
    ("SIN(X)", (0.5, 2.0)): (np.sin(0.5), 1),
    ("SIN(X)", (4.0, 5.0)): (-1, np.sin(4.0)),
    ("ATAN(X)", (-1e149, 1.0)): (-np.pi / 2, np.pi / 4),
    ("ATAN(X)", (-1e151, 1.0)): (-INF, INF),
    ("TAN(X)", (-1.0, 1.0)): (-np.tan(1.0), np.tan(1.0)),
    ("TAN(X)", (1.0, 2.0)): (-INF, INF),
    ("DIV(-0.7, X)", (0.0, 1.0)): (-INF, INF),
    ("DIV(-0.7, X)", (-1.0, 0.0)): (-INF, INF),
    ("DIV(X, Y)", (1.0, 2.0), (-1.0, 0.5)): (-INF, INF),
    ("DIV(X, Y)", (1.0, 2.0), (-1.0, -0.5)): (-4, -1),
    ("DIV(X, Y)", (-1.0, 2.0), (0.5, 1.0)): (-2, 4),
    ("ATAN2(X, Y)", (-1.0, 1.0), (1.0, 2.0)): (-np.pi / 4, np.pi / 4),
    ("ATAN2(X, Y)", (-1.0, 1.0), (0.0, 2.0)): (-INF, INF),
    ("MUL(X, X)", (-1e200, 1.0)): (-INF, INF),
    ("MUL(X, X)", (-3.0, 1.0)): (0, 9),
    ("MUL(X, Y)", (-3.0, 1.0), (-2.0, 5.0)): (-15, 6),
    ("ABS(X)", (-3.0, 1.0)): (0, 3),
    ("ABS(X)", (-3.0, -1.0)): (1, 3),
    ("FLOOR(X)", (-0.5, 1.0)): (-1, 1),
    ("FLOOR(X)", (0.25, 0.75)): (0, 0),
    ("FLOOR(X)", (-3.0, -2.5)): (-3, -3),
    ("CEIL(X)", (-0.5, 1.0)): (0, 1),
    ("CEIL(X)", (0.25, 2.25)): (1, 3),
    ("FLOOR(X)", (0.0, 2e15)): (-INF, INF),
    ("MAX(X, Y)", (0.0, 3.0), (1.0, 2.0)): (1, 3),
    ("MAX(X, Y)", (0.0, 1.0), (1.0, 2.0)): (1, 2),
    ("MIN(X, Y)", (0.0, 3.0), (1.0, 2.0)): (0, 2),
}


@pytest.mark.parametrize("case", AT_ENDS, ids=str)
def test_bounds_at_the_ends_of_domains(case):
    code, *sides = case
    low, high, *_ = bounds(code, *sides)
    least, most = AT_ENDS[case]
    if np.isinf(least):
        assert (low, high) == (-np.inf, np.inf)
        return
    room = 1e-13 * max(abs(least), abs(most), 0.1)
    assert least - room <= low <= least + 1e-15 * abs(least)
    assert most - 1e-15 * abs(most) <= high <= most + room


@pytest.mark.slow
def test_a_processor_without_wide_vectors_has_the_same_bounds(monkeypatch):
    monkeypatch.setattr(compiled, "_FASTER", ())
    narrow = compile_all()
    for code, *sides in (*AT_ENDS, *KINKS):
        assert bounds_of(narrow, code, *sides) == bounds(code, *sides)
