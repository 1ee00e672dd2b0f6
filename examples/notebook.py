"""A notebook's cells: fit a function, look at the result, take its code.

python examples/notebook.py, or open it in an editor that runs cells.
"""

# %%
import jax.numpy as jnp

from shadefit import Axis, Problem, closed_form

p = Problem("tanhc", [Axis("x", 0, 4)], closed_form(jnp.tanh))
p.form(lambda x, a, b, c: x * (a + b * x * x) / (1 + c * x * x), name="pade", start=[1, 0.1, 0.4])
result = p.fit("pade", norm="linf")
print(result)

# %%
print(result.coefficients, result.errors.largest, result.least_error, result.second_opinion())

# %%
print(result.code("hlsl"))
