"""Quantities by name, as problems: what is known of each, and what is refused."""

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

import integrals
from fitting import Form, Stage
from integrals import REFERENCES, Axis, Estimate, Reference, Sampling
from quantities import Problem, problem, problems, register
from quantities.calling_convention import Argument, CallingConvention
from quantities.registry import unregister

AXIS = Axis("x", 0.0, 1.0, meaning="an argument")
TWICE = Reference(
    name="twice",
    symbol="2x",
    meaning="twice the argument",
    definition="2x",
    axes=(AXIS,),
    sampling=Sampling(fitted=4, checked=4, judged=5),
    closed_form=lambda x: Estimate(2 * x, jnp.zeros(())),
)
LINE = Form(
    name="line",
    equation="c x",
    reference=TWICE,
    axes=(AXIS,),
    coefficient_names=["c"],
    stages=(Stage(lambda c, x: jnp.asarray(c[0] * x)),),
)


def twice() -> Problem:
    calling = CallingConvention("Twice", "2x ({equation}).", (Argument("x", "x"),))
    return Problem(reference=TWICE, forms=(LINE,), calling=calling)


@pytest.fixture
def registered():
    """Register a quantity for one test."""
    yield register(twice())
    unregister("twice")


def one_line(caught) -> str:
    assert type(caught.value) is ValueError
    assert str(caught.value).isprintable()
    return str(caught.value)


GGX = ["ggx-directional-albedo", "ggx-scale", "ggx-bias", "ggx-average-albedo"]
MAPS = ["sggx-filter", "sggx-filter-axes"]
CHANNELS = ("red", "green", "blue")
SKIN = [f"skin-{s}-{c}" for s in ("cylinder", "sphere") for c in CHANNELS]
SKIN += ["skin-lobe-cylinder", "skin-lobe-sphere"]
SKIN += [f"skin-band-{band}-{c}" for band in (1, 2) for c in CHANNELS]


def test_the_quantities_are_known_in_their_order():
    assert (
        list(problems()) == list(REFERENCES) == ["ps", "g", "q", "r", "velvet", *GGX, *MAPS, *SKIN]
    )
    for name, each in problems().items():
        assert problem(name) is each
        assert each.name == name
        assert each.reference is REFERENCES[name]
        assert (each.symbol, each.axes) == (each.reference.symbol, each.reference.axes)
        assert each.description == f"{each.symbol}, {each.reference.meaning}"


@pytest.mark.parametrize("name", ["s", "", "all", "PS", "rational-ps"])
def test_an_unknown_quantity_is_refused_in_one_line(name):
    with pytest.raises(ValueError) as caught:
        problem(name)
    every = ", ".join(["ps, g, q, r, velvet", *GGX, *MAPS, *SKIN])
    assert one_line(caught) == f"no quantity is called {name!r}: allowed are {every}"


def test_a_quantity_comes_in_by_its_name_and_goes_again(registered):
    assert problem("twice") is registered
    assert list(problems())[-1] == "twice"
    # To register it again changes nothing.
    assert register(registered) is registered
    unregister("twice")
    assert "twice" not in problems()
    unregister("twice")


def test_a_second_quantity_of_the_same_name_is_refused(registered):
    with pytest.raises(ValueError) as caught:
        register(twice())
    assert one_line(caught) == "a quantity is called 'twice' already: allowed is another name"
    assert problem("twice") is registered
    with pytest.raises(ValueError, match="called 'ps' already"):
        register(replace(problem("ps")))


def test_the_listed_quantities_cannot_be_changed_from_outside():
    problems().clear()
    assert problems()


@pytest.mark.parametrize("name", problems())
def test_the_default_form_is_found_by_its_name(name):
    owner = problem(name)
    assert owner.find_form(owner.default.name, None) is owner.default
    assert next(iter(owner.single_forms)) == owner.default.name


@pytest.mark.parametrize(
    ("quantity", "form", "allowed"),
    [
        ("g", "rational-x", "rational-g, decay-g, tied-g"),
        ("q", "rational-g", "quadratic-q, pole-q"),
        ("velvet", "", "conservative-norm"),
        ("ps", "RATIONAL-PS", "rational-ps, one-root-ps, two-root-ps, cubic-ps"),
    ],
)
def test_an_unknown_form_is_refused_in_one_line(quantity, form, allowed):
    for shape in (None, {}, {"terms": 1}):
        with pytest.raises(ValueError) as caught:
            problem(quantity).find_form(form, shape)
        assert one_line(caught) == f"form {form!r} is not known: allowed are {allowed}"


def test_a_single_form_has_no_shape_and_a_family_needs_one():
    with pytest.raises(ValueError, match="form 'rational-g' is not known"):
        problem("g").find_form("rational-g", {"poles": 1})
    with pytest.raises(ValueError, match=r"shape of 'tied-g' has \[\]: allowed are"):
        problem("g").find_form("tied-g", None)


def test_further_forms_are_found_beside_the_default_one():
    steep = replace(LINE, name="steep")
    own = replace(twice(), forms=(LINE, steep))
    assert own.find_form("steep", None) is steep
    assert list(own.single_forms) == ["line", "steep"]
    with pytest.raises(ValueError, match=r"allowed are line, steep$"):
        own.find_form("curve", None)


# What each problem declares


@pytest.mark.parametrize("name", problems())
def test_arguments_and_plot_hints_are_about_the_axes(name):
    owner = problem(name)
    axes = {axis.name: axis for axis in owner.axes}
    shared = owner.default.shared or len(axes)
    first = [axis.name for axis in owner.axes[:shared]]
    assert sorted(each.axis for each in owner.calling.arguments) == sorted(first)
    assert set(owner.plot.axes) == set(axes)
    for key, hint in owner.plot.axes.items():
        assert hint.lower <= hint.start <= hint.upper
        assert hint.lower > 0 or not hint.logarithmic
        assert axes[key].contains(hint.start)


@pytest.mark.parametrize("name", [n for n, each in problems().items() if each.exact_code])
def test_exact_code_is_of_the_closed_form(name):
    from programs import evaluate, trace  # noqa: PLC0415

    owner = problem(name)
    lower, upper = (
        np.array([getattr(a, e) for a in owner.exact_code.axes]) for e in ("lower", "upper")
    )
    points = lower + (upper - lower) * np.random.default_rng(1).random((50, len(lower)))
    (function,) = owner.exact_code.functions("double")
    (columns,) = owner.exact_code.arguments_at(points)
    exact = owner.reference.values(points)
    np.testing.assert_allclose(evaluate(trace(function), columns)[:, 0], exact, atol=1e-12)
    at = [float(owner.closed_form(*point)) for point in points[:5]]
    np.testing.assert_allclose(at, exact[:5], atol=1e-12)
    assert owner.exact_code.equation.startswith("closed form")


def test_quantities_with_a_closed_form_can_be_exported():
    assert [n for n, each in problems().items() if each.exact_code] == ["ps", "g", "q", "velvet"]
    assert integrals.R.closed_form is None
