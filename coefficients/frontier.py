"""The cost and the error of every table of a quantity, and of its closed form."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from coefficients.catalogue import EXACT, Entry, entries, published, resolve
from coefficients.compare import compare
from coefficients.exported_code import operations_of, programs_of
from fitting.points.scattered import judging_points
from programs import count_operations, evaluate
from quantities import Problem


@dataclass(frozen=True)
class Mark:
    """One way to evaluate a quantity: its operations, its largest error and its rms error.

    `name` and `kind` are those of the table's entry; for the closed form they are 'closed form' and
    'exact'.
    """

    name: str
    kind: str
    operations: int
    largest: float
    rms: float


@lru_cache(maxsize=8)
def marks(owner: Problem) -> tuple[Mark, ...]:
    """Return a mark for every table of a quantity, and one for its closed form if there is one.

    If the quantity has a published table, the errors are those of float64 in the common part of all
    domains; otherwise they are those that each table states. For the closed form see `closed_form`.
    Operations are those of the last exported function (`operations_of`); for P_s they are the cost
    of a direction once the material is known.
    """
    reference = published(owner)
    if reference is None:
        return tuple(_as_stated(each) for each in entries(owner) if each.require_table().errors)
    others = [each for each in entries(owner) if each.name != reference.name]
    every = [reference, *others]
    compared = compare([(each.name, each) for each in every]).contestants
    found = [
        Mark(each.name, each.kind, operations_of(each), of.errors.largest, of.errors.rms)
        for each, of in zip(every, compared, strict=True)
    ]
    return (*found, *closed_form(owner))


def mark_of(entry: Entry) -> Mark:
    """Measure the mark of a table that is not packaged, such as one in a user's file.

    If its quantity has a published table, the errors are those in the common part of both domains.
    """
    base = published(entry.problem)
    every = [each for each in (base, entry) if each is not None]
    errors = compare([(each.name, each) for each in every]).contestants[-1].errors
    return Mark(entry.name, entry.kind, operations_of(entry), errors.largest, errors.rms)


def closed_form(owner: Problem) -> list[Mark]:
    """Return a list with the mark of the closed form; it is empty if there is none.

    In float64 the closed form has no error but rounding. It is therefore evaluated in float32, at
    the points that judge the published table. The list is also empty without a published table.
    """
    reference = published(owner)
    if owner.exact_code is None or reference is None:
        return []
    exact = resolve(f"{EXACT}/{owner.name}")
    (program,) = programs_of(exact, "float")
    points, truth = judging_points(reference.require_fitted().form)
    (rows,) = exact.arguments_at(points)
    values = evaluate(program, rows.astype(np.float32), np.float32)[:, 0]
    error = np.abs(values - truth)
    rms, operations = float(np.sqrt(np.mean(error**2))), count_operations(program).operations
    return [Mark("closed form", "exact", operations, float(error.max()), rms)]


def best_so_far(every: Iterable[Any]) -> list[Any]:
    """Return the elements on the frontier of operations against error, in order of operations.

    An element has a `name`, `operations` and the `largest` error. It is left out if another has at
    most as many operations and at most as large an error; of two equal ones, the first by name
    stays.
    """
    best: list[Any] = []
    for mark in sorted(every, key=lambda mark: (mark.operations, mark.largest, mark.name)):
        if not best or mark.largest < best[-1].largest:
            best.append(mark)
    return best


def _as_stated(entry: Entry) -> Mark:
    errors = entry.require_table().errors
    assert errors is not None
    own = errors.off_grid
    return Mark(entry.name, entry.kind, operations_of(entry), own.max, own.rms)
