"""Whether the errors that tables in files state are those of their coefficients.

A file may have been changed: new coefficients with the old errors, or errors that nobody measured.
The largest error is compared with the errors at a few hundred points. They show any change of
the coefficients that matters, but not that the stated error is the largest on the whole domain:
that is what `shadefit certify` proves.
"""

from collections.abc import Sequence

import numpy as np

from coefficients.catalogue import Entry
from coefficients.table import Table
from fitting import FittedForm, form_values
from fitting.points.grids import sobol_points
from integrals.reference import Reference

EXPONENT, SEED = 8, 20200717
# At the place that a table states, its error is the stated one but for rounding and the error of
# the exact value.
_SAME = 1e-6
# The largest error was sought at many points. It may be missed by less than this.
_MISSED = 0.05
# That of the sample differs from the stated rms error by up to a fifth for packaged tables. It may
# differ by more, if a table's errors are large in a small part of the domain.
_RMS_MISSED = 10
_ROUNDING = 1e-12


def misstatements(
    reference: Reference, tables: Sequence[tuple[FittedForm, Table]]
) -> list[str | None]:
    """Return for each table what is wrong with the largest error that it states, or None.

    The tables must have one domain. Nothing is known, and so nothing wrong, of a table that states
    no error, or if there are no exact values but data.
    """
    if not tables or not reference.legs or reference.data is not None:
        return [None] * len(tables)
    fitted, _ = tables[0]
    stated = [None if table.errors is None else table.errors.off_grid for _, table in tables]
    names = [axis.name for axis in fitted.axes]
    places = [[each.where[name] for name in names] for each in stated if each is not None]
    sample = sobol_points(fitted.axes, EXPONENT, SEED)
    points = np.concatenate([sample, np.reshape(places, (-1, len(names)))])
    exact = reference.estimates(points)
    values, errors = np.asarray(exact.value), np.asarray(exact.error)
    own = iter(range(len(sample), len(points)))
    found: list[str | None] = []
    for (each, table), record in zip(tables, stated, strict=True):
        if record is None:
            found.append(None)
            continue
        chosen = np.append(np.arange(len(sample)), next(own))
        apart = np.abs(form_values(each, points[chosen]) - values[chosen])
        room = errors[chosen] + _ROUNDING
        there, sampled = apart[-1], (apart - room)[:-1].max()
        bound = table.certificates.largest_error if table.certificates else None
        rms = np.sqrt(np.mean(np.maximum(apart - room, 0)[:-1] ** 2))
        if not abs(there - record.max) <= _SAME * record.max + room[-1]:
            found.append(f"the error at its place is {there:.4g}")
        elif not sampled <= (1 + _MISSED) * record.max:
            found.append(f"there is one of {sampled:.4g}")
        elif not rms <= _RMS_MISSED * record.rms:
            found.append(f"its rms error of {record.rms:.4g} is at least {rms:.4g}")
        elif bound is not None and not there <= bound.upper + room[-1]:
            found.append(f"its bound is {bound.upper:.4g}")
        else:
            found.append(None)
    return found


def require_stated(entry: Entry) -> None:
    """Raise ValueError if a table in a file states a largest error that is not its own."""
    if entry.kind != "file" or entry.fitted is None or entry.table is None:
        return
    (wrong,) = misstatements(entry.problem.reference, [(entry.fitted, entry.table)])
    if wrong is not None and entry.table.errors is not None:
        raise ValueError(
            f"{entry.name} states a largest error of {entry.table.errors.off_grid.max:.4g}, but "
            f"{wrong}: its coefficients or its errors were changed"
        )
