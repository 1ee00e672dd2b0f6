"""Interval arithmetic against exact fractions and 60 digits: bounds hold, and are not too wide."""

import itertools
import math
from fractions import Fraction

import mpmath
import numpy as np
import pytest

from programs.bounding import arithmetic as iv
from programs.bounding.arithmetic import Interval

LARGEST, SMALLEST = np.finfo(float).max, 5e-324
# Zero, one, numbers without an exact inverse, and both ends of float64
SPECIAL = (0.0, SMALLEST, 2.3e-308, 1e-200, 0.1, 1 / 3, 1.0, 1.5, 3e8, 7e200, LARGEST)


def operand(values) -> Interval:
    lower, upper = np.array(values, float).T
    return Interval(lower, upper)


def intervals(count: int, seed: int) -> list[tuple[float, float]]:
    """Return intervals whose ends are special, near each other, or of any size."""
    rng = np.random.default_rng(seed)
    ends = [sign * x for x in SPECIAL for sign in (1, -1)]
    some = rng.normal(size=(count, 2)) * 10.0 ** rng.integers(-30, 30, (count, 2))
    pairs = [tuple(rng.choice(ends, 2)) for _ in range(count)]
    pairs += [tuple(pair) for pair in some] + [(x, x) for x, _ in some] + [(x, x) for x in ends]
    pairs += [(x, math.nextafter(x, math.inf)) for x, _ in some]
    return [(float(min(pair)), float(max(pair))) for pair in pairs]


def pairs_of_intervals(seed: int) -> tuple[list, list]:
    """Return first and second operands: those of `intervals`, and all pairs with simple ends."""
    simple = list(itertools.combinations_with_replacement((-1.0, -1 / 3, 0.0, 1 / 3, 1.0), 2))
    first, second = zip(*itertools.product(simple, simple), strict=True)
    return [*intervals(150, seed), *first], [*intervals(150, seed + 1)[::-1], *second]


def exactly(number: float) -> Fraction | float:
    return Fraction(number) if math.isfinite(number) else number


def require(found: Interval, ranges, ulps: int) -> None:
    """Check that bounds hold, and that they are at most `ulps` numbers away from the best ones."""
    inner = found
    with np.errstate(all="ignore"):
        for _ in range(ulps):
            inner = Interval(np.nextafter(inner.lower, np.inf), np.nextafter(inner.upper, -np.inf))
    rows = zip(*found, *inner, ranges, strict=True)
    for low, high, inner_low, inner_high, (least, most) in rows:
        assert exactly(low) <= least <= exactly(inner_low), (low, float(least))
        assert exactly(inner_high) <= most <= exactly(high), (high, float(most))


def hull_of(*numbers):
    return min(numbers), max(numbers)


def products(a, b):
    return hull_of(*(x * y for x, y in itertools.product(a, b)))


BINARY = {
    # operation -> its exact range, and how many numbers its bounds may be from the best ones
    iv.add: (lambda a, b: (a[0] + b[0], a[1] + b[1]), 2),
    iv.subtract: (lambda a, b: (a[0] - b[1], a[1] - b[0]), 2),
    iv.multiply: (products, 2),
    iv.hull: (lambda a, b: (min(a[0], b[0]), max(a[1], b[1])), 0),
    iv.maximum: (lambda a, b: (max(a[0], b[0]), max(a[1], b[1])), 0),
    iv.minimum: (lambda a, b: (min(a[0], b[0]), min(a[1], b[1])), 0),
}


@pytest.mark.parametrize("operation", BINARY)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # overflow
def test_operations_of_two_operands_are_within_two_units_of_exact_fractions(operation):
    exact, ulps = BINARY[operation]
    a, b = pairs_of_intervals(1)
    ranges = [exact([*map(Fraction, x)], [*map(Fraction, y)]) for x, y in zip(a, b, strict=True)]
    require(operation(operand(a), operand(b)), ranges, ulps)


def squares(a):
    least, most = hull_of(a[0] ** 2, a[1] ** 2)
    return (Fraction(0) if a[0] <= 0 <= a[1] else least), most


def absolutes(a):
    least, most = hull_of(abs(a[0]), abs(a[1]))
    return (Fraction(0) if a[0] <= 0 <= a[1] else least), most


