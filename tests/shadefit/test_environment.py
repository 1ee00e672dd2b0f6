"""Commands in hostile environments: neither bytes nor exit status change."""

import json
import os
import subprocess
import sys

import pytest

from coefficients.catalogue import path_of
from shadefit.environment import fix_environment

FIXED = {
    "JAX_ENABLE_X64": "1",
    "JAX_PLATFORMS": "cpu",
    "OPENBLAS_NUM_THREADS": "1",
    "NPROC": str(max(2, len(os.sched_getaffinity(0)))),
    "MPLBACKEND": "agg",
}
# Each of the first group changed numbers, or ended a command with a traceback or an abortion.
HOSTILE = {
    "JAX_PLATFORMS": "foo",
    "XLA_FLAGS": "--rubbish=1",
    "JAX_NUMPY_RANK_PROMOTION": "raise",
    "JAX_DISABLE_JIT": "1",
    "JAX_DEFAULT_MATMUL_PRECISION": "foo",
    "JAX_TRANSFER_GUARD": "disallow",
    "EQX_ON_ERROR": "foo",
    "JAX_ENABLE_X64": "0",
    "JAX_NUMPY_DTYPE_PROMOTION": "strict",
    "JAX_DEBUG_NANS": "1",
    "OPENBLAS_CORETYPE": "Prescott",
    "NPROC": "1",
    "NPY_DISABLE_CPU_FEATURES": "AVX2",
    "MPLBACKEND": "rubbish",
}
ENCODINGS = [
    {"PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0", "LC_ALL": "C"},
    {"PYTHONUTF8": "0", "LC_ALL": "en_US.ISO-8859-1"},
    *({"PYTHONIOENCODING": each} for each in ("ascii", "latin-1", "cp1252", "utf-16")),
]


def shadefit(folder, *arguments, **environment):
    """Run a command in a folder; returns its exit status, output, messages and files."""
    before = set(folder.iterdir())
    clean = {key: value for key, value in os.environ.items() if not key.startswith(("JAX", "XLA"))}
    done = subprocess.run(
        [sys.executable, "-m", "shadefit", *arguments],
        cwd=folder,
        env={**clean, "PYTHONPATH": os.pathsep.join(sys.path), **environment},
        capture_output=True,
        check=False,
    )
    new = [path for path in folder.iterdir() if path.is_file() and path not in before]
    made = {path.name: path.read_bytes() for path in new}
    for path in new:
        path.unlink()
    return done.returncode, done.stdout, done.stderr, made


def test_variables_that_change_numbers_are_fixed_and_others_stay():
    others = {"HOME": "/", "JAX_COMPILATION_CACHE_DIR": "/c", "JAX_PERSISTENT_CACHE_MIN_SIZE": "1"}
    flags = "--xla_cpu_enable_fast_math=true --xla_force_host_platform_device_count=2 rubbish"
    given = {**HOSTILE, **others, "XLA_FLAGS": flags}
    fix_environment(given)
    devices = "--xla_force_host_platform_device_count=2"
    assert given == {**others, **FIXED, "XLA_FLAGS": devices}
    fix_environment(given)
    assert given["XLA_FLAGS"] == devices
    bare = {}
    fix_environment(bare)
    assert bare == FIXED


@pytest.mark.parametrize("size", ["0", "²", "10000000"])
def test_a_terminal_of_no_possible_size_loses_no_output(tmp_path, size):
    """The first made tables empty, the second was an error, and the third gave 270 MB of spaces."""
    given = {"COLUMNS": size, "LINES": size}
    for command in (["list"], ["cost", "--help"]):
        status, out, err, _ = shadefit(tmp_path, *command, **given)
        assert (status, err) == (0, b"") and 100 < len(out) < 20_000


@pytest.mark.parametrize("limit", [5, 6, 8])
def test_too_few_files_end_a_command_in_one_line(limit):
    command = f"ulimit -n {limit}; exec {sys.executable} -m shadefit list --json"
    done = subprocess.run(
        ["sh", "-c", command],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode == 0:
        assert limit > 5 and json.loads(done.stdout) and not done.stderr
    else:
        assert done.returncode == 2
        assert done.stderr.startswith("shadefit: ") and done.stderr.count("\n") == 1


def test_all_hostile_variables_together_end_no_command(tmp_path):
    status, out, err, made = shadefit(tmp_path, "cost", "q", "--json", **HOSTILE)
    assert (status, err, made) == (0, b"", {})
    assert [each["operations"] for each in json.loads(out)["tables"][0]["functions"]] == [6]


@pytest.mark.slow
@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_variable_changes_no_byte(tmp_path, name, exported):
    value = HOSTILE[name]
    assert shadefit(tmp_path, "export", "q", "--to", "c", "-o", "q.c", **{name: value}) == exported


@pytest.mark.slow
@pytest.mark.parametrize("environment", ENCODINGS, ids=lambda each: "-".join(each.values()))
def test_an_encoding_changes_no_byte_of_a_file(tmp_path, environment, exported):
    command = ("export", "q", "--to", "c", "-o", "q.c")
    assert shadefit(tmp_path, *command, **environment) == exported
    status, out, err, _ = shadefit(tmp_path, "list", **environment)
    assert (status, err) == (0, b"") and len(out) > 1000


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    folder = tmp_path_factory.mktemp("clean")
    found = shadefit(folder, "export", "q", "--to", "c", "-o", "q.c")
    assert found[0] == 0 and found[3]["q.c"].startswith(b"// SPDX")
    return found


@pytest.mark.slow
def test_one_processor_refits_the_same_bytes_as_several(tmp_path):
    processors = os.sched_getaffinity(0)
    try:
        os.sched_setaffinity(0, [min(processors)])
        status, _, err, _ = shadefit(tmp_path, "refit", "g", "--out", "made")
    finally:
        os.sched_setaffinity(0, processors)
    assert (status, err) == (0, b"")
    assert (tmp_path / "made" / "g.json").read_bytes() == path_of("g").read_bytes()


@pytest.mark.slow
def test_settings_of_matplotlib_in_the_folder_change_no_picture(tmp_path):
    command = ("figures", "figure-6", "--out", "made")
    clean = drawn(tmp_path, *command)
    (tmp_path / "matplotlibrc").write_text("font.size: 20\nsvg.fonttype: none\nbackend: foo\n")
    assert drawn(tmp_path, *command, MPLBACKEND="rubbish") == clean
    assert sorted(clean) == ["figure-6.png", "figure-6.svg"]


def drawn(folder, *command, **environment):
    assert shadefit(folder, *command, **environment, MPLCONFIGDIR=str(folder))[0] == 0
    return {path.name: path.read_bytes() for path in (folder / "made").iterdir()}
