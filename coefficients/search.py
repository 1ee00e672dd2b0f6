"""A search among forms: the candidates are fitted in turn, and their tables are kept in a folder.

A candidate's table is written as soon as it is fitted. A later run with the same folder reads it
instead of fitting again, so that an interrupted search continues where it stopped. Candidates may
be fitted in several processes; only the process that runs the search writes.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from coefficients.candidates import candidates, fit_candidate, name_of
from coefficients.catalogue import Entry, published, resolve
from coefficients.exported_code import operations_of
from coefficients.expression import require_same
from coefficients.files import write_whole
from coefficients.frontier import best_so_far, closed_form
from coefficients.packaged import EXACT, Kind
from coefficients.search_tasks import fit_task, task_of
from coefficients.stated_errors import misstatements
from coefficients.table import Table, parse, read, serialise
from coefficients.workers import Workers
from fitting import Form, Goal, common_domain, judge
from quantities import Problem

# Takes what is done now, the number of candidates that were tried, and the number of all to try.
Progress = Callable[[str, int, int], None]


@dataclass(frozen=True)
class Found:
    """A table with its operations a call and its rms and largest error.

    `form` is the name of the form, `equation` what it computes, `coefficients` their number, and
    `file` the table's file; the closed form has no `form`, and neither it nor a packaged table has
    a `file`. The errors of a candidate are at `points` points that its fit did not use; `where` has
    the largest. Both are None for the closed form.
    """

    name: str
    kind: Kind
    form: str | None
    equation: str
    coefficients: int
    operations: int
    rms: float
    largest: float
    where: dict[str, float] | None
    points: int | None
    file: str | None


@dataclass(frozen=True)
class Result:
    """What a search found.

    * `found`: all candidates that were fitted.
    * `best`: those on the frontier of operations against the largest error (`best_so_far`).
    * `published`, `exact`: the published table and the closed form, for comparison, if they exist.
    * `refused`: the number of candidates whose fit or proof failed, mostly because of poles.
    """

    found: list[Found]
    best: list[Found]
    published: Found | None
    exact: list[Found]
    refused: int


@dataclass(frozen=True)
class Search:
    """A search for forms of a quantity.

    * `owner`: the quantity. `goal`: the goal of the fits.
    * `out`: the folder where the tables are kept.
    * `budget`: the most operations a call that a candidate may have; None: any number.
    * `lower`: maps the names of axes to the lower ends of their domains.
    """

    owner: Problem
    goal: Goal
    out: Path
    budget: int | None = None
    lower: Mapping[str, float] | None = None

    def run(self, progress: Progress = lambda *_: None, workers: Workers | None = None) -> Result:
        """Fit every candidate within the budget. Raises ValueError if no fit succeeds.

        `progress` is called with what is done now, the number of candidates that were tried in this
        run, and the number of those to try. Candidates of an earlier run do not count. `workers`
        fit several candidates at a time; what is found and written is the same without them.
        """
        found: list[Found] = []
        refused, tried, last = 0, 0, None
        # Operations are counted without a fit, so that forms beyond the budget cost no time.
        chosen = [form for form in self.candidates() if self._is_within_budget(form)]
        made = self._made_before(chosen)
        settled = [self._refusal(form).is_file() for form in chosen]
        if workers is not None:
            pairs = zip(chosen, settled, made, strict=True)
            to_fit = [form for form, no, yes in pairs if not no and yes is None]
            self._fit_all(to_fit, progress, workers)
            made = self._made_before(chosen)
            settled = [self._refusal(form).is_file() for form in chosen]
        total = sum(not no and yes is None for no, yes in zip(settled, made, strict=True))
        for form, no, before in zip(chosen, settled, made, strict=True):
            if no:
                refused += 1
                continue

            def tell(stage: str, done: int = tried) -> None:
                progress(stage, done, total)

            table = before
            if table is None:
                table = self._fitted(form, tell)
                tried += 1
            if table is None:
                refused += 1
                continue
            found.append(self._found(form, table))
            last = form
        if last is None:
            raise ValueError(
                f"no form of {self.owner.name} was found"
                f"{'' if self.budget is None else f' within {self.budget} operations'}"
            )
        return Result(
            found, best_so_far(found), self._published(last), self._closed_form(), refused
        )

    def candidates(self) -> Iterator[Form]:
        """Yield the forms to try. If `owner.searches_best`, those of best tables come first."""
        return candidates(self.owner, self.lower or {})

    def name_of(self, form: Form) -> str:
        """Return a candidate's name, which is the same in every run, so that its table is found."""
        return name_of(form, self.goal)

    def _is_within_budget(self, form: Form) -> bool:
        return self.budget is None or self._blank_cost(form) <= self.budget

    def _blank_cost(self, form: Form) -> int:
        """Count the operations of a form that is not fitted yet.

        The coefficients are arbitrary. They are not 0, 1 or equal, because this could simplify the
        program.
        """
        blank = form.fitted(0.37 + 0.013 * np.arange(form.size))
        return operations_of(Entry("blank", "file", self.owner, None, blank))

    def _made_before(self, forms: Sequence[Form]) -> list[Table | None]:
        """Return the table of each form that an earlier run made, or None.

        A table is not believed: if it states an error that is not its own, its form is fitted anew.
        """
        tables = [self._read_before(form) for form in forms]
        stated = [
            (form.fitted(np.array(table.coefficients)), table)
            for form, table in zip(forms, tables, strict=True)
            if table is not None
        ]
        wrong = iter(misstatements(self.owner.reference, stated))
        return [None if table is None or next(wrong) is not None else table for table in tables]

    def _read_before(self, form: Form) -> Table | None:
        path = self.out / f"{self.name_of(form)}.json"
        if not path.is_file():
            return None
        table = read(path)
        made_for = Goal() if table.goal is None else Goal(**table.goal.model_dump())
        same = (table.form, table.shape, made_for) == (form.name, form.shape, self.goal)
        if not same or table.errors is None or table.size != form.size:
            return None
        # Tables of the older schema have no expression.
        if table.expression is None:
            return table
        try:
            require_same(table, form)
        except ValueError:
            return None
        return table

    def _refusal(self, form: Form) -> Path:
        """Return the file that says why a candidate was refused. If it exists, no fit is tried."""
        return self.out / f"{self.name_of(form)}.refused.txt"

    def _fitted(self, form: Form, tell: Callable[[str], None]) -> Table | None:
        """Fit a candidate and write its table. If it is refused, write why and return None."""
        outcome = fit_candidate(self.owner, form, self.goal, tell)
        self._write(form, outcome)
        return outcome if isinstance(outcome, Table) else None

    def _write(self, form: Form, outcome: Table | str) -> None:
        if isinstance(outcome, str):
            write_whole(self._refusal(form), f"{outcome}\n")
        else:
            write_whole(self.out / f"{self.name_of(form)}.json", serialise(outcome))

    def _fit_all(self, forms: list[Form], progress: Progress, workers: Workers) -> None:
        """Fit candidates by workers, and write each table when it is ready."""
        known = {self.name_of(form): form for form in forms}
        tasks = [task_of(self.owner, name, self.goal, self.lower or {}) for name in known]
        progress("fits side by side", 0, len(tasks))
        for done, (task, outcome) in enumerate(workers.results(fit_task, tasks), start=1):
            form = known[task.name]
            self._write(form, parse(outcome.text, task.name) if outcome.fitted else outcome.text)
            progress(f"{form.name} is done", done, len(tasks))

    def _found(self, form: Form, table: Table) -> Found:
        errors = table.errors
        assert errors is not None
        fitted = form.fitted(np.array(table.coefficients))
        entry = Entry(table.name, "file", self.owner, table, fitted)
        return Found(
            table.name,
            "file",
            table.form,
            table.equation,
            table.size,
            operations_of(entry),
            errors.off_grid.rms,
            errors.off_grid.max,
            errors.off_grid.where,
            errors.off_grid.points,
            str(self.out / f"{table.name}.json"),
        )

    def _published(self, candidate: Form) -> Found | None:
        """Return the published table with its errors in the domain of the candidates, if any.

        All candidates have the same domain, so that one of them suffices.
        """
        entry = published(self.owner)
        if entry is None:
            return None
        fitted, table = entry.require_fitted(), entry.require_table()
        errors = judge(fitted, common_domain([fitted.form, candidate]))
        return Found(
            entry.name,
            entry.kind,
            table.form,
            table.equation,
            table.size,
            operations_of(entry),
            errors.rms,
            errors.largest,
            errors.where,
            errors.points,
            None,
        )

    def _closed_form(self) -> list[Found]:
        """Return a list with the closed form; it is empty if there is none."""
        return [
            Found(
                mark.name,
                "exact",
                None,
                resolve(f"{EXACT}/{self.owner.name}").equation,
                0,
                mark.operations,
                mark.rms,
                mark.largest,
                None,
                None,
                None,
            )
            for mark in closed_form(self.owner)
        ]
