"""`Result`, the outcome of a fit: it shows itself as a table, writes code, and draws itself."""

import html
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import jax
import numpy as np
from rich.console import Console
from rich.table import Table as Grid

from coefficients.catalogue import Entry
from coefficients.exported_code import operations_of, source_file
from coefficients.files import write_whole
from coefficients.proof_text import proof_text
from coefficients.record import table_of
from coefficients.table import Table, serialise
from fitting import Errors, Fit, Form, Goal
from fitting.fit import fit
from fitting.second_opinion import SecondOpinion, second_opinion
from quantities.problem import Problem

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class Result:
    """A fitted form of a quantity. At the end of a notebook cell it is shown as a table.

    `fit` has all that is known of the fit, `table` what is written to JSON.
    """

    problem: Problem
    fit: Fit
    table: Table

    @property
    def coefficients(self) -> dict[str, float]:
        """The coefficients by their names."""
        return dict(zip(self._names, self.fit.fitted.constants.ravel().tolist(), strict=True))

    @property
    def stderr(self) -> dict[str, float] | None:
        """The standard errors of the coefficients, by their names.

        None if the coefficients are not unique, and unless squared errors were minimised.
        """
        known = self.table.uncertainty
        if known is None or known.standard_errors is None:
            return None
        return dict(zip(self._names, known.standard_errors, strict=True))

    @property
    def errors(self) -> Errors:
        """The rms error and the largest, with its place, at points that the fit did not use."""
        return self.fit.off_grid

    @property
    def certificate(self) -> list[str]:
        """What is proven on the whole domain, as texts."""
        return proof_text(self.table.certificates)

    @property
    def least_error(self) -> float | None:
        """A proven lower bound of the largest error of any coefficients; None if none is known."""
        return self.fit.least_error

    @cached_property
    def operations(self) -> int:
        """The number of operations of the exported function, clamps included."""
        with jax.enable_x64(True):
            return operations_of(self.entry)

    def __call__(self, *point: Any) -> np.ndarray:
        """Evaluate the form. `point` has a number or an array for each axis; they are broadcast."""
        with jax.enable_x64(True):
            columns = np.broadcast_arrays(*(np.asarray(each, float) for each in point))
            values = jax.vmap(self.fit.fitted)(*(each.ravel() for each in columns))
            return np.asarray(values).reshape(columns[0].shape)

    def code(self, language: str, precision: str | None = None, name: str | None = None) -> str:
        """Return a source file in a language, such as 'hlsl', with a header of what is known.

        `precision` is 'half', 'float' or 'double'; `name` replaces the function's name. Raises
        ValueError for a language or precision that is not known.
        """
        with jax.enable_x64(True):
            assert self.table.provenance is not None
            made_by = f"{self.table.provenance.command}.code({language!r})"
            return source_file(self.entry, language, precision, name, made_by=made_by)

    def save(self, path: str | Path | None = None) -> Path:
        """Write the table as JSON, by default to NAME.json in the working folder; return the path.

        It holds the form as data: it can be evaluated, proven and exported without the problem.
        """
        file = Path(f"{self.problem.name}.json" if path is None else path)
        write_whole(file, serialise(self.table))
        return file

    def second_opinion(self) -> SecondOpinion:
        """Refit with another solver (jaxopt) from other starts, and compare where it ends.

        Raises ValueError for rounded coefficients, and for a form without coefficients.
        """
        with jax.enable_x64(True):
            return second_opinion(self.fit.fitted.form, self.fit.goal, self.fit)

    def plot(self) -> "Figure":
        """Return a figure of the exact values, the form and its error, over one or two axes."""
        from shadefit.figures.result import draw_result  # noqa: PLC0415  Matplotlib is slow

        with jax.enable_x64(True):
            return draw_result(self.problem, self.fit.fitted)

    @cached_property
    def entry(self) -> Entry:
        """The entry of the table, which commands and functions for tables take."""
        return Entry(self.problem.name, "file", self.problem, self.table, self.fit.fitted)

    @property
    def _names(self) -> list[str]:
        return [str(each) for each in np.ravel(np.array(self.table.coefficient_names, object))]

    def rows(self) -> list[tuple[str, str]]:
        """Return what is shown, as pairs of a label and a text."""
        errors, stderr = self.errors, self.stderr
        against = self.problem.reference.compared_with
        place = ", ".join(f"{name} = {value:.4g}" for name, value in errors.where.items())
        rows = [
            ("equation", self.table.equation),
            *(
                (name, f"{value:.9g}" + (f" ± {stderr[name]:.2g}" if stderr else ""))
                for name, value in self.coefficients.items()
            ),
            ("rms error", f"{errors.rms:.3e} against {against} ({errors.points:,} points)"),
            ("largest error", f"{errors.largest:.3e} at {place}"),
            *(("proven", text) for text in self.certificate),
            ("operations", str(self.operations)),
            ("solver", self.fit.solver),
        ]
        if self.fit.converged is False:
            rows.append(("warning", "the fit did not converge: the row of the solver says why"))
        known = self.table.uncertainty
        if known is not None and not known.unique:
            names = ", ".join(known.undetermined)
            rows.append(("warning", f"not unique: other values of {names} fit as well"))
        return rows

    def __rich__(self) -> Grid:
        """Return the table that a terminal shows."""
        grid = Grid(
            title=f"{self.problem.symbol} by {self.fit.fitted.form.name}", show_header=False
        )
        grid.add_column(no_wrap=True)
        grid.add_column(overflow="fold")
        for row in self.rows():
            grid.add_row(*row)
        return grid

    def __repr__(self) -> str:
        """Return the table as text."""
        console = Console(highlight=False, markup=False)
        with console.capture() as captured:
            console.print(self)
        return captured.get().rstrip()

    def _repr_html_(self) -> str:
        """Return the table that a notebook shows."""
        body = "".join(
            f"<tr><th style='text-align:left'>{html.escape(label)}</th>"
            f"<td style='text-align:left'>{html.escape(text)}</td></tr>"
            for label, text in self.rows()
        )
        title = html.escape(f"{self.problem.symbol} by {self.fit.fitted.form.name}")
        return f"<table><caption>{title}</caption>{body}</table>"


def fit_result(
    owner: Problem, form: Form, goal: dict[str, Any], command: str | None = None
) -> Result:
    """Fit a form of a quantity to scattered points, in float64. Raises ValueError as `fit` does.

    `goal` has fields of `Goal`. `command` is what made the fit; None: a call of `Problem.fit`.
    """
    with jax.enable_x64(True):
        made = fit(form, Goal(**goal))
        other = {key: value for key, value in goal.items() if value != getattr(Goal(), key)}
        given = "".join(f", {key}={value!r}" for key, value in other.items())
        command = command or f"{owner.name}.fit({form.name!r}{given})"
        return Result(owner, made, table_of(made, command, owner=owner))
