"""Nonlinear regression problems with certified solutions: NIST's Statistical Reference Datasets.

`nist_strd.json` holds, for each problem, the data, the two published starts, the certified
coefficients with their standard deviations, and the certified residual sum of squares. NIST
computed them with multiple precision, to 11 digits. The models are written here.
"""

import json
import math
from dataclasses import dataclass
from pathlib import Path

import jax.numpy as jnp
import numpy as np

from fitting import Form, Stage
from fitting.points.sample import Sample
from integrals import Axis, Estimate, Reference, Sampling

_RECORDS = json.loads((Path(__file__).parent / "nist_strd.json").read_text())["problems"]


@dataclass(frozen=True)
class Certified:
    """A problem: its form with the two published starts, its data, and its certified solution."""

    form: Form
    sample: Sample
    coefficients: np.ndarray
    deviations: np.ndarray
    squares: float

    @property
    def y(self) -> np.ndarray:
        """The data that are fitted (n,)."""
        return self.sample.exact


def _chwirut(b, x):
    return jnp.exp(-b[0] * x) / (b[1] + b[2] * x)


def _gauss(b, x):
    bells = [b[k] * jnp.exp(-(((x - b[k + 1]) / b[k + 2]) ** 2)) for k in (2, 5)]
    return b[0] * jnp.exp(-b[1] * x) + bells[0] + bells[1]


def _lanczos(b, x):
    return sum(b[k] * jnp.exp(-b[k + 1] * x) for k in (0, 2, 4))


def _cubics(b, x):
    above = b[0] + x * (b[1] + x * (b[2] + x * b[3]))
    return above / (1 + x * (b[4] + x * (b[5] + x * b[6])))


def _enso(b, x):
    def wave(cosine, sine, period):
        angle = 2 * math.pi * x / period
        return cosine * jnp.cos(angle) + sine * jnp.sin(angle)

    return b[0] + wave(b[1], b[2], 12) + wave(b[4], b[5], b[3]) + wave(b[7], b[8], b[6])


_MODELS = {
    "Bennett5": lambda b, x: b[0] * (b[1] + x) ** (-1 / b[2]),
    "BoxBOD": lambda b, x: b[0] * (1 - jnp.exp(-b[1] * x)),
    "Chwirut1": _chwirut,
    "Chwirut2": _chwirut,
    "DanWood": lambda b, x: b[0] * x ** b[1],
    "ENSO": _enso,
    "Eckerle4": lambda b, x: b[0] / b[1] * jnp.exp(-0.5 * ((x - b[2]) / b[1]) ** 2),
    "Gauss1": _gauss,
    "Gauss2": _gauss,
    "Gauss3": _gauss,
    "Hahn1": _cubics,
    "Kirby2": lambda b, x: (b[0] + x * (b[1] + x * b[2])) / (1 + x * (b[3] + x * b[4])),
    "Lanczos1": _lanczos,
    "Lanczos2": _lanczos,
    "Lanczos3": _lanczos,
    "MGH09": lambda b, x: b[0] * (x**2 + x * b[1]) / (x**2 + x * b[2] + b[3]),
    "MGH10": lambda b, x: b[0] * jnp.exp(b[1] / (x + b[2])),
    "MGH17": lambda b, x: b[0] + b[1] * jnp.exp(-x * b[3]) + b[2] * jnp.exp(-x * b[4]),
    "Misra1a": lambda b, x: b[0] * (1 - jnp.exp(-b[1] * x)),
    "Misra1b": lambda b, x: b[0] * (1 - (1 + b[1] * x / 2) ** -2),
    "Misra1c": lambda b, x: b[0] * (1 - 1 / jnp.sqrt(1 + 2 * b[1] * x)),
    "Misra1d": lambda b, x: b[0] * b[1] * x / (1 + b[1] * x),
    "Nelson": lambda b, x, z: b[0] - b[1] * x * jnp.exp(-b[2] * z),
    "Rat42": lambda b, x: b[0] / (1 + jnp.exp(b[1] - b[2] * x)),
    "Rat43": lambda b, x: b[0] / (1 + jnp.exp(b[1] - b[2] * x)) ** (1 / b[3]),
    # A fit keeps divisors positive: x − b₄ is negative for all data.
    "Roszman1": lambda b, x: b[0] - b[1] * x + jnp.arctan(b[2] / (b[3] - x)) / math.pi,
    "Thurber": _cubics,
}
NAMES = tuple(_MODELS)


def certified(name: str, *starts: int) -> Certified:
    """Return a problem. Its form has the published starts with these numbers, 1 and 2."""
    record, model = _RECORDS[name], _MODELS[name]
    x, y = np.array(record["x"], float).T, np.array(record["y"], float)
    y = np.log(y) if name == "Nelson" else y
    names = ("x", "z")[: x.shape[1]]
    axes = tuple(Axis(n, float(c.min()), float(c.max())) for n, c in zip(names, x.T, strict=True))
    reference = Reference(
        name=name,
        symbol="y",
        meaning="measured data",
        definition="the data",
        axes=axes,
        sampling=Sampling(fitted=4, checked=4, judged=4),
        closed_form=lambda *point: Estimate(jnp.nan * point[0], jnp.nan * point[0]),
    )
    size = len(record["certified"])
    form = Form(
        name=name.lower(),
        equation=f"the model of {name}",
        reference=reference,
        axes=axes,
        coefficient_names=[f"b{k + 1}" for k in range(size)],
        stages=(Stage(model),),
        starts=tuple(np.array(record["starts"][k - 1], float) for k in starts),
    )
    return Certified(
        form,
        Sample(x, y, 0.0, np.ones(len(y))),
        np.array(record["certified"]),
        np.array(record["deviations"]),
        record["squares"],
    )
