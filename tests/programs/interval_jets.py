"""Bounds of a program by mpmath's interval arithmetic, which shares no code with the kernel's."""

from dataclasses import dataclass

import mpmath

from programs.program import Program, interpret

IV = mpmath.iv


@dataclass(frozen=True)
class Jet:
    """An interval, the value at the centre of the box, and the interval of each derivative."""

    value: object
    centre: object
    gradient: tuple
    radii: tuple

    def tightened(self) -> "Jet":
        """Cut the value to the mean value form."""
        other = self.centre
        for slope, radius in zip(self.gradient, self.radii, strict=True):
            other = other + slope * IV.mpf([-radius, radius])
        low, high = max(self.value.a, other.a), min(self.value.b, other.b)
        return Jet(IV.mpf([low, high]), self.centre, self.gradient, self.radii)

    def chain(self, value, centre, slope) -> "Jet":
        gradient = tuple(slope * g for g in self.gradient)
        return Jet(value, centre, gradient, self.radii).tightened()


def _combined(a: Jet, b: Jet, value, centre, slopes) -> Jet:
    gradient = tuple(
        slopes[0] * g + slopes[1] * h for g, h in zip(a.gradient, b.gradient, strict=True)
    )
    return Jet(value, centre, gradient, a.radii).tightened()


def _divide(a: Jet, b: Jet) -> Jet:
    slopes = 1 / b.value, -a.value / b.value**2
    return _combined(a, b, a.value / b.value, a.centre / b.centre, slopes)


def _larger(a: Jet, b: Jet) -> Jet:
    if a.value.a >= b.value.b:
        return a
    if b.value.a >= a.value.b:
        return b
    united = tuple(
        IV.mpf([min(g.a, h.a), max(g.b, h.b)]) for g, h in zip(a.gradient, b.gradient, strict=True)
    )
    value = IV.mpf([max(a.value.a, b.value.a), max(a.value.b, b.value.b)])
    centre = IV.mpf([max(a.centre.a, b.centre.a), max(a.centre.b, b.centre.b)])
    return Jet(value, centre, united, a.radii).tightened()


def _negative(a: Jet) -> Jet:
    return a.chain(-a.value, -a.centre, IV.mpf(-1))


def _product(a: Jet, b: Jet) -> Jet:
    value = a.value**2 if a is b else a.value * b.value
    return _combined(a, b, value, a.centre * b.centre, (b.value, a.value))


def _sum(sign: int):
    def combine(a: Jet, b: Jet) -> Jet:
        value, centre = a.value + sign * b.value, a.centre + sign * b.centre
        return _combined(a, b, value, centre, (IV.mpf(1), IV.mpf(sign)))

    return combine


OPERATIONS = {
    "add": _sum(1),
    "sub": _sum(-1),
    "mul": _product,
    "div": _divide,
    "neg": _negative,
    "exp": lambda a: a.chain(IV.exp(a.value), IV.exp(a.centre), IV.exp(a.value)),
    "log": lambda a: a.chain(IV.log(a.value), IV.log(a.centre), 1 / a.value),
    "sqrt": lambda a: a.chain(
        IV.sqrt(a.value), IV.sqrt(a.centre), 1 / (IV.sqrt(a.value) + IV.sqrt(a.centre))
    ),
    "max": _larger,
    "min": lambda a, b: _negative(_larger(_negative(a), _negative(b))),
}


def variables(box) -> list[Jet]:
    """Return a jet for each side of a box (sides, 2)."""
    sides = [(IV.mpf(float(low)), IV.mpf(float(high))) for low, high in box]
    centres = [IV.mpf(((low + high) / 2).mid) for low, high in sides]
    radii = tuple(
        max((high - c).b, (c - low).b) for (low, high), c in zip(sides, centres, strict=True)
    )
    unit = [tuple(IV.mpf(int(j == k)) for j in range(len(sides))) for k in range(len(sides))]
    return [
        Jet(IV.mpf([low.a, high.b]), c, g, radii)
        for (low, high), c, g in zip(sides, centres, unit, strict=True)
    ]


def evaluated(program: Program, inputs: list[Jet]) -> tuple[Jet, ...]:
    """Evaluate a program with jets."""
    like = inputs[0]
    zeros = tuple(IV.mpf(0) for _ in like.radii)

    def constant(x: float) -> Jet:
        return Jet(IV.mpf(x), IV.mpf(x), zeros, like.radii)

    return interpret(program, inputs, OPERATIONS, constant)


def bounds(program: Program, box) -> tuple[float, float]:
    """Bound the only output of a program on a box (inputs, 2) of numbers."""
    (found,) = evaluated(program, variables(box))
    return float(found.value.a), float(found.value.b)
