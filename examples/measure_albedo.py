"""Write albedo.csv: the directional albedo of GGX by Monte Carlo, as if it had been measured.

python examples/measure_albedo.py
"""

from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

ROWS, SAMPLES = 600, 4096


def weight(mu, alpha, u):
    """G₂/G₁ of the direction that a sampled visible normal reflects the view to; 0 below ground."""
    view = jnp.array([jnp.sqrt(1 - mu * mu), 0.0, mu])
    # The view of the stretched hemisphere, and a normal that it sees (Heitz 2018).
    v = view * jnp.array([alpha, alpha, 1.0])
    v = v / jnp.linalg.norm(v)
    t1 = jnp.array([0.0, 1.0, 0.0])
    t2 = jnp.cross(v, t1)
    r, phi = jnp.sqrt(u[0]), 2 * jnp.pi * u[1]
    x, y = r * jnp.cos(phi), r * jnp.sin(phi)
    y = (1 - (1 + v[2]) / 2) * jnp.sqrt(1 - x * x) + (1 + v[2]) / 2 * y
    n = x * t1 + y * t2 + jnp.sqrt(jnp.maximum(1 - x * x - y * y, 0)) * v
    n = n * jnp.array([alpha, alpha, 1.0])
    n = n / jnp.linalg.norm(n)
    nu = (2 * (view @ n) * n - view)[2]

    def masked(c):
        return (jnp.sqrt(1 + alpha**2 * (1 / (c * c) - 1)) - 1) / 2

    light = masked(jnp.where(nu > 0, nu, 1.0))
    return jnp.where(nu > 0, (1 + masked(mu)) / (1 + masked(mu) + light), 0.0)


def main():
    jax.config.update("jax_enable_x64", True)
    rng = np.random.default_rng(20201128)
    mu, alpha = rng.uniform(0.02, 1, ROWS), rng.uniform(0.05, 1, ROWS)
    u = rng.random((ROWS, SAMPLES, 2))
    drawn = jax.jit(jax.vmap(jax.vmap(weight, (None, None, 0))))(mu, alpha, u)
    mean = drawn.mean(axis=1)
    error = drawn.std(axis=1, ddof=1) / np.sqrt(SAMPLES)
    lines = ["NdotV,alpha,E,sigma"]
    for row in zip(mu, alpha, mean, np.maximum(error, 1e-5), strict=True):
        lines.append(",".join(f"{number:.6g}" for number in row))
    Path(__file__).with_name("albedo.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
