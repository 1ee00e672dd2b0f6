"""Proofs of largest errors replayed by Arb: other arithmetic, other formulas, other code."""

import json

import numpy as np
import pytest

from coefficients.catalogue import resolve
from coefficients.table import serialise
from programs.bounding.compiled import compiler_missing
from programs.bounding.largest import bound_largest
from quantities.fuzz import r_error
from quantities.fuzz.r_patches import average, patches

flint = pytest.importorskip("flint")
from tests.fitting import arb_exact, arb_jets  # noqa: E402

pytestmark = pytest.mark.skipif(compiler_missing() is not None, reason="no C compiler")

EXACT = {"q": arb_exact.q_exact, "g": arb_exact.g_exact, "velvet": arb_exact.velvet_exact}


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


def bound_of(error: arb_jets.Jet | None) -> float:
    """Return an upper bound of the magnitude of a jet's values; NaN or ∞ if there is none."""
    if error is None:
        return np.inf
    return float(error.value.abs_upper()) * (1 + 1e-15)


@pytest.mark.parametrize(
    ("name", "ratio"),
    [
        ("best/q-9", 1.01),
        *(
            pytest.param(*each, marks=pytest.mark.slow)
            for each in [
                ("velvet", 1.01),
                ("best/q-4", 1.01),
                ("best/q-5", 1.01),
                ("best/q-12", 1.01),
                ("best/q-12-log", 1.01),
                ("g", 1.01),
                ("best/g-9", 1.01),
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


@pytest.mark.slow
@pytest.mark.parametrize("name", ["best/g-13", "best/g-17"])
def test_random_boxes_of_longer_proofs_are_replayed(name):
    table, found, code, leaves = leaves_of(name, 1.02)
    require_cover(code.box, leaves)

    def largest(box):
        x = arb_jets.variables(box)
        return bound_of(arb_jets.formula(table, x) - arb_exact.g_exact(*x))

    for leaf in np.random.default_rng(12).permutation(leaves)[:300]:
        replay(largest, leaf, code.box, found.upper + code.inexact)


@pytest.mark.parametrize(
    ("alpha", "theta_f", "tolerance"),
    [
        (0.95, 1.4, 1e-6),
        *(
            pytest.param(*each, marks=pytest.mark.slow)
            for each in [(0.8, 0.5, 1e-6), (0.8, 1.2, 1e-5), (0.65, 0.2, 1e-5)]
        ),
    ],
)
def test_r_is_where_arb_finds_it(alpha, theta_f, tolerance):
    """Arb's integration bounds the integrand at complex arguments by itself."""
    found = arb_exact.r_exact(alpha, theta_f, tolerance)
    assert found.rad() < 1e-3
    at = (np.array([x, 0, 0, 1.0]) for x in (alpha, theta_f))
    low, high = average(*at, 1e-8)
    assert found.overlaps(arb_jets.between(low, high))
    assert high - low < 3e-8


@pytest.mark.slow
@pytest.mark.parametrize(("name", "count"), [("r", None), ("best/r-45", 2000)])
def test_boxes_of_the_proofs_of_r_are_replayed(name, count):
    table, found, code, leaves = leaves_of(name, 1.02, 1_500_000)
    polynomials = patches(0.15, 1.0, r_error.TOLERANCE)
    matrices = [
        flint.arb_mat(*each.shape, [flint.arb(float(x)) for x in each.ravel()])
        for each in polynomials.powers
    ]

    def error(box):
        exact = arb_exact.r_on_patches(polynomials.places, matrices, box)
        return None if exact is None else arb_jets.formula(table, arb_jets.variables(box)) - exact

    if count is None:
        require_cover(code.box, leaves)
    chosen = np.random.default_rng(13).permutation(leaves)[:count]
    for leaf in chosen:
        replay(lambda box: bound_of(error(box)), leaf, code.box, found.upper)
    at = np.array([[x, x] for x in found.at])
    assert float(error(at).centre.abs_lower()) >= found.lower * (1 - 1e-12)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "count", "part_of_leaf"), [("best/ps-11", 30, 1), ("best/ps-40-wide", 12, 1 / 8)]
)
def test_boxes_of_the_proofs_of_p_s_are_replayed(name, count, part_of_leaf):
    """The proof of small parts of the domain, at random.

    Here the error is the plain difference. For the cubic forms it takes very many boxes, so that
    only a random piece of each box is replayed.
    """
    entry = resolve(name)
    code = entry.problem.code_of_error(entry.require_fitted())
    table = json.loads(serialise(entry.require_table()))
    record, kernel = table["certificates"]["largest_error"], code.kernel()
    rng, replayed = np.random.default_rng(14), 0

    def error(box):
        exact, arguments = arb_exact.ps_exact(*arb_jets.variables(box))
        return arb_jets.formula(table, arguments) - exact

    sides = code.box[:, 1] - code.box[:, 0]
    for _ in range(count):
        low = code.box[:, 0] + rng.uniform(0, 0.98, 4) * sides
        part = np.stack([low, low + 0.02 * sides], axis=1)
        leaves = np.full((100_000, 2, 4), np.nan)
        found = bound_largest(kernel, part, 1.01, claim=record["upper"], threads=1, leaves=leaves)
        assert found.upper <= record["upper"]
        kept = leaves[~np.isnan(leaves[:, 0, 0])]
        for whole in rng.permutation(kept)[:20]:
            size = part_of_leaf * (whole[1] - whole[0])
            corner = whole[0] + rng.uniform(0, 1, 4) * (whole[1] - whole[0] - size)
            leaf = np.stack([corner, corner + size])
            replay(lambda box: bound_of(error(box)), leaf, code.box, record["upper"])
            replayed += 1
    assert replayed >= count
    # The lower bound of the table is attained at one point.
    at = code.from_axes(np.array([[record["at"][axis.name] for axis in entry.axes]]))
    point = np.stack([at[0], at[0]], axis=1)
    assert float(error(point).centre.abs_lower()) >= record["lower"] * (1 - 1e-6)
