"""What the forms of P_s share: two steps, and functions of the material that are polynomials."""

import functools
from collections.abc import Callable
from dataclasses import replace

import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.form import Form
from integrals import PS, Axis
from shading import direction_cosines
from shading.types import Scalar

COS_PHI = Axis("cos_phi", "cos φ", "1", -1.0, 1.0, "cosine of the light's azimuth")


def axes_from(least_alpha: float):
    """Give the axes of P_s with α from `least_alpha`."""
    return (replace(PS.axes[0], lower=least_alpha, open_below=False), *PS.axes[1:])


class MaterialForm(Form):
    """A form of P_s in two steps: a material's numbers, then a direction's value."""

    def material(self, alpha: Scalar, theta_f: Scalar) -> tuple[Array, ...]:
        """Give what a material's directions share."""
        raise NotImplementedError

    def along(self, m: tuple, cos_un: Scalar, cos_ut: Scalar) -> Array:
        """Evaluate P̃_s of a material at u·n and u·t."""
        raise NotImplementedError

    def positive_along(self, m: tuple, cos_un: Scalar, cos_ut: Scalar) -> Array:
        """Give what must stay positive for a material at u·n and u·t."""
        return jnp.ones(())

    def margins_along(
        self, m: tuple, cos_nt: Scalar, cos_un: Scalar, cos_ut: Scalar
    ) -> tuple[Array, ...]:
        """Give what is not negative for any light of a material only if 0 ≤ P̃_s ≤ 1."""
        raise NotImplementedError

    def __call__(self, alpha: Scalar, theta_f: Scalar, theta_u: Scalar, phi: Scalar) -> Array:
        """Evaluate P̃_s at one material and one direction of light."""
        cosines = direction_cosines(theta_f, theta_u, jnp.cos(phi))
        return self.along(self.material(alpha, theta_f), *cosines)

    def unguarded_along(self, m: tuple, cos_un: Scalar, cos_ut: Scalar) -> Array:
        """Evaluate the same without floors that keep a denominator from being zero."""
        return self.along(m, cos_un, cos_ut)

    def unguarded(self) -> tuple[Callable[..., Array], tuple[Axis, ...]]:
        """Give the form without floors, by the cosine of the azimuth."""

        def value(alpha, theta_f, theta_u, cos_phi):
            cosines = _bounded_cosines(theta_f, theta_u, cos_phi)
            return self.unguarded_along(self.material(alpha, theta_f), *cosines)

        return value, (*self.axes[:3], COS_PHI)

    def margins(self) -> tuple[Callable[..., tuple[Array, ...]], tuple[Axis, ...]]:
        """Give the margins of all directions, by the cosine of the azimuth."""

        def margins(alpha, theta_f, theta_u, cos_phi):
            cosines = _bounded_cosines(theta_f, theta_u, cos_phi)
            return self.margins_along(self.material(alpha, theta_f), jnp.cos(theta_f), *cosines)

        return margins, (*self.axes[:3], COS_PHI)

    def positive(self, alpha: Scalar, theta_f: Scalar, theta_u: Scalar, phi: Scalar) -> Array:
        """Give the radicand or denominator that a fit could make negative."""
        cosines = direction_cosines(theta_f, theta_u, jnp.cos(phi))
        return self.positive_along(self.material(alpha, theta_f), *cosines)


def _bounded_cosines(theta_f, theta_u, cos_phi) -> tuple[Array, Array]:
    """Give u·n and u·t for a proof: an interval does not know that u·t is a cosine."""
    cos_un, cos_ut = direction_cosines(theta_f, theta_u, cos_phi)
    return cos_un, jnp.maximum(jnp.minimum(cos_ut, 1.0), -1.0)


def surface_values(coefficients, count: int, degree: int, alpha, y) -> list[Array]:
    """Give `count` polynomials of total degree `degree` in α and y, their coefficients in a row."""
    powers = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]
    size = len(powers)
    return [
        functools.reduce(
            jnp.add,
            [
                coefficients[k * size + n] * alpha**i * y**j
                if i + j
                else jnp.asarray(coefficients[k * size])
                for n, (i, j) in enumerate(powers)
            ],
        )
        for k in range(count)
    ]


def surface_names(surfaces: list[str], degree: int) -> list[str]:
    """Name the coefficients of surfaces by surface and monomial."""
    powers = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]
    return [f"{name}: α^{i} y^{j}" for name in surfaces for i, j in powers]


def flat_start(values: list[float], degree: int, slopes=None) -> np.ndarray:
    """Give coefficients of constant surfaces, or with `slopes` by α and y where there are some."""
    start = np.zeros((len(values), (degree + 1) * (degree + 2) // 2))
    start[:, 0] = values
    for k, (by_alpha, by_y) in (slopes or {}).items():
        start[k, [degree + 1, 1]] = by_alpha, by_y
    return start.ravel()
