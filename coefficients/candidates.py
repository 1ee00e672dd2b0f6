"""The candidates of a search: which forms they are, their names, and the fit of one of them."""

import hashlib
import itertools
import json
import shlex
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict

from coefficients.catalogue import entries
from coefficients.record import table_of
from coefficients.table import Table
from fitting import Form, Goal
from fitting.fit import fit
from fitting.linearity import program_of
from quantities import Problem
from quantities.loader import option_for


def candidates(owner: Problem, lower: Mapping[str, float]) -> Iterator[Form]:
    """Yield the forms that a search tries; those of best tables first if `owner.searches_best`.

    `lower` maps the names of axes to the lower ends of their domains.
    """
    tried = owner.tried(lower)
    if not owner.searches_best:
        return tried
    known = [e.require_fitted().form for e in entries(owner) if e.kind == "best"]
    same = [
        form
        for form in known
        if all(axis.lower == lower.get(axis.name, axis.lower) for axis in form.axes)
    ]
    return itertools.chain(same, tried)


def name_of(form: Form, goal: Goal) -> str:
    """Return a candidate's name: its family and a digest of its shape and goal."""
    # A form without a shape is told by what it computes: a user may change it under its name.
    shape = repr(program_of(form).steps) if form.shape is None else form.shape
    text = json.dumps([shape, asdict(goal)], sort_keys=True)
    return f"{form.name}-{hashlib.sha256(text.encode()).hexdigest()[:10]}"


def fit_candidate(
    owner: Problem, form: Form, goal: Goal, tell: Callable[[str], None] = lambda _: None
) -> Table | str:
    """Fit a candidate. Returns its table, or why the fit was refused. `tell` takes each step."""
    try:
        made = fit(form, goal, progress=tell)
    except ValueError as error:
        return str(error)
    command = shlex.join(["shadefit", "search", *option_for(owner), owner.name])
    return table_of(made, command, name_of(form, goal))
