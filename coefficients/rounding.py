"""What float32 rounding adds to the errors of exported code: proven and measured."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from coefficients.catalogue import Entry
from coefficients.exported_code import trial_of
from coefficients.table import Table
from coefficients.table_parts import Float32Rounding, RoundingRecord
from fitting.proofs.rounding_error import (
    MAX_BOXES,
    TracedArguments,
    bound_rounding,
    can_be_bounded,
)
from programs.bounding.largest import LargestValue, Report
from programs.bounding.rounding_model import MODELS
from programs.toolchains.difference import difference


@dataclass(frozen=True)
class RoundingBounds:
    """What was found of the rounding error of an entry's code in float32.

    `found` has the bound in each model of `MODELS`, by its name; None where an operation has no
    known error, or the code is too long. `measured` is the largest difference from the float64
    program at fixed points, with every operation rounded to nearest.
    """

    entry: Entry
    found: dict[str, LargestValue | None]
    measured: float

    @property
    def state(self) -> Literal["proven", "not proven"]:
        """Return 'proven' if there is a bound in IEEE arithmetic, else 'not proven'."""
        found = self.found["ieee"]
        return "not proven" if found is None or found.upper is None else "proven"

    @property
    def record(self) -> Float32Rounding:
        """The proven bounds, as tables hold them."""
        return Float32Rounding(
            **{
                name: None
                if found is None or found.upper is None
                else RoundingRecord(upper=found.upper, boxes=found.boxes)
                for name, found in self.found.items()
            }
        )


def arguments_of(entry: Entry) -> TracedArguments | None:
    """Return the arguments of an entry's code for proofs; None if it has none."""
    if entry.fitted is None:
        return entry.exact_code.traced
    return entry.problem.calling.traced_arguments(entry.fitted)


def certify_rounding(
    entry: Entry,
    ratio: float | None = None,
    *,
    models: Sequence[str] = tuple(MODELS),
    threads: int = 2,
    max_boxes: int = MAX_BOXES,
    progress: Report = lambda _: None,
) -> RoundingBounds:
    """Bound what rounding adds to the error of an entry's code in float32.

    Arguments as in `bound_rounding`; `models`, keys of MODELS. The difference is that of the code
    from its own operations without rounding, at the same arguments. Raises ValueError as
    `bound_rounding` does, but not for an operation without a known error.
    """
    arguments, functions = arguments_of(entry), entry.functions("float")
    trial = trial_of(entry, "float")
    measured = difference(trial.emulated(np.float32), trial.form).largest
    found: dict[str, LargestValue | None] = dict.fromkeys(MODELS)
    for name in models:
        if arguments is None or not can_be_bounded(functions, MODELS[name]):
            continue
        found[name] = bound_rounding(
            functions,
            arguments,
            MODELS[name],
            ratio,
            threads=threads,
            max_boxes=max_boxes,
            progress=progress,
        )
    return RoundingBounds(entry, found, measured)


def with_rounding(bounds: RoundingBounds) -> Table:
    """Return the table with its proven bounds of rounding.

    Raises ValueError if nothing is proven, or for a published table, which has no certificates.
    """
    table, name = bounds.entry.require_table(), bounds.entry.name
    if bounds.state != "proven":
        raise ValueError(f"{name}: its rounding in float32 is not proven")
    if table.certificates is None:
        raise ValueError(f"{name} is published: it has no certificates")
    changed = table.certificates.model_copy(update={"float32_rounding": bounds.record})
    return table.model_copy(update={"certificates": changed})
