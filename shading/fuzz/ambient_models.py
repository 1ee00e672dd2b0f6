"""Ambient models of the layer of fibres, from the talk's to the most precise, by name.

Each model is a formula for the moments of the light that the layer sends to a view (`LayerLight`),
which `layer_radiance` multiplies by the nine harmonics of a light. A model's constants are fitted
to exact moments at many materials and views. docs/ambient-light.md derives the formulas and states
the errors. All models are the same for t and −t.
"""

from collections.abc import Callable
from dataclasses import dataclass

from shading.fuzz.ambient import LIT_LAYER_CONSTANTS
from shading.fuzz.cheap_lights import cheap_directed_light, cheap_light, talk_light
from shading.fuzz.cone_lights import (
    best_light,
    mean_cosine_light,
    mean_direction_light,
    recommended_light,
)
from shading.fuzz.layer_light import Constants, LayerLight, LayerView


@dataclass(frozen=True)
class AmbientModel:
    """A model of the layer in ambient light.

    Attributes:
        name: the name in tables and on the command line.
        meaning: one line that says what the model takes into account.
        light: the moments from a view and the constants, a pure JAX function of scalars.
        constants: the fitted constants, in the order that `light` takes them.
        arguments: the fields of `LayerView` that `light` reads.
        directed: whether the model knows where the light comes from. Other models take its mean.
        shared: how many of the first constants are those of a simpler model.
    """

    name: str
    meaning: str
    light: Callable[[LayerView, Constants], LayerLight]
    constants: tuple[float, ...]
    arguments: tuple[str, ...]
    directed: bool = True
    shared: int = 0

    def __call__(self, view: LayerView) -> LayerLight:
        """Return the moments of the light towards a view, with the model's constants."""
        return self.light(view, self.constants)


_TABLES = ("scattering", "scattered")
_MATERIAL = ("cos_vt", "cos_nt", "alpha")
_CONE = ("cos_vn", "cos_vt", "cos_nt", "alpha", "density", "scattering")
# E_lit's two constants and the node of the kernel
_MEAN_COSINE = (1.308, 0.948, 0.5264)

_MODELS = (
    AmbientModel(
        "talk", "products of averages, as the talk has them", talk_light, (), _TABLES, False
    ),
    AmbientModel(
        "cheap",
        "E_lit and its correlation with the kernel",
        cheap_light,
        LIT_LAYER_CONSTANTS,
        (*_MATERIAL, *_TABLES),
        directed=False,
    ),
    AmbientModel(
        "cheap-directed",
        "as cheap, with a mean direction that needs no root",
        cheap_directed_light,
        (*LIT_LAYER_CONSTANTS, 0.5072, 0.3048, 0.2967, 1.0191, 0.4721, 0.1369),
        ("cos_vn", *_MATERIAL, *_TABLES),
        shared=4,
    ),
    AmbientModel(
        "mean-cosine",
        "E_lit, and the kernel at the mean cosine of the light",
        mean_cosine_light,
        _MEAN_COSINE,
        _CONE,
        directed=False,
    ),
    AmbientModel(
        "mean-direction",
        "as mean-cosine, with the mean direction of the light",
        mean_direction_light,
        (*_MEAN_COSINE, 1.0312, -0.858, 0.352, 0.168),
        _CONE,
        shared=3,
    ),
    AmbientModel(
        "recommended",
        "as mean-direction, with the spread of the light about it",
        recommended_light,
        (
            *(1.2786, 0.7864, 0.5603, 0.0795),
            *(1.0325, -0.8377, 0.3748, 1.1139, -0.8832, -0.2703),
            *(-0.1949, -0.4178, 0.5002, -0.6557),
        ),
        _CONE,
    ),
    AmbientModel(
        "best",
        "as recommended, with more terms",
        best_light,
        (
            *(1.3727, 1.0567, 0.6244, 0.1, -0.2875, 0.0578),
            *(0.7424, 0.2522, -0.6137, 0.2956, 0.0735, 0.0694),
            *(1.3688, -1.0621, -0.1909, -0.1228, 0.1769, -0.1045),
            *(-2.3407, -0.3326, -0.8727, 0.5911, 1.0912, 0.7558),
        ),
        _CONE,
    ),
)
# From the cheapest to the most precise.
AMBIENT_MODELS = {model.name: model for model in _MODELS}
