"""Measuring a function's throughput: its evaluations per second in compiled C and in JAX."""

import ctypes
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from programs.functions import Function, group_inputs
from programs.printing.printer import write_source
from programs.toolchains.calling import call_statements
from programs.toolchains.interface import compile_failure, result_count
from programs.toolchains.process import (
    ToolchainError,
    execute,
    first_line,
    missing_command,
    workspace,
)

# The last two flags say that sqrtf need not set errno or raise floating-point exceptions. Otherwise
# gcc does not vectorize loops over it, while XLA does.
FLAGS = ("-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math")


@dataclass(frozen=True)
class Throughput:
    """Evaluations per second in float32: compiled C on one thread, JAX on any number of threads.

    `difference` is the largest difference between their results.
    """

    compiled: float
    jax: float
    points: int
    difference: float
    compiler: str
    flags: tuple[str, ...]

    @property
    def ratio(self) -> float:
        """The throughput of compiled C divided by that of the jitted JAX function."""
        return self.compiled / self.jax


def measure_throughput(
    function: Function,
    points: int = 1 << 17,
    rounds: int = 9,
    flags: tuple[str, ...] = FLAGS,
    rows: np.ndarray | None = None,
) -> Throughput:
    """Measure the exported C and the jitted JAX function on the same data, in turn.

    Arguments: `function`; `points`, the number of random points of its domain; `rounds`, how often
    each is timed (the fastest time counts); `flags` for gcc; `rows` (n, k), the inputs in
    place of random ones, a column for each of `input_names`. Returns the measurement. Raises
    ValueError when gcc is missing and when the code does not compile.
    """
    if points < 1 or rounds < 1:
        raise ValueError(f"points {points} and rounds {rounds}; allowed: at least 1 each")
    reason = missing_command("gcc", "gcc")
    if reason is not None:
        raise ValueError(reason)
    if rows is None:
        inputs = _random_inputs(function, points)
    else:
        inputs, points = np.ascontiguousarray(rows.T, np.float32), len(rows)
    with workspace() as folder:
        compiled = _compile(function, folder, flags)
        # Coefficients are float64 constants. Without x64, JAX computes in float32 all the same.
        with jax.enable_x64(False):
            batched = jax.jit(jax.vmap(lambda *row: function.call(*group_inputs(function, row))))
            columns = [jnp.asarray(column) for column in inputs]
            expected = np.stack(jax.tree.leaves(batched(*columns)))
            given = compiled(inputs)
            times = [
                (_seconds(lambda: compiled(inputs)), _seconds(lambda: _wait(batched, columns)))
                for _ in range(rounds)
            ]
    in_c, in_jax = (points / min(each) for each in zip(*times, strict=True))
    difference = float(np.max(np.abs(given - expected)))
    return Throughput(in_c, in_jax, points, difference, first_line("gcc", "--version"), flags)


def _random_inputs(function: Function, points: int) -> np.ndarray:
    bounds = []
    for parameter in function.parameters:
        bounds += [parameter.domain] * (1 if parameter.size is None else parameter.size)
    low, high = np.array(bounds, np.float64).T[:, :, None]
    unit = np.random.default_rng(0).random((len(bounds), points))
    return (low + (high - low) * unit).astype(np.float32)


def _compile(
    function: Function, folder: Path, flags: tuple[str, ...]
) -> Callable[[np.ndarray], np.ndarray]:
    source, library = folder / "function.c", folder / "function.so"
    source.write_text(write_source(function, "c") + _driver(function), encoding="utf-8")
    # The function is inlined into the loop, as a renderer would do.
    inlined = ("-fno-semantic-interposition", "-finline-limit=100000")
    command = ["gcc", *flags, *inlined, "-shared", "-fPIC", source, "-o", library, "-lm"]
    try:
        execute(command, failure=compile_failure("C", function, "float"))
    except ToolchainError as error:
        complaint = next((line for line in error.log.splitlines() if "error" in line), "")
        raise ValueError(f"{error.summary} {complaint}".strip()) from error
    try:
        run = ctypes.CDLL(str(library)).evaluate_all
    except OSError as error:
        raise ValueError(f"what gcc made is no library: {error}") from error
    pointer = np.ctypeslib.ndpointer(np.float32, ndim=2, flags="C_CONTIGUOUS")
    run.argtypes, run.restype = [ctypes.c_long, pointer, pointer], None
    height = result_count(function)

    def evaluate(inputs: np.ndarray) -> np.ndarray:
        outputs = np.empty((height, inputs.shape[1]), np.float32)
        run(inputs.shape[1], inputs, outputs)
        return outputs

    return evaluate


def _driver(function: Function) -> str:
    """Write the loop over all points; the array of inputs has one row for each input."""
    body = call_statements(
        function,
        "float",
        lambda row: f"in[{row} * n + i]",
        lambda row: f"out[{row} * n + i] = shadefit_value[{row}];",
        depth=8,
    )
    return (
        "\nvoid evaluate_all(long n, const float *restrict in, float *restrict out)\n{\n"
        f"    for (long i = 0; i < n; ++i) {{\n{body}\n    }}\n}}\n"
    )


def _wait(batched: Callable, columns: list[jax.Array]) -> None:
    jax.block_until_ready(batched(*columns))


def _seconds(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start
