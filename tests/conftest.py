"""Float64 for every test, as the entry points set it; the same drawn examples in every run."""

import os
import re

# Most tests run what they compile once. With these, XLA compiles in two thirds of the time, and its
# code is slower. Commands that tests start as processes of their own are compiled as usual.
_given = os.environ.pop("XLA_FLAGS", None)
os.environ["XLA_FLAGS"] = (
    "--xla_backend_optimization_level=1 --xla_cpu_use_fusion_emitters=false "
    "--xla_cpu_parallel_codegen_split_count=1"
)

import jax  # noqa: E402
import pytest  # noqa: E402
from hypothesis import settings  # noqa: E402

from shadefit import memory  # noqa: E402

jax.config.update("jax_enable_x64", True)
# XLA reads them when it compiles for the first time.
jax.jit(lambda x: x + 1)(0.0)
del os.environ["XLA_FLAGS"]
if _given is not None:
    os.environ["XLA_FLAGS"] = _given
# Commands that tests start leave the user's cache of compiled programs alone.
os.environ["SHADEFIT_CACHE"] = "off"

SLOW_NAMES = re.compile(
    r"skin-(cylinder-(green|blue)|sphere-(red|green|blue)|lobe|band)|63-rising|sggx-filter|ggx-(scale|bias)"
)
# Of the best tables, these stand for all in sweeps: one for each kind of form.
STANDING_FOR_ALL = re.compile(
    r"best/(q-9|q-12-log|g-17|g-19|r-25|ps-11|ps-25|ps-40|ggx-directional-albedo-57|"
    r"ggx-average-albedo-18|ggx-average-albedo-20-log|skin-cylinder-red-63)(?![a-z0-9-]*(wide|log))"
)
# Tests that do the same work for each table. That the statements of every table are true is among
# the default tests (test_a_table_has_the_errors_and_the_range_that_it_states).
SWEEPS = (
    "test_a_packaged_table_can_be_evaluated_without_this_project",
    "test_a_table_is_certified_anew",
    "test_a_table_is_measured_anew",
    "test_a_table_that_is_written_and_read_is_the_same",
    "test_compiled_code_gives_a_value_of_the_codomain_even_for_nan",
    "test_every_finite_argument_gives_a_value_of_the_codomain",
    "test_export_prints_what_a_name_stands_for",
    "test_no_denominator_at_a_sample_is_below_the_stated_bound",
    "test_the_code_that_is_exported_is_the_form_that_was_fitted",
    "test_the_largest_error_is_not_overstated",
    "test_the_range_of_a_table_is_proven_anew",
)

# If a process of tests is larger than this, in bytes, the next module of tests begins without the
# programs that others compiled. A process of the slow tests would grow to 5 GB.
LARGEST_START = 2_000_000_000
# What is left then may be large too. So much more is compiled before it is dropped again.
GROWTH = 1_000_000_000
_left = [0]


@pytest.fixture(scope="module", autouse=True)
def _memory_of_other_modules():
    """Drop what other modules compiled, if it takes much memory."""
    if (memory.resident() or 0) > max(LARGEST_START, _left[-1] + GROWTH):
        memory.give_back(kept_below=0)
        _left.append(memory.resident() or 0)


# A run that fails must fail again on the next machine. `--hypothesis-profile default` draws others.
settings.register_profile("repeatable", derandomize=True)
settings.load_profile("repeatable")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Call slow what takes long, or what another test stands for.

    The page of tests in a browser takes half a minute to make. The quantities of skin are much
    alike: by default, red light on a cylinder stands for all. The exact values of filtered lobes,
    and of A and B of GGX, take long to compile. Of a sweep over all best tables, some stand for the
    others.
    """
    for item in items:
        is_slow = "browser" in getattr(item, "fixturenames", ()) or SLOW_NAMES.search(item.name)
        swept = item.name.startswith(SWEEPS) and "[best/" in item.name
        if is_slow or (swept and not STANDING_FOR_ALL.search(item.name)):
            item.add_marker(pytest.mark.slow)
