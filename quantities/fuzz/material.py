"""What the forms of P_s share: a first stage for a material, and a second one for each light."""

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
# Interval arithmetic gives κ = (1 − α)(1 + α) bounds above 1 if the interval of α is wide. Proofs
# therefore divide α and θf into this many pieces at first.
FIRST_SPLIT = (64, 8)


@dataclass(frozen=True)
class DirectionProofs:
    """Functions that proofs and fits of a form P̃_s use; m are the results of the first stage.

    * `value(m, u·n, u·t)`: the form without the lower limits of its denominators.
    * `margins(m, n·t, u·n, u·t)`: a tuple. If no element is negative for any light and material,
      0 ≤ P̃_s ≤ 1 (docs/range.md).
    * `positive(m, u·n, u·t)`: a radicand or denominator that a fit could make negative.
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
    limited: Callable[..., Array] | None = None,
) -> Form:
    """Return a form of P_s of two stages, for α ≥ `least_alpha`.

    `material` is the first stage, which maps the coefficients, α and θf to numbers m. `along` is
    the second, which maps m, u·n and u·t to the value; `limited` is the same for exported code
    (`Stage.limited`). Proofs have the axis cos φ in place of φ: P_s depends on φ only through
    cos φ, which has each value only once in [−1, 1].
    """
    axes = restricted(PS.axes, alpha=(least_alpha, 1.0))

    def value(c, alpha, theta_f, theta_u, cos_phi):
        cosines = bounded_cosines(theta_f, theta_u, cos_phi)
        return proofs.value(material(c, alpha, theta_f), *cosines)

    def margins(c, alpha, theta_f, theta_u, cos_phi):
        cosines = bounded_cosines(theta_f, theta_u, cos_phi)
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
            Stage(
                material,
                "What {name} needs to know of one material; clamps to the domain.",
                result_name="m",
            ),
            Stage(
                along,
                "P_s for one direction of light; clamps to the domain.",
                arguments=("c", "a"),
                limited=limited,
            ),
        ),
        shared=2,
        inputs=cosines_of_light,
        starts=starts,
        shape=shape,
        proofs=Proofs(
            axes=(*axes[:3], COS_PHI),
            inputs=lambda _, *angles: bounded_cosines(*angles),
            value=value,
            margins=margins,
            positive=positive,
            first_split=FIRST_SPLIT,
        ),
    )


def bounded_cosines(theta_f, theta_u, cos_phi) -> tuple[Array, Array]:
    """Return u·n and u·t for a proof, u·t limited to [−1, 1].

    The limit changes no value, but interval arithmetic alone would not find it.
    """
    cos_un, cos_ut = direction_cosines(theta_f, theta_u, cos_phi)
    return cos_un, jnp.maximum(jnp.minimum(cos_ut, 1.0), -1.0)
