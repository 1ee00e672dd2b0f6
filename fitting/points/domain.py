"""Domains in which forms are judged: of one form, or the common part of several."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from fitting.form import Form
from integrals.reference import Axis, Reference


@dataclass(frozen=True)
class Domain:
    """The exact values of a quantity, with its axes restricted to the part that is judged."""

    reference: Reference
    axes: tuple[Axis, ...]


def common_domain(forms: Sequence[Form | Domain]) -> Domain:
    """Return the part of the axes that all forms or domains of one quantity have in common.

    Raises ValueError if there is no common part.
    """
    sides = zip(*(form.axes for form in forms), strict=True)
    return Domain(forms[0].reference, tuple(map(_common, sides)))


def _common(axes: tuple[Axis, ...]) -> Axis:
    highest = max(axes, key=lambda axis: (axis.lower, axis.open_below))
    upper = min(axis.upper for axis in axes)
    if not highest.lower < upper:
        domains = " and ".join(dict.fromkeys(axis.domain for axis in axes))
        raise ValueError(f"domains of {highest.name} have nothing in common: {domains}")
    return replace(highest, upper=upper)
