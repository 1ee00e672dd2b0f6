"""Forms and exact values in Arb's ball arithmetic, with slopes; no code of the program is used.

A form is read from the steps of its table's `expression`. `arb_exact.py` has the exact values.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from flint import arb, ctx

ctx.prec = 80


class Jet:
    """Values on a box, the value at its centre, and the slopes in each variable.

    `radii` are balls about zero that contain the distances from the centre. Without `slopes`, they
    have no bound.
    """

    __slots__ = ("centre", "radii", "slopes", "value")

    def __init__(self, value, centre, slopes, radii):
        if slopes is not None:
            near = centre
            for slope, radius in zip(slopes, radii, strict=True):
                near = near + slope * radius
            if near.is_finite():
                value = value.intersection(near) if value.is_finite() else near
        self.value, self.centre, self.slopes, self.radii = value, centre, slopes, radii

    def function(self, value, centre, slope) -> "Jet":
        """Return a function of this jet from its values, and its derivative on the box."""
        known = self.slopes is not None and slope.is_finite()
        slopes = [slope * each for each in self.slopes] if known else None
        return Jet(value, centre, slopes, self.radii)

    def _with(self, other, value, centre, by_self, by_other) -> "Jet":
        known = self.slopes is not None and other.slopes is not None
        slopes = None
        if known:
            pairs = zip(self.slopes, other.slopes, strict=True)
            slopes = [by_self * a + by_other * b for a, b in pairs]
        return Jet(value, centre, slopes, self.radii)

    def _lifted(self, other) -> "Jet":
        if isinstance(other, Jet):
            return other
        number = arb(other)
        return Jet(number, number, [arb(0)] * len(self.radii), self.radii)

    def __add__(self, other):
        b = self._lifted(other)
        return self._with(b, self.value + b.value, self.centre + b.centre, 1, 1)

    def __sub__(self, other):
        b = self._lifted(other)
        return self._with(b, self.value - b.value, self.centre - b.centre, 1, -1)

    def __mul__(self, other):
        b = self._lifted(other)
        value = self.value**2 if b is self else self.value * b.value
        return self._with(b, value, self.centre * b.centre, b.value, self.value)

    def __truediv__(self, other):
        b = self._lifted(other)
        value = self.value / b.value
        return self._with(b, value, self.centre / b.centre, 1 / b.value, -value / b.value)

    def __rsub__(self, other):
        return self._lifted(other) - self

    def __rtruediv__(self, other):
        return self._lifted(other) / self

    __radd__, __rmul__ = __add__, __mul__

    def __neg__(self):
        return 0 - self

    def sqrt(self):
        value = rising(arb.sqrt, self.value)
        return self.function(value, self.centre.sqrt(), 1 / (2 * value))

    def exp(self):
        value = rising(arb.exp, self.value)
        return self.function(value, self.centre.exp(), value)

    def log(self):
        return self.function(rising(arb.log, self.value), self.centre.log(), 1 / self.value)

    def cos(self):
        return self.function(self.value.cos(), self.centre.cos(), -self.value.sin())

    def sin(self):
        return self.function(self.value.sin(), self.centre.sin(), self.value.cos())

    def asin(self):
        slope = 1 / (1 - self.value**2).sqrt()
        return self.function(rising(arb.asin, self.value), self.centre.asin(), slope)

    def cut(self, low, high) -> "Jet":
        """Cut the values to bounds that are proven elsewhere."""
        value = self.value.intersection(between(low, high))
        return Jet(value, self.centre, self.slopes, self.radii)


@dataclass(frozen=True)
class Angle:
    """An angle of which the cosine and the sine are known."""

    cosine: object
    sine: object

    def cos(self):
        return self.cosine

    def sin(self):
        return self.sine


def between(low, high) -> arb:
    return arb(low).union(arb(high))


def rising(call: Callable, x: arb) -> arb:
    """Return the values of a monotone function; those at numbers without a value are left out."""
    ends = [call(x.lower()), call(x.upper())]
    if not ends[0].is_finite() and call is arb.sqrt and x.contains(0):
        ends[0] = arb(0)
    return ends[0].union(ends[1])


def larger(a, b):
    if not isinstance(a, Jet):
        a, b = b, a
    b = a._lifted(b)
    if a.value >= b.value:
        return a
    if b.value >= a.value:
        return b
    low = max(a.value.lower(), b.value.lower())
    value = between(low, max(a.value.upper(), b.value.upper()))
    slopes = None
    if a.slopes is not None and b.slopes is not None:
        slopes = [x.union(y) for x, y in zip(a.slopes, b.slopes, strict=True)]
    return Jet(value, a.centre.max(b.centre), slopes, a.radii)


OPERATIONS = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "sqrt": lambda a: a.sqrt(),
    "exp": lambda a: a.exp(),
    "log": lambda a: a.log(),
    "cos": lambda a: a.cos(),
    "sin": lambda a: a.sin(),
    "max": larger,
}


def variables(box) -> list[Jet]:
    """Return a jet for each side of a box (sides, 2)."""
    sides = [(arb(float(low)), arb(float(high))) for low, high in box]
    centres = [((low + high) / 2).mid() for low, high in sides]
    radii = [between(low - c, high - c) for (low, high), c in zip(sides, centres, strict=True)]
    unit = [[arb(int(j == k)) for j in range(len(sides))] for k in range(len(sides))]
    ends = (between(low, high) for low, high in sides)
    return [Jet(v, c, g, radii) for v, c, g in zip(ends, centres, unit, strict=True)]


def formula(table, arguments: Sequence):
    """Evaluate the expression of a table; an argument is a number, a jet or an `Angle`."""
    known = {each["name"]: x for each, x in zip(table["arguments"], arguments, strict=True)}
    known |= {f"c{k}": arb(c) for k, c in enumerate(table["coefficients"])}
    for k, (operation, *operands) in enumerate(table["expression"]["steps"]):
        values = [known[x] if isinstance(x, str) else arb(x) for x in operands]
        known[f"t{k}"] = OPERATIONS[operation](*values)
    return known[table["expression"]["value"]]