UNARY = {
    iv.negate: (lambda a: (-a[1], -a[0]), 0),
    iv.absolute: (absolutes, 0),
    iv.square: (squares, 2),
    iv.floor: (lambda a: (math.floor(a[0]), math.floor(a[1])), 0),
    iv.ceil: (lambda a: (math.ceil(a[0]), math.ceil(a[1])), 0),
}


@pytest.mark.parametrize("operation", UNARY)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_operations_of_one_operand_are_within_two_units_of_exact_fractions(operation):
    exact, ulps = UNARY[operation]
    a = intervals(150, 3)
    require(operation(operand(a)), [exact([*map(Fraction, x)]) for x in a], ulps)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_quotients_are_near_exact_fractions_and_unbounded_with_a_zero():
    a, b = pairs_of_intervals(4)
    has_zero = np.array([low <= 0 <= high for low, high in b])
    inverse, quotient = iv.reciprocal(operand(b)), iv.divide(operand(a), operand(b))
    assert (inverse.lower[has_zero] == -np.inf).all() and (inverse.upper[has_zero] == np.inf).all()
    assert not np.isfinite([*quotient.lower[has_zero], *quotient.upper[has_zero]]).any()
    rest = np.nonzero(~has_zero)[0]
    inverses = [tuple(1 / Fraction(x) for x in reversed(b[k])) for k in rest]
    require(Interval(*(each[rest] for each in inverse)), inverses, 2)
    # The inverse of a number near the ends of float64 has few digits, or none.
    usual = [k for k in range(len(rest)) if all(1e-300 < abs(x) < 1e300 for x in b[rest[k]])]
    ranges = [products([*map(Fraction, a[rest[k]])], inverses[k]) for k in usual]
    # An error of 1.5 units of the inverse, and one as large of the product
    require(Interval(*(each[rest[usual]] for each in quotient)), ranges, 5)


def test_what_is_exact_is_not_rounded():
    one, zero, some = operand([(1, 1)]), operand([(0, 0)]), operand([(-2, 3)])
    assert iv.square(one) == iv.square(operand([(-1, -1)])) == (1, 1)
    assert iv.square(operand([(0, 1)])).upper == 1
    assert iv.subtract(one, one) == iv.multiply(zero, some) == iv.multiply(some, zero) == (0, 0)
    small = operand([(0, 1e-200)])
    assert iv.square(small).lower == 0 == iv.square(operand([(-1, 1)])).lower
    assert iv.multiply(small, small).lower == 0 == iv.multiply(iv.negate(small), small).upper
    assert iv.multiply(iv.negate(small), iv.negate(small)).lower == 0


def test_bounds_that_are_not_known_stay_so():
    unknown, whole = operand([(np.nan, np.nan)]), operand([(-np.inf, np.inf)])
    with np.errstate(invalid="ignore"):
        found = [op(unknown, operand([(1, 2)])) for op in (iv.add, iv.subtract, iv.multiply)]
        found += [op(unknown) for op in (iv.square, iv.reciprocal, iv.absolute, iv.negate)]
        found += [
            op(unknown) for op in (iv.exp, iv.tanh, iv.sqrt, iv.cosh, iv.asin, iv.cos, iv.sin)
        ]
        found += [iv.multiply(operand([(0, 0)]), whole), iv.multiply(whole, operand([(0, 1)]))]
        found += [iv.minimum(unknown, operand([(1, 2)])), iv.hull(unknown, operand([(1, 2)]))]
        assert not np.isfinite(np.array(found)).any()
        assert np.isinf(iv.tan(unknown)).all() and np.isinf(iv.tan(whole)).all()
        assert iv.cos(whole) == (-1, 1)
        larger = iv.maximum(unknown, operand([(1, 2)]))
        assert larger.lower == 1 and np.isnan(larger.upper)


def test_each_bound_is_moved_by_as_many_units_as_are_asked_for():
    a = operand([(1.0, 1.0), (-3e-5, 7e20)])
    for ulps in (1, 4):
        found, ends = iv.outward(*a, ulps), [*a.lower, *a.upper]
        away = [-np.spacing(0.99), np.spacing(-3e-5), np.spacing(1.0), np.spacing(7e20)]
        expected = [end + ulps * unit for end, unit in zip(ends, away, strict=True)]
        assert [*found.lower, *found.upper] == expected
    # This is how much is left for the errors of NumPy's functions.
    middle = np.exp(np.array([0.3]))
    assert iv.exp(operand([(0.3, 0.3)])) == iv.outward(middle, middle, 4)
    np.testing.assert_array_equal(iv.outward(*a), iv.outward(*a, 1))


