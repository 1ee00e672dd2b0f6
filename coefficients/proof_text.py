"""Proofs about a table as text: what is proven on its whole domain."""

import math

from coefficients.catalogue import Entry
from coefficients.table_parts import Certificates, Float32Rounding
from fitting import FittedForm
from fitting.fit import ENOUGH
from fitting.proofs.pole_proof import certify_denominators
from fitting.proofs.range_proof import certify_range
from programs.bounding.rounding_model import MODELS
from programs.rounded_text import rounded_down, rounded_up

# The ends of a range are written with four decimals.
_DIGITS = 1e4
_ROUNDING = 1e-11


def proofs(entry: Entry) -> list[str]:
    """Return texts that say what is proven about a table.

    The certificates of packaged tables are trusted. Those in a user's file are not: the proofs are
    made again.
    """
    table = entry.require_table()
    if entry.kind != "file":
        return proof_text(table.certificates)
    found = certified(entry.require_fitted(), table.certificates)
    return proof_text(found) if found else ["nothing: a denominator may vanish"]


def certified(fitted: FittedForm, stated: Certificates | None) -> Certificates | None:
    """Prove again what can be proven about a form; None if denominators are not proven positive.

    The bound of the denominators is improved until it reaches the one that is `stated`.
    """
    enough = stated.denominator_bound if stated is not None else None
    found = certify_denominators(fitted, enough or ENOUGH)
    if not found.holds:
        return None
    values, below = certify_range(fitted), fitted.form.proofs.below
    room = -math.inf if below is None else below(fitted)
    return Certificates(
        denominator_bound=found.bound if math.isfinite(found.bound) else None,
        boxes=found.boxes,
        range=None if values is None else [values.lower, values.upper],
        conservative_bound=room if math.isfinite(room) else None,
    )


def proof_text(certificates: Certificates | None) -> list[str]:
    """Return a text for each thing that certificates prove, with numbers on the safe side."""
    if certificates is None:
        return []
    bound, values = certificates.denominator_bound, certificates.range
    found = ["no denominator" if bound is None else f"denominators ≥ {rounded_down(bound, 3)}"]
    if values is not None:
        # A bound just outside of [0, 1] is so by the rounding of the proof.
        low, high = (round(end) if abs(end - round(end)) <= _ROUNDING else end for end in values)
        low, high = math.floor(low * _DIGITS) / _DIGITS, math.ceil(high * _DIGITS) / _DIGITS
        found.append(f"values in [{low:g}, {high:g}]")
    if (certificates.conservative_bound or 0) > 0:
        found.append("none above the exact value")
    if certificates.largest_error is not None:
        found.append(f"errors ≤ {rounded_up(certificates.largest_error.upper, 4)}")
    if certificates.least_error is not None:
        least = rounded_down(certificates.least_error, 3)
        found.append(f"no coefficients have a largest error below {least}")
    return found


def rounding_text(entry: Entry, measured: float, points: int) -> str:
    """Say what rounding to float32 adds to errors: what is proven, and what was measured."""
    certificates = None if entry.table is None else entry.table.certificates
    known = None if certificates is None else certificates.float32_rounding
    said = [] if entry.kind == "file" or known is None else _proven_rounding(known)
    proven = f"proven: {', '.join(said)} more error; " if said else ""
    return f"{proven}measured: at most {rounded_up(measured, 2)} more error at {points} points"


def _proven_rounding(known: Float32Rounding) -> list[str]:
    return [
        f"at most {rounded_up(record.upper, 2)} ({model.arithmetic})"
        for name, model in MODELS.items()
        if (record := getattr(known, name)) is not None
    ]
