"""Forms as data: what is written, what is refused, and that anyone can evaluate it."""

import json
import math

import numpy as np
import pytest

from coefficients.catalogue import entry_of, names, resolve
from coefficients.expression import form_of, program_from, reference_of
from coefficients.table import parse, serialise

BASE = json.loads(serialise(resolve("best/q-9").require_table()))

# The reader of docs/table-format.md, for the operations that the packaged tables use.
OPERATIONS = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a / b,
    "neg": lambda a: -a,
    "min": min,
    "max": max,
    "abs": abs,
    "sqrt": math.sqrt,
    "rsqrt": lambda a: 1 / math.sqrt(a),
    "exp": math.exp,
    "log": math.log,
    "cos": math.cos,
    "sin": math.sin,
    "le": lambda a, b: a <= b,
    "lt": lambda a, b: a < b,
    "gt": lambda a, b: a > b,
    "ge": lambda a, b: a >= b,
    "eq": lambda a, b: a == b,
    "select": lambda c, a, b: a if c else b,
    "pow": math.pow,
}


def flat(values):
    return [x for each in values for x in (each if isinstance(each, list) else [each])]


def value_of(data: dict, point: dict[str, float]) -> float:
    known = {**{f"c{k}": c for k, c in enumerate(flat(data["coefficients"]))}, **point}
    for k, (operation, *operands) in enumerate(data["expression"]["steps"]):
        known[f"t{k}"] = OPERATIONS[operation](*(known.get(each, each) for each in operands))
    return known[data["expression"]["value"]]


@pytest.mark.parametrize("name", [each for each in names() if not each.endswith("@printed")])
def test_a_packaged_table_can_be_evaluated_without_this_project(name):
    entry = resolve(name)
    fitted = entry.require_fitted()
    data = json.loads(serialise(entry.require_table()))
    for fraction in (0.11, 0.47, 0.83):
        point = {
            axis.name: axis.lower + fraction * (axis.upper - axis.lower) for axis in entry.axes
        }
        expected = float(fitted(*point.values()))
        assert value_of(data, point) == pytest.approx(expected, rel=1e-12, abs=1e-14)


def changed(**expression):
    return {**BASE, "expression": {**BASE["expression"], **expression}}


STEPS = BASE["expression"]["steps"]
WRONG = {
    "an unknown operation": ([["eval", "c0"]], "t0", "operation 'eval' is not known"),
    "a later name": ([["neg", "t1"], ["neg", "c0"]], "t1", "'t1' is no earlier name"),
    "its own name": ([["neg", "t0"]], "t0", "'t0' is no earlier name"),
    "a foreign name": ([["neg", "__import__"]], "t0", "'__import__' is no earlier name"),
    "too few operands": ([["add", "c0"]], "t0", "add cannot take these 1 operands"),
    "too many operands": ([["neg", "c0", "c1"]], "t0", "neg cannot take these 2 operands"),
    "a condition as a number": ([["lt", "c0", "c1"], ["neg", "t0"]], "t1", "neg cannot take"),
    "a number as a condition": ([["select", "c0", "c1", "c2"]], "t0", "select cannot take"),
    "a condition as the value": ([["lt", "c0", "c1"]], "t0", "is no number"),
    "no such value": (STEPS, "t99", "is no number"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_expression_is_refused_in_one_line(case):
    steps, value, message = WRONG[case]
    table = parse(json.dumps(changed(steps=steps, value=value)), "a file")
    with pytest.raises(ValueError, match="q-9: ") as caught:
        program_from(table)
    assert message in str(caught.value)
    assert str(caught.value).isprintable()


@pytest.mark.parametrize(
    "steps",
    [[["neg"]], [["neg", None]], [["neg", True]], [["neg", [1]]], [["neg", "c0"]] * 4097, "t0"],
)
def test_steps_of_another_shape_are_no_table(steps):
    with pytest.raises(ValueError, match="a file: expression") as caught:
        parse(json.dumps(changed(steps=steps)), "a file")
    assert "\n" not in str(caught.value)


def test_an_expression_that_contradicts_its_form_is_refused():
    steps = [list(step) for step in STEPS]
    steps[0] = [steps[0][0], *reversed(steps[0][1:])] if steps[0][0] == "sub" else ["neg", "c0"]
    table = parse(json.dumps(changed(steps=steps)), "a file")
    with pytest.raises(ValueError, match="its expression and its form 'pole-q' give different"):
        entry_of(table, "a file")


def test_a_known_form_may_be_written_with_other_steps():
    twice = [*STEPS, ["neg", BASE["expression"]["value"]], ["neg", f"t{len(STEPS)}"]]
    table = parse(json.dumps(changed(steps=twice, value=f"t{len(STEPS) + 1}")), "a file")
    assert entry_of(table, "a file").problem is resolve("q").problem


def test_a_form_without_steps_may_be_a_constant():
    table = parse(json.dumps(changed(steps=[], value=0.25)), "a file")
    form = form_of(table, resolve("q").problem.reference)
    assert float(form(np.array(BASE["coefficients"]), 0.3)) == 0.25


def test_a_table_of_schema_2_needs_an_expression():
    data = {key: value for key, value in BASE.items() if key != "expression"}
    with pytest.raises(ValueError, match="expression is missing"):
        parse(json.dumps(data), "a file")


@pytest.mark.parametrize("codomain", [[0.0, 2.0], None])
def test_the_reference_of_a_table_has_what_the_table_says_of_its_quantity(codomain):
    about = {"symbol": "S", "definition": "a", "meaning": "b", "function": "F"}
    about |= {"arguments": {"density": "d"}, "codomain": codomain}
    table = parse(json.dumps({**BASE, "about": about}), "itself")
    reference = reference_of(table)
    assert (reference.symbol, reference.definition, reference.meaning) == ("S", "a", "b")
    assert reference.codomain == ((0.0, 2.0) if codomain else (-math.inf, math.inf))
    assert not reference.legs
    silent = reference_of(parse(json.dumps(BASE), "itself"))
    assert (silent.symbol, silent.meaning) == (table.quantity, "")
    assert silent.codomain == (-math.inf, math.inf)