RISING = {
    # function -> the same with 60 digits, and the ends of where it is tried
    iv.exp: (mpmath.exp, (-740, 709)),
    iv.exp2: (lambda x: mpmath.mpf(2) ** x, (-1070, 1023)),
    iv.expm1: (mpmath.expm1, (-50, 709)),
    iv.log: (mpmath.log, (SMALLEST, LARGEST)),
    iv.log1p: (mpmath.log1p, (np.nextafter(-1, 0), 1e300)),
    iv.sinh: (mpmath.sinh, (-710, 710)),
    iv.tanh: (mpmath.tanh, (-30, 30)),
    iv.atan: (mpmath.atan, (-1e300, 1e300)),
    iv.sqrt: (mpmath.sqrt, (0, LARGEST)),
    iv.asin: (mpmath.asin, (-1, 1)),
    iv.cosh: (mpmath.cosh, (0, 710)),
}


def inside(low: float, high: float, count: int = 40) -> list[tuple[float, float]]:
    """Return intervals from low to high: with these ends, near them, near zero, and others."""
    rng = np.random.default_rng(6)
    ends = [low, np.nextafter(low, high), high, np.nextafter(high, low)]
    near = rng.normal(size=count) * 10.0 ** rng.integers(-20, 3, count)
    places = np.concatenate([ends, rng.uniform(low / 2, high / 2, count), near])
    places = places[(places >= low) & (places <= high)]
    return [(a, max(a, b)) for a, b in zip(places, rng.permutation(places), strict=True)]


@pytest.mark.parametrize("function", RISING)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_functions_that_rise_are_bounded_by_their_ends(function):
    exact, ends = RISING[function]
    boxes = inside(*ends)
    # Four units are for NumPy's error, and at most as many more are there if it has none.
    with mpmath.workdps(60):
        require(function(operand(boxes)), [(exact(a), exact(b)) for a, b in boxes], 8)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_functions_are_bounded_by_their_range():
    far = operand([(-2000, -1000), (1000, 2000), (-2000, 2000), (0, 0)])
    assert (iv.exp(far).lower[[0, 2]] == 0).all() and (iv.exp2(far).lower[[0, 2]] == 0).all()
    assert (iv.expm1(far).lower[[0, 2]] == -1).all()
    assert (iv.exp(far).upper[1:3] == np.inf).all() and (iv.exp(far).lower[1] > 1.7e308)
    assert (iv.tanh(far).lower[[0, 2]] == -1).all() and (iv.tanh(far).upper[1:3] == 1).all()
    assert (iv.cosh(far).lower[2:] == 1).all() and iv.cosh(far).upper[3] < 1 + 1e-15
    assert (iv.cosh(far).upper[:3] == np.inf).all()
    assert 0 <= iv.sqrt(far).upper[0] <= 1e-300
    assert (iv.sqrt(far).lower == [0, iv.sqrt(far).lower[1], 0, 0]).all()
    # The part of an operand outside of the domain is left out.
    some = operand([(-4, 4), (-2, 0.25)])
    np.testing.assert_allclose(iv.sqrt(some), [[0, 0], [2, 0.5]], rtol=2e-15)
    np.testing.assert_allclose(iv.asin(some), [[-np.pi / 2] * 2, [np.pi / 2, np.arcsin(0.25)]])
    np.testing.assert_allclose(iv.acos(some), [[0, np.arccos(0.25)], [np.pi] * 2], atol=1e-14)
    even = iv.cosh(operand([(-3, -2)]))
    np.testing.assert_allclose(even, [[np.cosh(2)], [np.cosh(3)]], rtol=2e-15)


def test_an_arc_cosine_falls():
    boxes = inside(-1, 1)
    with mpmath.workdps(60):
        require(iv.acos(operand(boxes)), [(mpmath.acos(b), mpmath.acos(a)) for a, b in boxes], 8)


