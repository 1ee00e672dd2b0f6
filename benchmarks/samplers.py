"""Measure samplers of visible normals in C: `python benchmarks/samplers.py [--json]`.

All samplers get the same views, roughnesses and random numbers, in one run and in turn. A path
tracer needs as many samples as the variance of one says, so what counts is time × variance. It is
printed for the sampling alone, which is a small part of a path tracer's time. From some time on
that everything else takes for a sample, such as tracing its ray, the upper sampler is better than
the bounded cap: this time is printed too, in multiples of a sample by the bounded cap.
"""

import argparse
import json

import jax
import numpy as np

from coefficients.catalogue import resolve
from fitting.points.grids import sobol_points
from integrals.microfacet.sampling_variance import moments, variances
from programs import count_operations, measure_throughput, trace

# Key -> the field of `Variances`
SAMPLERS = {
    "sampler/ggx-disk": "visible",
    "sampler/ggx-cap": "visible",
    "sampler/ggx-bounded-cap": "bounded",
    "sampler/ggx-upper": "upper",
}
# αx, αy, θ and φ in degrees
SETTINGS = (
    (0.1, 0.1, 60, 0),
    (0.5, 0.5, 0, 0),
    (0.5, 0.5, 60, 0),
    (1.0, 1.0, 60, 0),
    (0.2, 0.8, 5, 0),
    (1.0, 0.3, 60, 40),
)
# A run takes less than a time slice of the operating system, so that the fastest of many runs is
# not interrupted by other programs.
EXPONENT, ROUNDS, REPEATS = 12, 60, 3


def speeds() -> dict[str, dict[str, float]]:
    """Return operations and million samples per second of each sampler.

    The rate is the best of several measurements, between which the samplers take turns.
    """
    rates: dict[str, list[float]] = {name: [] for name in SAMPLERS}
    for _ in range(REPEATS):
        for name in SAMPLERS:
            entry = resolve(name)
            (function,) = entry.functions()
            (rows,) = entry.arguments_at(sobol_points(entry.axes, EXPONENT, 1))
            rates[name].append(measure_throughput(function, rounds=ROUNDS, rows=rows).compiled)
    return {
        name: {
            "operations": count_operations(trace(resolve(name).functions()[0])).operations,
            "million_per_second": max(rates[name]) / 1e6,
        }
        for name in SAMPLERS
    }


def variance_of(setting: tuple[float, ...]) -> dict[str, float]:
    alpha_x, alpha_y, theta, phi = setting
    theta, phi = np.radians([theta, phi])
    view = np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    alphas = np.array([alpha_x, alpha_y])
    found = jax.jit(lambda v, a: variances(v, a, moments(v, a)))(view, alphas)
    return {name: float(getattr(found, field)) for name, field in SAMPLERS.items()}


def show(measured: dict, found: dict) -> None:
    first = next(iter(measured.values()))["million_per_second"]
    print(f"{'sampler':<26}{'operations':>12}{'million/s':>12}{'to the first':>14}")
    for name, each in measured.items():
        rate = each["million_per_second"]
        print(f"{name:<26}{each['operations']:>12}{rate:>12.1f}{rate / first:>14.2f}")
    print("\nvariance, and time × variance of sampling alone, both to those of ggx-upper")
    names = [name.removeprefix("sampler/ggx-") for name in SAMPLERS]
    titles = "".join(f"{name:>16}" for name in names)
    print(f"{'αx, αy, θ, φ':<18}{titles}{'better from':>14}")
    for setting, variance in found.items():
        cost = {n: variance[n] / measured[n]["million_per_second"] for n in SAMPLERS}
        last = list(SAMPLERS)[-1]
        cells = [
            f"{variance[n] / variance[last]:>9.2f}{cost[n] / cost[last]:>7.2f}" for n in SAMPLERS
        ]
        print(f"{setting:<18}" + "".join(cells) + f"{better_from(measured, variance):>14}")


def better_from(measured: dict, variance: dict[str, float]) -> str:
    """Return the time R from which (R + t)·variance is least for the upper sampler.

    The unit is the time t of a sample by the bounded cap.
    """
    bounded, upper = "sampler/ggx-bounded-cap", "sampler/ggx-upper"
    gain = variance[bounded] / variance[upper]
    slower = measured[bounded]["million_per_second"] / measured[upper]["million_per_second"]
    return "never" if gain < 1.0001 else f"{max(0.0, (slower - gain) / (gain - 1)):.1f}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true", help="print one JSON object instead")
    options = parser.parse_args()
    jax.config.update("jax_enable_x64", True)
    found = {", ".join(f"{x:g}" for x in each): variance_of(each) for each in SETTINGS}
    measured = speeds()
    if options.json:
        print(json.dumps({"speed": measured, "variance": found}, indent=2))
    else:
        show(measured, found)


if __name__ == "__main__":
    main()
