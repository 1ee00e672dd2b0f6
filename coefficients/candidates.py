"""The candidates of a search: which forms they are, their names, and the fit of one of them."""

import functools
import hashlib
import itertools
import json
import shlex
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, astuple, dataclass

import jax

from coefficients.catalogue import entries
from coefficients.record import table_of
from coefficients.table import Table, serialise
from fitting import Form, Goal
from fitting.fit import fit
from fitting.linearity import program_of
from quantities import Problem, problem
from quantities.loader import load_problems, option_for


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


@dataclass(frozen=True)
class Task:
    """A candidate to fit in another process.

    `name` is the candidate's (`name_of`), `quantity` that of the quantity, and `files` the problem
    file that declares it, if a user does. `goal` has the fields of the goal, and `lower` the lower
    ends of axes by their names.
    """

    name: str
    quantity: str
    files: tuple[str, ...]
    goal: tuple
    lower: tuple[tuple[str, float], ...]


@dataclass(frozen=True)
class Outcome:
    """The table of a candidate as JSON; or, if it is not `fitted`, why it was refused."""

    fitted: bool
    text: str


def task_of(owner: Problem, name: str, goal: Goal, lower: Mapping[str, float]) -> Task:
    """Return the task to fit a candidate, by its name."""
    files = option_for(owner)[1:]
    return Task(name, owner.name, tuple(files), astuple(goal), tuple(sorted(lower.items())))


def fit_task(task: Task) -> Outcome:
    """Fit a candidate, in a process that may know nothing of the search yet."""
    jax.config.update("jax_enable_x64", True)
    owner, forms = _by_name(task.quantity, task.files, task.goal, task.lower)
    found = fit_candidate(owner, forms[task.name], Goal(*task.goal))
    return Outcome(False, found) if isinstance(found, str) else Outcome(True, serialise(found))


@functools.lru_cache(maxsize=4)
def _by_name(
    quantity: str, files: tuple[str, ...], goal: tuple, lower: tuple[tuple[str, float], ...]
) -> tuple[Problem, dict[str, Form]]:
    """Return a quantity and its candidates by name."""
    for each in files:
        load_problems(each)
    owner = problem(quantity)
    forms = candidates(owner, dict(lower))
    return owner, {name_of(form, Goal(*goal)): form for form in forms}