def angles() -> list[tuple[float, float]]:
    """Return intervals of angles, of which many begin or end near a multiple of π/2, or far out."""
    rng = np.random.default_rng(7)
    multiples = np.concatenate(
        [rng.integers(-9, 9, 150), *(rng.integers(10**k, 10 ** (k + 1), 100) for k in (11, 17))]
    )
    ends = np.array([float(k * mpmath.pi / 2) for k in multiples.tolist()])
    ends += rng.choice([0, 1, -1, 3, -3, 1e6, -1e6, 1e9], len(ends)) * np.spacing(ends)
    ends = np.concatenate([ends, rng.uniform(-20, 20, 100)])
    widths = rng.choice([0, 1e-15, 1e-9, 0.3, 1.6, 3.2, 6.4], len(ends))
    boxes = [(x - w, x) for x, w in zip(ends, widths, strict=True)]
    # The cosine is −1 in this one. The rounded quotients by π are even numbers.
    boxes.append((4.773196106003911e17, 4.773196106003912e17))
    return boxes + [(x, x + w) for x, w in zip(ends, widths, strict=True)]


def has_multiple(low, high, offset) -> bool:
    """Return whether 2πk + offset is between two numbers, for a whole k."""
    turn = 2 * mpmath.pi
    return mpmath.ceil((low - offset) / turn) <= mpmath.floor((high - offset) / turn)


@pytest.mark.parametrize("name", ["cos", "sin"])
def test_a_wave_is_bounded_with_its_extreme_values(name):
    boxes, exact, found = angles(), getattr(mpmath, name), getattr(iv, name)(operand(angles()))
    with mpmath.workdps(60):
        top = 0 if name == "cos" else mpmath.pi / 2
        for (a, b), low, high in zip(boxes, *found, strict=True):
            least, most = hull_of(exact(a), exact(b))
            most = 1 if has_multiple(a, b, top) else most
            least = -1 if has_multiple(a, b, top + mpmath.pi) else least
            assert -1 <= low <= least and most <= high <= 1
            # A sine is a cosine of an angle that is rounded.
            room = 2e-15 * (1 if name == "cos" else 2 + abs(a))
            # An extreme value may be counted that is as near an end as 1e-12 of the angle.
            room += 2 if b > 1e14 else (4e-12 * max(abs(a), abs(b), 1)) ** 2
            assert least - low <= room and high - most <= room


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_a_tangent_is_bounded_between_its_poles_only():
    boxes, found = angles(), iv.tan(operand(angles()))
    poles = 0
    with mpmath.workdps(60):
        for (a, b), low, high in zip(boxes, *found, strict=True):
            half = mpmath.pi / 2
            if has_multiple(a, b, half) or has_multiple(a, b, -half):
                assert (low, high) == (-np.inf, np.inf)
                poles += 1
            elif np.isfinite(low):
                least, most = mpmath.tan(a), mpmath.tan(b)
                assert low <= least <= most <= high
                room = [2e-15 * abs(each) + 8 * SMALLEST for each in (least, most)]
                assert least - low <= room[0] and high - most <= room[1]
            else:
                # It is refused only if a pole is near.
                assert min(abs(mpmath.cos(a)), abs(mpmath.cos(b))) < 1e-11 * max(abs(a), abs(b), 1)
    assert 50 < poles < len(boxes) / 2


def test_an_angle_is_bounded_by_the_corners_unless_it_jumps():
    rng, boxes = np.random.default_rng(8), []
    for _ in range(150):
        low = rng.choice([0.0, -1.0, 1.0, 0.3, -0.3, 1e-9, -7e5], 2)
        boxes.append((low, low + rng.choice([0.0, 1.0, 0.5, 1e-9, 4.0, 1e6], 2)))
    y, x = (operand([(low[k], high[k]) for low, high in boxes]) for k in (0, 1))
    with np.errstate(all="ignore"):
        found = iv.atan2(y, x)
    jumps = 0
    for (lower, upper), low, high in zip(boxes, *found, strict=True):
        if lower[1] <= 0 and lower[0] <= 0 <= upper[0]:
            # The origin, or the line where the angle jumps from π to −π
            assert -3.1416 < low < -math.pi and math.pi < high < 3.1416
            jumps += 1
            continue
        with mpmath.workdps(40):
            corners = itertools.product((lower[0], upper[0]), (lower[1], upper[1]))
            least, most = hull_of(*(mpmath.atan2(*map(mpmath.mpf, each)) for each in corners))
        assert low <= least and most <= high
        assert least - low < 1e-14 and high - most < 1e-14
    assert 20 < jumps < 100
