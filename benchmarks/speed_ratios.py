"""Measure speed as ratios within one run: `python benchmarks/speed_ratios.py [--json]`.

(a) The processor time of `shadefit refit ps g q r` at 65×65 without a cache, imports and
compilation included, compared with that of the same task in plain NumPy and SciPy without closed
forms (plain_scipy.py); refit_times.py compares with a script that knows them. (b) The evaluations
per second of P_s by its closed form, compared with quadrature of its definition. (c) The time until
commands that need no JAX have ended, compared with that of an empty Python program.
"""

import argparse
import json
import os
import sys
import tempfile
import time
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
from plain_scipy import directions, lights_of, views
from plain_scipy import scattered_fraction as by_numpy
from processes import run

from coefficients.catalogue import resolve
from fitting.points.grids import trapezoid_grid
from integrals import PS, R
from integrals.fuzz.ps import (
    FLOAT32_STEPS,
    FLOAT64_STEPS,
    fraction_at,
    quick_fraction_at,
    scattered_fraction,
)
from programs import measure_throughput
from quantities.fuzz.lights import cosines_at
from quantities.fuzz.supplement import RATIONAL_PS, RATIONAL_R

HERE = Path(__file__).parent
CELLS = 5


def refit(folder: Path) -> dict:
    code = "from shadefit.cli import main; main()"
    names = ["ps", "g", "q", "r"]
    found = run([sys.executable, "-c", code, "refit", *names, "--out", str(folder), "--json"])
    tables = json.loads(found.output)["tables"]
    rms = {table["quantity"]: table["errors"]["rms"] for table in tables}
    return {"seconds": found.processor, "mebibytes": found.mebibytes, "rms": rms}


def surfaces(path: Path) -> None:
    """Write the file of data that plain_scipy.py fits and compares with. This is not timed."""
    grid = trapezoid_grid(RATIONAL_PS.axes[:2], 65)
    fits = RATIONAL_PS.solver.node_fits(RATIONAL_PS, grid, "uniform")
    cells = np.array(fits.optimum).reshape(-1, 6)
    cells[:, 0] -= 0.5
    chosen = np.random.default_rng(2).choice(65**2, CELLS, replace=False)
    theta, phi, _ = lights_of(48)
    exact = []
    for cell in chosen:
        material = np.broadcast_to(grid.points[cell], (len(theta), 2))
        exact.append(PS.values(np.column_stack([material, theta, phi])))
    other = trapezoid_grid(RATIONAL_R.axes, 65)
    np.savez(
        path,
        ps_points=grid.points,
        cells=cells.T,
        ps_exact=np.array(exact),
        r_points=other.points,
        r=R.values(other.points),
    )


def plain(path: Path) -> dict:
    command = [sys.executable, str(HERE / "plain_scipy.py"), str(path), "--cells", str(CELLS)]
    measured = run(command)
    found = json.loads(measured.output)
    # The difference is the extrapolated time of the cells that were not computed.
    rest = sum(found["seconds"].values()) - found["measured"]
    return {
        "seconds": measured.processor + rest,
        "measured_seconds": measured.processor,
        "mebibytes": measured.mebibytes,
        "parts": found["seconds"],
        "notes": found["notes"],
    }


def rate(function, *arguments, count: int, repeat: int = 15) -> float:
    """Return evaluations per second of processor time: the best of several runs."""
    jax.block_until_ready(function(*arguments))
    best = np.inf
    for _ in range(repeat):
        clock = time.process_time()
        jax.block_until_ready(function(*arguments))
        best = min(best, time.process_time() - clock)
    return count / best


