"""A search among forms: candidates fitted one after the other, their tables kept in a folder.

A candidate's table is written as soon as it is fitted; a later run with the same folder takes it
from there, so that an interrupted search goes on where it stopped.
"""

import hashlib
import itertools
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from coefficients.catalogue import Entry, entries, published
from coefficients.exported_code import operations_of
from coefficients.files import write_whole
from coefficients.frontier import best_so_far, closed_form
from coefficients.record import table_of
from coefficients.table import Table, read, serialise
from fitting import Form, Goal, common_domain, judge
from fitting.fit import fit
from quantities import Problem


@dataclass(frozen=True)
class Found:
    """A candidate: its table's name, file, operations a call, and errors off the grid."""

    name: str
    form: str
    coefficients: int
    operations: int
    rms: float
    largest: float
    file: str


@dataclass(frozen=True)
class Result:
    """What a search found: all candidates, the best of them, and what to hold them against.

    `best` holds those that no other one beats in both operations and largest error. `refused`
    counts the candidates that have poles, or are not shown to have none.
    """

    found: list[Found]
    best: list[Found]
    published: Found | None
    exact: list[Found]
    refused: int


@dataclass(frozen=True)
class Search:
    """A search for forms of a quantity: what is tried, and where it is kept.

    `budget` is the most operations a call; `lower` maps axes to lower ends of their domains.
    """

    owner: Problem
    goal: Goal
    out: Path
    budget: int | None = None
    lower: Mapping[str, float] | None = None

    def run(self, progress: Callable[[str], None] = lambda _: None) -> Result:
        """Fit every candidate that is within the budget; raises ValueError if there is none."""
        found: list[Found] = []
        refused, last = 0, None
        for form in self.candidates():

            def tell(stage: str, done: int = len(found)) -> None:
                progress(f"{done} forms; {stage}")

            # The count needs no values: forms beyond the budget are never fitted.
            if self.budget is not None and self._blank_cost(form) > self.budget:
                continue
            if self._refusal(form).is_file():
                refused += 1
                continue
            table = self._made_before(form) or self._fitted(form, tell)
            if table is None:
                refused += 1
                continue
            found.append(self._found(form, table))
            last = form
        if last is None:
            raise ValueError(
                f"no form of {self.owner.name} was found within {self.budget} operations"
            )
        return Result(
            found, best_so_far(found), self._published(last), self._closed_form(), refused
        )

    def candidates(self) -> Iterator[Form]:
        """Yield the forms to try, those of the best tables first if the quantity says so."""
        lower = self.lower or {}
        tried = self.owner.tried(lower)
        if not self.owner.searches_best:
            return tried
        known = [e.require_fitted().form for e in entries(self.owner) if e.kind == "best"]
        same = [
            form
            for form in known
            if all(axis.lower == lower.get(axis.name, axis.lower) for axis in form.axes)
        ]
        return itertools.chain(same, tried)

    def name_of(self, form: Form) -> str:
        """Name a candidate by its family and a digest of its shape and goal: always the same."""
        text = json.dumps([form.shape, asdict(self.goal)], sort_keys=True)
        return f"{form.name}-{hashlib.sha256(text.encode()).hexdigest()[:10]}"

    def _blank_cost(self, form: Form) -> int:
        """Count a form's operations with numbers that are neither 0 nor 1 nor equal."""
        blank = form.fitted(0.37 + 0.013 * np.arange(form.size))
        return operations_of(Entry("blank", "file", self.owner, None, blank))

    def _made_before(self, form: Form) -> Table | None:
        path = self.out / f"{self.name_of(form)}.json"
        if not path.is_file():
            return None
        table = read(path)
        made_for = Goal() if table.goal is None else Goal(**table.goal.model_dump())
        same = (table.form, table.shape, made_for) == (form.name, form.shape, self.goal)
        return table if same and table.errors is not None else None

    def _refusal(self, form: Form) -> Path:
        """Return the file that says why a candidate was refused, so that it is not tried again."""
        return self.out / f"{self.name_of(form)}.refused.txt"

    def _fitted(self, form: Form, tell: Callable[[str], None]) -> Table | None:
        """Fit a candidate and write its table; None, and why, where it is refused."""
        name = self.name_of(form)
        try:
            made = fit(form, self.goal, progress=tell)
        except ValueError as error:
            write_whole(self._refusal(form), f"{error}\n")
            return None
        table = table_of(made, f"shadefit search {self.owner.name}", name)
        write_whole(self.out / f"{name}.json", serialise(table))
        return table

    def _found(self, form: Form, table: Table) -> Found:
        errors = table.errors
        assert errors is not None
        fitted = form.fitted(np.array(table.coefficients))
        entry = Entry(table.name, "file", self.owner, table, fitted)
        return Found(
            table.name,
            table.form,
            table.size,
            operations_of(entry),
            errors.off_grid.rms,
            errors.off_grid.max,
            str(self.out / f"{table.name}.json"),
        )

    def _published(self, candidate: Form) -> Found | None:
        """Judge the published table where the candidates, which share a domain, are defined too."""
        entry = published(self.owner)
        if entry is None:
            return None
        fitted, table = entry.require_fitted(), entry.require_table()
        errors = judge(fitted, common_domain([fitted.form, candidate]))
        return Found(
            entry.name,
            table.form,
            table.size,
            operations_of(entry),
            errors.rms,
            errors.largest,
            "coefficients",
        )

    def _closed_form(self) -> list[Found]:
        """Return the closed form, at which every frontier ends, if there is one."""
        return [
            Found(mark.name, "exact", 0, mark.operations, mark.rms, mark.largest, "")
            for mark in closed_form(self.owner)
        ]
