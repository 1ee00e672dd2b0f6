"""Coefficients that are given, in the place of a solver that finds them."""

from dataclasses import dataclass

import numpy as np

from fitting.form import Form
from fitting.goal import Goal
from fitting.points.sample import sample_of
from fitting.solvers.elsewhere import Counterexamples
from fitting.solvers.exchange import ScatteredFit
from fitting.solvers.on_grid import Progress


@dataclass(frozen=True, eq=False)
class Given:
    """Flat coefficients, the solver that found them, in words, and whether it converged."""

    coefficients: np.ndarray
    solver: str
    converged: bool

    def fit(
        self,
        form: Form,
        goal: Goal,
        measure: str,
        start: np.ndarray | None,
        progress: Progress,
        counterexamples: Counterexamples | None = None,
    ) -> ScatteredFit:
        """Return the coefficients with the sample on which a form is fitted to a goal.

        The arguments are those of `Exchange.fit`. The start and the search are not used.
        """
        progress(f"exact {form.reference.symbol} where {form.name} is fitted")
        sample = sample_of(form, goal, measure)
        return ScatteredFit(self.coefficients, sample, self.converged, self.solver)
