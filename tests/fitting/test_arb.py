"""Proofs of largest errors replayed by Arb: other arithmetic, other formulas, other code."""

import json

import numpy as np
import pytest

from coefficients.catalogue import resolve
from coefficients.table import serialise
from programs.bounding.compiled import compiler_missing
from programs.bounding.largest import bound_largest

flint = pytest.importorskip("flint")
from tests.fitting import arb_jets  # noqa: E402

pytestmark = pytest.mark.skipif(compiler_missing() is not None, reason="no C compiler")

EXACT = {"q": arb_jets.q_exact, "g": arb_jets.g_exact, "velvet": arb_jets.velvet_exact}


def leaves_of(name: str, ratio: float, capacity: int = 400_000):
    """Prove a table's largest error; return its data, the bounds, the code, the proof's boxes."""
    entry = resolve(name)
    fitted = entry.require_fitted()
    code = entry.problem.code_of_error(fitted)
    table = json.loads(serialise(entry.require_table()))
    leaves = np.full((capacity, 2, len(code.box)), np.nan)
    worst = table["errors"]["off_grid"]["where"]
    seeds = code.from_axes(np.array([[worst[axis.name] for axis in fitted.axes]]))
    found = bound_largest(code.kernel(), code.box, ratio, seeds=seeds, threads=1, leaves=leaves)
    assert found.upper is not None
    kept = leaves[~np.isnan(leaves[:, 0, 0])]
    assert len(kept) < capacity
    return table, found, code, kept


def require_cover(box: np.ndarray, leaves: np.ndarray) -> None:
    """Check that boxes fill a box: their volumes add up, and the centre of each is in no other."""
    sides = (leaves[:, 1] - leaves[:, 0]) / (box[:, 1] - box[:, 0])
    assert np.prod(sides, axis=1).sum() == pytest.approx(1, abs=1e-9)
    assert np.all(leaves[:, 0] >= box[:, 0]) and np.all(leaves[:, 1] <= box[:, 1])
    centres = leaves.mean(axis=1)
    for point in centres[:: max(len(centres) // 300, 1)]:
        inside = (leaves[:, 0] <= point) & (point <= leaves[:, 1])
        assert np.all(inside, axis=1).sum() == 1


def replay(largest, leaf: np.ndarray, whole: np.ndarray, upper: float, left: int = 4000) -> int:
    """Show that |error| ≤ upper on a box (2, sides). Return the number of boxes that this took.

    `largest` bounds |error| on a box. The kernel's slopes are tighter than derivatives are, so that
    a box may have to be divided.
    """
    stack, count = [leaf.T], 0
    while stack:
        box = stack.pop()
        count += 1
        if not largest(box) <= upper:
            assert count < left, f"no bound near {box.mean(axis=1)}"
            side = np.argmax((box[:, 1] - box[:, 0]) / (whole[:, 1] - whole[:, 0]))
            first, second = box.copy(), box.copy()
            first[side, 1] = second[side, 0] = box[side].mean()
            stack += [first, second]
    return count


def bound_of(error) -> float:
    """Return an upper bound of the magnitude of a jet's values; NaN or ∞ if there is none."""
    return float(error.value.abs_upper()) * (1 + 1e-15)


@pytest.mark.parametrize(
    ("name", "ratio"),
    [
        ("best/q-9", 1.01),
        ("velvet", 1.01),
        *(
            pytest.param(*each, marks=pytest.mark.slow)
            for each in [
                ("best/q-4", 1.01),
                ("best/q-5", 1.01),
                ("best/q-12", 1.01),
                ("best/q-12-log", 1.01),
                ("g", 1.01),
                ("best/g-9", 1.01),
                ("best/g-19", 1.05),
            ]
        ),
    ],
)
def test_each_box_of_a_proof_is_replayed(name, ratio):
    table, found, code, leaves = leaves_of(name, ratio)
    require_cover(code.box, leaves)
    exact, inexact = EXACT[table["quantity"]], code.inexact

    def error(box):
        x = arb_jets.variables(box)
        return arb_jets.formula(table, x) - exact(*x)

    for leaf in leaves:
        replay(lambda box: bound_of(error(box)), leaf, code.box, found.upper + inexact)
    # The lower bound is attained at one point.
    at = np.array([[x, x] for x in found.at])
    assert float(error(at).centre.abs_lower()) >= found.lower - inexact
