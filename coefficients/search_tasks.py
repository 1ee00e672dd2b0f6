"""The fits of a search as tasks for other processes, which may not have loaded anything yet."""

import functools
from dataclasses import astuple, dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from fitting import Form, Goal
    from quantities import Problem


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


def task_of(owner: "Problem", name: str, goal: "Goal", lower: "Mapping[str, float]") -> Task:
    """Return the task to fit a candidate, by its name."""
    from quantities.loader import option_for  # noqa: PLC0415  as below

    files = option_for(owner)[1:]
    return Task(name, owner.name, tuple(files), astuple(goal), tuple(sorted(lower.items())))


def fit_task(task: Task) -> Outcome:
    """Fit a candidate, in a process that may know nothing of the search yet."""
    # A process that somebody else started has no float64, which imports need.
    import jax  # noqa: PLC0415

    jax.config.update("jax_enable_x64", True)
    from coefficients.candidates import fit_candidate  # noqa: PLC0415
    from coefficients.table import serialise  # noqa: PLC0415
    from fitting import Goal  # noqa: PLC0415

    owner, forms = _by_name(task.quantity, task.files, task.goal, task.lower)
    found = fit_candidate(owner, forms[task.name], Goal(*task.goal))
    return Outcome(False, found) if isinstance(found, str) else Outcome(True, serialise(found))


@functools.lru_cache(maxsize=4)
def _by_name(
    quantity: str, files: tuple[str, ...], goal: tuple, lower: tuple[tuple[str, float], ...]
) -> "tuple[Problem, dict[str, Form]]":
    """Return a quantity and its candidates by name."""
    from coefficients.candidates import candidates, name_of  # noqa: PLC0415
    from fitting import Goal  # noqa: PLC0415
    from quantities import problem  # noqa: PLC0415
    from quantities.loader import load_problems  # noqa: PLC0415

    for each in files:
        load_problems(each)
    owner = problem(quantity)
    forms = candidates(owner, dict(lower))
    return owner, {name_of(form, Goal(*goal)): form for form in forms}
