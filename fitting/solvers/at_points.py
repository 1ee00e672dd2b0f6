"""A form's values, what must stay positive, and their derivatives, at many points.

The programs are compiled once for a form. All special cases of a wider form (`Form.wider`) have the
same programs, which are therefore made for speed: values and what must stay positive come from one
of them, and they take many points at a time.
"""

from collections.abc import Callable, Sequence

import jax
import numpy as np
from jax import Array

from fitting.form import Form
from fitting.linearity import positive_of
from integrals.batches import Batches

# The number of points at which values are evaluated at once, and at which derivatives are. Those
# of a wider form are evaluated at as many points as its values.
_BATCH, _BATCH_OF_SLOPES = 4096, 512


class ValuesAt:
    """The values of a form at points (n, axes), and the numbers that must stay positive there.

    Those of the last coefficients are kept, because a fit asks for them several times.
    """

    def __init__(self, form: Form, points: np.ndarray) -> None:
        self._form, self._points = form, points
        self._batches: Batches | None = None
        self._last: dict[str, np.ndarray] = {}
        self._key = b""

    def values(self, c: np.ndarray) -> np.ndarray:
        """Return the values (n,) for flat coefficients. The array is not to be changed."""
        return self._at(c, "values")

    def rooms(self, c: np.ndarray) -> np.ndarray:
        """Return the numbers that must stay positive (n,). The array is not to be changed."""
        return self._at(c, "rooms")

    def _at(self, c: np.ndarray, name: str) -> np.ndarray:
        key = c.tobytes()
        if key != self._key:
            self._key, self._last = key, {}
        if name not in self._last:
            if self._batches is None:
                self._batches = Batches(self._points, _BATCH)
            parts = self._batches.parts
            if self._form.wider is None:
                function = _VALUES[name]
                self._last[name] = self._joined([function(self._form, c, x) for x in parts])
            else:
                form, whole = self._form.wider.form, self._form.wider.coefficients(c)
                both = [_values_and_rooms(form, whole, x) for x in parts]
                self._last["values"] = self._joined([each[0] for each in both])
                self._last["rooms"] = self._joined([each[1] for each in both])
        return self._last[name]

    def _joined(self, parts: Sequence[Array]) -> np.ndarray:
        return _together(parts)[: len(self._points)]


class SlopesAt:
    """The derivatives of a form, and of what must stay positive, at some of the points (n, axes).

    The points of the last choice are kept on the device for the next call.
    """

    def __init__(self, form: Form, points: np.ndarray) -> None:
        self._form, self._points = form, points
        self._last: tuple[np.ndarray, Batches] | None = None

    def values(self, c: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Return the derivatives of the values (rows, m) at the points with these indices."""
        return self._at(c, rows, "values")

    def rooms(self, c: np.ndarray, rows: np.ndarray) -> np.ndarray:
        """Return the derivatives of the numbers that must stay positive (rows, m)."""
        return self._at(c, rows, "rooms")

    def _at(self, c: np.ndarray, rows: np.ndarray, name: str) -> np.ndarray:
        wider = self._form.wider
        if self._last is None or not np.array_equal(rows, self._last[0]):
            batch = _BATCH_OF_SLOPES if wider is None else _BATCH
            self._last = rows, Batches(self._points[rows], batch)
        parts = self._last[1].parts
        # One column after the other, as LAPACK takes them
        if wider is None:
            found = np.concatenate([_SLOPES[name](self._form, c, x) for x in parts])
            return np.asfortranarray(found[: len(rows)])
        function, whole = _WIDE_SLOPES[name], wider.coefficients(c)
        found = _together([function(wider.form, whole, x) for x in parts])
        return found[list(wider.places), : len(rows)].T


def _together(parts: Sequence[Array]) -> np.ndarray:
    """Join arrays along their last axis; a single one is only read where it is."""
    return np.asarray(parts[0]) if len(parts) == 1 else np.concatenate(parts, axis=-1)


def _value(form: Form, c: Array, point: Array) -> Array:
    return form(c.reshape(form.coefficient_shape), *point)


def _room(form: Form, c: Array, point: Array) -> Array:
    return positive_of(form)(c.reshape(form.coefficient_shape), *point)


def _both(form: Form, c: Array, point: Array) -> tuple[Array, Array]:
    return _value(form, c, point), _room(form, c, point)


def _at_points(function: Callable, axis: int = 0) -> Callable:
    """Map a function of a form, coefficients and a point over points; compiled once for a form.

    `axis` is that of the points in what it returns.
    """
    return jax.jit(
        lambda form, c, points: jax.vmap(lambda p: function(form, c, p), out_axes=axis)(points),
        static_argnums=0,
    )


_slope, _room_slope = jax.grad(_value, 1), jax.grad(_room, 1)
_VALUES = {"values": _at_points(_value), "rooms": _at_points(_room)}
_SLOPES = {"values": _at_points(_slope), "rooms": _at_points(_room_slope)}
_values_and_rooms = _at_points(_both)
_WIDE_SLOPES = {"values": _at_points(_slope, -1), "rooms": _at_points(_room_slope, -1)}
