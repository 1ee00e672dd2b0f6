"""The largest errors of tables as theorems: proven where the exact value has a closed form."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from coefficients.catalogue import Entry, entries, resolve
from coefficients.table import Table
from coefficients.table_parts import Certificates, LargestErrorRecord
from fitting import form_values
from fitting.proofs.largest_error import LargestError, certify_largest_error
from programs.bounding.largest import Report

# The bound of an error and the largest error found are at most this far apart.
RATIO = 1.01
# A stated error comes from a search by random steps. It is understated if an error is found that is
# larger by more than this part.
UNDERSTATED = 1e-3


State = Literal["proven", "refuted", "not proven", "sampled"]


@dataclass(frozen=True)
class Certification:
    """What was found of a table's largest error.

    `found` is None if there is no closed form to prove it against: then the largest error is only
    `sampled`.
    """

    entry: Entry
    found: LargestError | None

    @property
    def stated(self) -> float | None:
        """Return the largest error that the table states, if it states one."""
        errors = self.entry.require_table().errors
        return None if errors is None else errors.off_grid.max

    @property
    def state(self) -> State:
        """Return 'proven', 'refuted' (with a point above the claim), 'not proven' or 'sampled'."""
        if self.found is None:
            return "sampled"
        if self.found.upper is not None:
            return "proven"
        return "refuted" if self.found.refuted else "not proven"

    @property
    def understated(self) -> bool:
        """Whether an error was found that is clearly above the stated one, or above its bound."""
        if self.found is None:
            return False
        certificates = self.entry.require_table().certificates
        bound = certificates.largest_error if certificates else None
        limits = [] if self.stated is None else [self.stated * (1 + UNDERSTATED)]
        limits += [] if bound is None else [bound.upper]
        return any(self.found.lower > limit for limit in limits)


def chosen(names: list[str], closed_forms: bool = False) -> list[Entry]:
    """Return the entries of names; 'all' stands for the packaged refitted and best tables.

    Raises ValueError for a name that is not known, and for a closed form, which has no error,
    unless `closed_forms` are allowed.
    """
    found = []
    for name in names:
        if name == "all":
            found += [entry for entry in entries() if entry.kind in ("refitted", "best")]
        else:
            found.append(resolve(name))
    for entry in [] if closed_forms else found:
        entry.require_fitted()
    return found


def certify(
    entry: Entry,
    ratio: float = RATIO,
    *,
    claim: float | None = None,
    threads: int = 2,
    progress: Report = lambda _: None,
) -> Certification:
    """Bound the largest error of a table on its whole domain.

    Arguments: `ratio`, the largest quotient of the bound and of the largest error found; `claim`, a
    bound to prove or refute instead; `threads`; `progress`, called several times a second. Raises
    ValueError for a ratio that is not above 1, and if the closed form cannot be bounded.
    """
    fitted = entry.require_fitted()
    code = entry.problem.code_of_error(fitted)
    if code is None:
        return Certification(entry, None)
    found = certify_largest_error(
        fitted, code, ratio, _seeds(entry), claim=claim, threads=threads, progress=progress
    )
    return Certification(entry, found)


def _seeds(entry: Entry) -> np.ndarray:
    """Return the places of the table's own largest errors, or else the middle of its domain."""
    table, names = entry.require_table(), [axis.name for axis in entry.axes]
    if table.errors is None:
        return np.array([[(axis.lower + axis.upper) / 2 for axis in entry.axes]])
    records = table.errors.off_grid, table.errors.on_grid
    return np.array([[each.where[name] for name in names] for each in records])


def with_largest_error(certification: Certification) -> Table:
    """Return the table with its proven largest error.

    If the proof found a larger error than the one that the table states, the table states it now,
    as it is measured: `lower` is less by the bound of what the proof leaves out.
    Raises ValueError if it is not proven, or for a published table, which has no certificates.
    """
    found, table = certification.found, certification.entry.require_table()
    if found is None or found.upper is None:
        raise ValueError(f"{certification.entry.name}: its largest error is not proven")
    if table.certificates is None:
        raise ValueError(f"{certification.entry.name} is published: it has no certificates")
    record = LargestErrorRecord(
        lower=found.lower, at=found.at, upper=found.upper, boxes=found.boxes
    )
    certificates: Certificates = table.certificates.model_copy(update={"largest_error": record})
    errors = table.errors
    if errors is not None and found.lower > errors.off_grid.max:
        largest = _measured(certification.entry, found.at)
        worst = errors.off_grid.model_copy(update={"max": largest, "where": found.at})
        errors = errors.model_copy(update={"off_grid": worst})
    return table.model_copy(update={"certificates": certificates, "errors": errors})


def _measured(entry: Entry, at: dict[str, float]) -> float:
    """Return the magnitude of a form's error at a point, by the reference."""
    # A reference may choose its rule by the least values of all points: it is that of the domain.
    points = np.array([[axis.lower for axis in entry.axes], [at[axis.name] for axis in entry.axes]])
    exact = entry.problem.reference.values(points)[1]
    return float(abs(form_values(entry.require_fitted(), points)[1] - exact))
