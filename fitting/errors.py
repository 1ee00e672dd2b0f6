"""How far a form is from the exact values on a set of points."""

import functools
from collections.abc import Callable
from dataclasses import dataclass

import jax
import numpy as np

from fitting.form import FittedForm, Form
from fitting.points.domain import Domain
from fitting.points.scattered import OFF_GRID_SEED, checking_points, judging_points
from integrals.batches import in_batches
from integrals.compilation import jit_for_few_calls
from integrals.reference import Axis, box_of

_BATCH = 8192


@dataclass(frozen=True)
class Errors:
    """The rms error, the largest absolute error and its place, measured at a number of `points`.

    `where` maps the names of the axes to the point that has the largest error.
    """

    rms: float
    largest: float
    where: dict[str, float]
    points: int


@dataclass(frozen=True)
class HillClimbing:
    """A search for larger errors than those at the points that were tried.

    The domain of n axes is divided into `cells`ⁿ equal cells. The search starts at the worst point
    of each cell. It is needed because the largest error may lie on a narrow ridge that the points
    miss. There is a round for each of `radii`: each cell's point is moved by random steps, and the
    point with the largest error is kept. The steps have a normal distribution whose standard
    deviation is the radius, as a fraction of the domain. At most `steps` points are tried in a
    round.
    """

    cells: int = 4
    radii: tuple[float, ...] = (0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0005)
    steps: int = 8192

    def __call__(
        self, size, points: np.ndarray, sizes: np.ndarray, axes: tuple[Axis, ...], seed: int
    ) -> np.ndarray:
        """Return the points (m, axes) that the search ends at, one for each cell with points.

        `size` maps points (k, axes) to what is searched for a maximum (k,), usually the absolute
        error; `sizes` (n,) are its values at `points` (n, axes).
        """
        lower, upper = box_of(axes).T
        rng = np.random.default_rng(seed)
        cells = np.ravel_multi_index(
            np.minimum(
                self.cells * (points - lower) / (upper - lower), self.cells - 1
            ).astype(int).T,
            (self.cells,) * len(axes),
        )  # fmt: skip
        order = np.argsort(sizes)
        worst = np.full(self.cells ** len(axes), -1)
        worst[cells[order]] = order
        best = points[worst[worst >= 0]]
        for radius in self.radii:
            steps = rng.normal(size=(self.steps // len(best), *best.shape)) * radius
            steps = steps * (upper - lower)
            steps[0] = 0
            tried = np.clip(best + steps, lower, upper)
            found = np.argmax(size(tried.reshape(-1, len(axes))).reshape(tried.shape[:2]), axis=0)
            best = tried[found, np.arange(len(best))]
        return best


climb = HillClimbing()


def form_values(fitted: FittedForm, points: np.ndarray) -> np.ndarray:
    """Return a form's values (n,) at points (n, axes)."""
    wider = fitted.form.wider
    if wider is not None:
        fitted = wider.form.fitted(wider.coefficients(fitted.constants.ravel()))
    return np.asarray(in_batches(functools.partial(_apply, fitted), points, _BATCH))


def measure(
    difference: np.ndarray, points: np.ndarray, domain: Form | Domain, weights=None
) -> Errors:
    """Return the errors of a form, given its differences (n,) from the exact values at points.

    `points` is (n, axes). `weights` (n,) are those of the squared errors in the rms; None weighs
    all points equally.
    """
    worst = int(np.argmax(np.abs(difference)))
    where = {axis.name: float(x) for axis, x in zip(domain.axes, points[worst], strict=True)}
    with np.errstate(over="ignore"):
        rms = float(np.sqrt(np.average(difference**2, weights=weights)))
    return Errors(rms, float(np.abs(difference[worst])), where, len(points))


def judge(fitted: FittedForm, domain: Form | Domain | None = None) -> Errors:
    """Return the errors of a form at points that no fit uses, in its own domain or in `domain`."""
    domain = fitted.form if domain is None else domain
    return judge_values(functools.partial(form_values, fitted), domain)


def judge_values(values_at: Callable[[np.ndarray], np.ndarray], domain: Form | Domain) -> Errors:
    """Return the errors in a domain of a function from points (n, axes) to values (n,).

    The rms error is over scrambled Sobol' points. The largest error is the largest of three: over
    the same points; over further points, some of them on the faces, edges and corners of the domain
    and where the quantity is steep; and over the points that hill climbing finds from these, unless
    the quantity's sampling turns hill climbing off.
    """
    points, exact = judging_points(domain)
    inside = measure(values_at(points) - exact, points, domain)
    points, exact = checking_points(domain, OFF_GRID_SEED)
    difference = values_at(points) - exact
    found = [inside, measure(difference, points, domain)]
    if domain.reference.sampling.climbs:

        def error(x: np.ndarray) -> np.ndarray:
            return values_at(x) - domain.reference.values(x)

        top = climb(
            lambda x: np.abs(error(x)), points, np.abs(difference), domain.axes, OFF_GRID_SEED
        )
        found.append(measure(error(top), top, domain))
    worst = max(found, key=lambda each: each.largest)
    return Errors(inside.rms, worst.largest, worst.where, inside.points)


@jit_for_few_calls
def _apply(fitted: FittedForm, points):
    return jax.vmap(lambda x: fitted(*x))(points)
