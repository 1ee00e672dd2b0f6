"""The tables of a quantity beside a LUT of it: what their code costs, and how far they are off."""

from dataclasses import dataclass

import numpy as np

from coefficients.catalogue import Entry, Kind, entries
from coefficients.exported_code import operations_of
from coefficients.lut.texture import Lut
from fitting import Domain, FittedForm, common_domain, form_values, judge
from fitting.points.scattered import judging_points
from integrals.reference import Axis
from quantities import Problem

# A coefficient is a float in a shader.
_COEFFICIENT_BYTES = 4


@dataclass(frozen=True)
class Beside:
    """A table, with the bytes of its coefficients, its operations and its errors.

    The errors are those in the part of the table's domain that the LUT's domain shares. `domain`
    has the ends of the axes of which that part is not the whole; it is empty if all is shared.
    """

    table: str
    kind: Kind
    bytes: int
    operations: int
    rms: float
    largest: float
    domain: dict[str, tuple[float, float]]


def coefficient_bytes(fitted: FittedForm) -> int:
    """Return the bytes of a form's coefficients in a shader."""
    return _COEFFICIENT_BYTES * fitted.form.size


def tables_beside(owner: Problem, domain: Domain) -> list[Beside]:
    """Return the tables of a quantity in order of operations, with their errors in a domain.

    A table that shares nothing with the domain is left out.
    """
    found = [_beside(entry, domain) for entry in entries(owner) if entry.kind != "printed"]
    known = [each for each in found if each is not None]
    return sorted(known, key=lambda each: (each.operations, each.largest))


def difference_from(lut: Lut, fitted: FittedForm, domain: Domain) -> float:
    """Return the largest difference of a LUT from a fitted form, at the points that judge forms."""
    points, _ = judging_points(domain)
    return float(np.max(np.abs(lut(points) - form_values(fitted, points))))


def _beside(entry: Entry, domain: Domain) -> Beside | None:
    fitted = entry.require_fitted()
    try:
        common = common_domain([fitted.form, domain])
    except ValueError:
        return None
    stated = entry.require_table().errors
    if stated is not None and _ends(common.axes) == _ends(fitted.axes):
        rms, largest = stated.off_grid.rms, stated.off_grid.max
    else:
        errors = judge(fitted, common)
        rms, largest = errors.rms, errors.largest
    shared, whole = _ends(common.axes), _ends(domain.axes)
    return Beside(
        entry.name,
        entry.kind,
        coefficient_bytes(fitted),
        operations_of(entry),
        rms,
        largest,
        {name: ends for name, ends in shared.items() if ends != whole[name]},
    )


def _ends(axes: tuple[Axis, ...]) -> dict[str, tuple[float, float]]:
    return {axis.name: (axis.lower, axis.upper) for axis in axes}
