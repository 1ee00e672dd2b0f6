"""Float64 for every test, as the entry points set it; the same drawn examples in every run."""

import jax
from hypothesis import settings

jax.config.update("jax_enable_x64", True)

# A run that fails must fail again on the next machine. `--hypothesis-profile default` draws others.
settings.register_profile("repeatable", derandomize=True)
settings.load_profile("repeatable")
