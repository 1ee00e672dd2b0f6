"""A form's values, what must stay positive, and their derivatives, at many points.

The programs are compiled once for a form, or once for all forms that have the same wider form
(`Form.wider`), and for one number of points.
"""

import jax
import numpy as np
from jax import Array

from fitting.form import Form
from fitting.linearity import positive_of
from integrals.batches import Batches

# The number of points at which values are evaluated at once, and at which derivatives are.
_BATCH, _BATCH_OF_SLOPES = 4096, 2048


class ValuesAt:
    """The values of a form at points (n, axes), and the numbers that must stay positive there.

    Both come from one compiled program. Those of the last coefficients are kept, because a fit asks
    for one after the other.
    """

    def __init__(self, form: Form, points: np.ndarray) -> None:
        self._form, self._points = form, points
        self._batches: Batches | None = None
        self._last: tuple[bytes, tuple[np.ndarray, np.ndarray]] | None = None

    def values(self, c: np.ndarray) -> np.ndarray:
        """Return the values (n,) for flat coefficients. The array is not to be changed."""
        return self._both(c)[0]

    def rooms(self, c: np.ndarray) -> np.ndarray:
        """Return the numbers that must stay positive (n,). The array is not to be changed."""
        return self._both(c)[1]

    def _both(self, c: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        key = c.tobytes()
        if self._last is None or self._last[0] != key:
            if self._batches is None:
                self._batches = Batches(self._points, _BATCH)
            form, whole = _widest(self._form, c)
            found = self._batches.evaluate(lambda x: _values_and_rooms(form, whole, x))
            self._last = key, found
        return self._last[1]


class SlopesAt:
    """The derivatives of a form, and of what must stay positive, at some of the points (n, axes).

    The points of the last choice are kept on the device for the next call.
    """

    def __init__(self, form: Form, points: np.ndarray) -> None:
        self._form, self._points = form, points
        self._last: tuple[np.ndarray, Batches] | None = None

    def values(self, c: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Return the derivatives of the values (rows, m) at the points with these indices."""
        return self._evaluate(_slopes, c, rows)

    def rooms(self, c: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Return the derivatives of the numbers that must stay positive (rows, m)."""
        return self._evaluate(_room_slopes, c, rows)

    def _evaluate(self, function, c: np.ndarray, rows: np.ndarray) -> np.ndarray:
        if self._last is None or not np.array_equal(rows, self._last[0]):
            self._last = rows, Batches(self._points[rows], _BATCH_OF_SLOPES)
        form, whole = _widest(self._form, c)
        found = self._last[1].evaluate(lambda x: function(form, whole, x))
        return found if self._form.wider is None else found[:, self._form.wider.places]


def _widest(form: Form, c: np.ndarray) -> tuple[Form, np.ndarray]:
    """Return the form to evaluate and its flat coefficients."""
    return (form, c) if form.wider is None else (form.wider.form, form.wider.coefficients(c))


def _value(form: Form, c: Array, point: Array) -> Array:
    return form(c.reshape(form.coefficient_shape), *point)


def _room(form: Form, c: Array, point: Array) -> Array:
    return positive_of(form)(c.reshape(form.coefficient_shape), *point)


def _both(form: Form, c: Array, point: Array) -> tuple[Array, Array]:
    return _value(form, c, point), _room(form, c, point)


def _at_points(function):
    """Map a function of a form, coefficients and a point over points; compiled once for a form."""
    return jax.jit(
        lambda form, c, points: jax.vmap(lambda p: function(form, c, p))(points), static_argnums=0
    )


_values_and_rooms = _at_points(_both)
_slopes, _room_slopes = _at_points(jax.grad(_value, 1)), _at_points(jax.grad(_room, 1))
