"""Float64 for every test, as the entry points set it."""

import jax

jax.config.update("jax_enable_x64", True)
