"""What the forms of P_s share: first a material's numbers, then the value for a light."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import jax.numpy as jnp
import numpy as np
from jax import Array

from fitting.form import Form, Proofs, Stage
from integrals import PS
from integrals.reference import Axis, restricted
from quantities.fuzz.lights import cosines_of_light
from shading import direction_cosines

COS_PHI = Axis("cos_phi", -1.0, 1.0, "cos φ", meaning="cosine of the light's azimuth")
# κ = (1 − α)(1 + α) of a wide interval of α is above one: proofs divide α and θf at first.
FIRST_SPLIT = (64, 8)


@dataclass(frozen=True)
class DirectionProofs:
    """How proofs see a form of P_s: functions of a material's numbers m and of cosines.

    * `value(m, u·n, u·t)` is the form without floors of its denominators.
    * `margins(m, n·t, u·n, u·t)`: if none is negative for any light, 0 ≤ P̃_s ≤ 1.
    * `positive(m, u·n, u·t)`: the radicand or denominator that a fit could make negative.
    """

    value: Callable[..., Array]
    margins: Callable[..., tuple[Array, ...]]
    positive: Callable[..., Array] = lambda *_: jnp.ones(())


def material_form(
    *,
    name: str,
    equation: str,
    least_alpha: float,
    shape: dict[str, Any],
    coefficient_names: list[str],
    starts: tuple[np.ndarray, ...],
    material: Callable[..., tuple[Array, ...]],
    along: Callable[..., Array],
    proofs: DirectionProofs,
) -> Form:
    """Return a form of P_s for α ≥ `least_alpha` of two stages.

    `material` maps coefficients, α and θf to the material's numbers m; `along` maps m, u·n and u·t
    to the value. Proofs take the cosine of the azimuth for an axis in place of the azimuth.
    """
    axes = restricted(PS.axes, alpha=(least_alpha, 1.0))

    def value(c, alpha, theta_f, theta_u, cos_phi):
        cosines = _bounded_cosines(theta_f, theta_u, cos_phi)
        return proofs.value(material(c, alpha, theta_f), *cosines)

    def margins(c, alpha, theta_f, theta_u, cos_phi):
        cosines = _bounded_cosines(theta_f, theta_u, cos_phi)
        return proofs.margins(material(c, alpha, theta_f), jnp.cos(theta_f), *cosines)

    def positive(c, alpha, theta_f, theta_u, phi):
        cosines = direction_cosines(theta_f, theta_u, jnp.cos(phi))
        return proofs.positive(material(c, alpha, theta_f), *cosines)

    return Form(
        name=name,
        equation=equation,
        reference=PS,
        axes=axes,
        coefficient_names=coefficient_names,
        stages=(
            Stage(material, "What {name} needs to know of one material; clamps to the domain."),
            Stage(along, "P_s for one direction of light."),
        ),
        shared=2,
        inputs=cosines_of_light,
        starts=starts,
        shape=shape,
        proofs=Proofs(
            axes=(*axes[:3], COS_PHI),
            value=value,
            margins=margins,
            positive=positive,
            first_split=FIRST_SPLIT,
        ),
    )


def _bounded_cosines(theta_f, theta_u, cos_phi) -> tuple[Array, Array]:
    """Return u·n and u·t for a proof: an interval does not know that u·t is a cosine."""
    cos_un, cos_ut = direction_cosines(theta_f, theta_u, cos_phi)
    return cos_un, jnp.maximum(jnp.minimum(cos_ut, 1.0), -1.0)
