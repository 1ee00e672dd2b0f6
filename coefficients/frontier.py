"""What an evaluation costs against how wrong it is: for every table, and for the closed form."""

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
    """One way to evaluate a quantity: what it is, operations, largest and rms error."""

    name: str
    kind: str
    operations: int
    largest: float
    rms: float


@lru_cache(maxsize=8)
def marks(owner: Problem) -> tuple[Mark, ...]:
    """Return a mark for every table of a quantity, and for its closed form if there is one.

    A table's errors are those of its float64 form, on the judging points of the published one, or
    where nothing is published those that the table states; the closed form has only those of
    float32, in which it is evaluated on the same points. Operations are those of the last exported
    function: for P_s what a direction costs once the material is known.
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


def closed_form(owner: Problem) -> list[Mark]:
    """Return the mark of the closed form, evaluated in float32, if there is such a form."""
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
    """Return those that no other one beats in both operations and largest error, by cost.

    Each has a `name`, `operations` and the `largest` error.
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
