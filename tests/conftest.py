"""Float64 for every test, as the entry points set it; the same drawn examples in every run."""

import jax
import pytest
from hypothesis import settings

jax.config.update("jax_enable_x64", True)

# A run that fails must fail again on the next machine. `--hypothesis-profile default` draws others.
settings.register_profile("repeatable", derandomize=True)
settings.load_profile("repeatable")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Call every test in a browser slow, since the page takes half a minute to make."""
    for item in items:
        if "browser" in getattr(item, "fixturenames", ()):
            item.add_marker(pytest.mark.slow)
