"""Float64 for every test, as the entry points set it; the same drawn examples in every run."""

import re

import jax
import pytest
from hypothesis import settings

jax.config.update("jax_enable_x64", True)

SLOW_NAMES = re.compile(
    r"skin-(cylinder-(green|blue)|sphere-(red|green|blue)|lobe|band)|63-rising|sggx-filter|ggx-(scale|bias)"
)

# A run that fails must fail again on the next machine. `--hypothesis-profile default` draws others.
settings.register_profile("repeatable", derandomize=True)
settings.load_profile("repeatable")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Call slow what takes long, or what another test stands for.

    The page of tests in a browser takes half a minute to make. The quantities of skin are
    much alike: by default, red light on a cylinder stands for all. The exact values of filtered
    lobes, and of A and B of GGX, take long to compile.
    """
    for item in items:
        if "browser" in getattr(item, "fixturenames", ()) or SLOW_NAMES.search(item.name):
            item.add_marker(pytest.mark.slow)