def throughput() -> dict:
    random, count = np.random.default_rng(1), 1 << 17
    alpha = random.uniform(0.15, 1, count)
    theta_f, theta_u = random.uniform(0, np.pi / 2, (2, count))
    phi = random.uniform(0, np.pi, count)
    materials = np.column_stack([alpha, theta_f, theta_u, phi])
    rates = {}
    for name, dtype, steps in (
        ("float32", jnp.float32, FLOAT32_STEPS),
        ("float64", jnp.float64, FLOAT64_STEPS),
    ):
        closed = jax.jit(lambda c, a, b, alpha, s=steps: scattered_fraction(c, a, b, alpha, s))
        values = [jnp.asarray(each, dtype) for each in (*cosines_at(materials), alpha)]
        assert closed(*values).dtype == dtype
        rates[f"closed form, JAX {name}"] = rate(closed, *values, count=count)
    measured = measure_throughput(resolve("exact/ps").functions("float")[-1])
    rates["closed form, exported C float32 (vectorised)"] = measured.compiled
    points = jnp.asarray(materials)
    for name, at in (("quick", quick_fraction_at), ("as fits use it", fraction_at)):
        angles = jax.jit(jax.vmap(lambda x, at=at: at(*x)))
        rates[f"closed form of angles, JAX float64, {name}"] = rate(angles, points, count=count)
    few = 64
    points = points[:few]
    integral = jax.jit(lambda x: jax.lax.map(lambda p: PS.quadrature(*p).value, x, batch_size=4))
    rates["quadrature of the definition, JAX 256²"] = rate(integral, points, count=few, repeat=3)
    view, weights = views()
    lights = directions(theta_u[:1024], phi[:1024])
    rates["quadrature of the definition, NumPy 64×128"] = rate(
        lambda: by_numpy(0.35, 0.7, lights, view, weights), count=1024, repeat=3
    )
    return rates


def startup(repeat: int = 7) -> dict:
    """Return the least time in s of an empty program and of commands that need no JAX."""
    command = "from shadefit.cli import main; main()"
    programs = {
        "python -c pass": ["-c", "pass"],
        "shadefit --help": ["-c", command, "--help"],
        "shadefit list": ["-c", command, "list"],
    }
    return {
        name: min(run([sys.executable, *arguments]).wall for _ in range(repeat))
        for name, arguments in programs.items()
    }


def show(found: dict) -> None:
    ours, theirs = found["refit"], found["plain"]
    print(f"load average at the start {found['load']:.2f} on {os.cpu_count()} processors\n")
    print(f"{'(a) the four tables of the paper, 65×65':<50} {'CPU s':>10} {'MiB':>6}")
    for name, side in (
        ("shadefit refit ps g q r", ours),
        ("NumPy and SciPy, no closed forms, extrapolated", theirs),
    ):
        print(f"    {name:<46} {side['seconds']:>10.1f} {side['mebibytes']:>6.0f}")
    print(f"    {'ratio':<46} {found['ratio']:>10.1f}")
    print("    of the plain side:")
    for name, seconds in theirs["parts"].items():
        print(f"        {name:<42} {seconds:>10.1f}")
    for name, value in theirs["notes"].items():
        print(f"        {name}: {', '.join(f'{each:.3g}' for each in np.ravel(value))}")
    print(f"\n{'(b) P_s':<46} {'evaluations/s':>14} {'to the last':>12}")
    last = list(found["throughput"].values())[-1]
    for name, each in found["throughput"].items():
        print(f"    {name:<42} {each:>14.4g} {each / last:>12.4g}")
    print(f"\n{'(c) start':<46} {'seconds':>14} {'to the first':>12}")
    first = next(iter(found["startup"].values()))
    for name, each in found["startup"].items():
        print(f"    {name:<42} {each:>14.3f} {each / first:>12.3g}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", action="store_true", help="print one JSON object instead")
    options = parser.parse_args()
    jax.config.update("jax_enable_x64", True)
    load = os.getloadavg()[0]
    with tempfile.TemporaryDirectory() as folder:
        ours = refit(Path(folder))
        surfaces(Path(folder) / "surfaces.npz")
        theirs = plain(Path(folder) / "surfaces.npz")
    found = {
        "load": load,
        "refit": ours,
        "plain": theirs,
        "ratio": theirs["seconds"] / ours["seconds"],
        "throughput": throughput(),
        "startup": startup(),
    }
    if options.json:
        print(json.dumps(found, indent=2))
    else:
        show(found)


if __name__ == "__main__":
    main()
