"""What a function costs: its operations, by kind, and how many evaluations a second it gives."""

import ctypes
import shutil
import subprocess
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Collection
from dataclasses import dataclass, fields
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from coefficients.printer import write
from programs.function import Function, group_inputs
from programs.operations import OPERATIONS
from programs.program import Program, is_value

# What an operation of each kind weighs against an addition: a rule of thumb for graphics hardware,
# where reciprocals, roots and transcendental functions run at a quarter of the rate, a division is
# a reciprocal and a product, a function is one such instruction with its scaling, and a sign is
# part of the operation that takes it.
WEIGHTS = {"add": 1, "mul": 1, "div": 5, "sqrt": 4, "transcendental": 8, "select": 1, "sign": 0}

# sqrtf need not set errno, and no one catches its exceptions: without these two, loops over it are
# not vectorised, which XLA does with its own.
FLAGS = ("-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math")


@dataclass(frozen=True)
class Cost:
    """Operations by kind.

    `add` counts additions and subtractions, `select` comparisons, selections, minima, maxima and
    roundings to whole numbers, `sign` negations and absolute values. `fma` counts the additions
    that could take up a product that nothing else uses: they are counted under `add` and `mul` too.
    """

    add: int = 0
    mul: int = 0
    div: int = 0
    sqrt: int = 0
    transcendental: int = 0
    select: int = 0
    sign: int = 0
    fma: int = 0

    @property
    def operations(self) -> int:
        """All operations but signs, each counted once."""
        return sum(getattr(self, kind) for kind in WEIGHTS if kind != "sign")

    @property
    def weighted(self) -> int:
        """All operations, each with its entry in WEIGHTS."""
        return sum(weight * getattr(self, kind) for kind, weight in WEIGHTS.items())


def count(program: Program, varying: Collection[str] | None = None) -> Cost:
    """Count the operations of a program.

    Arguments: `program`; `varying`, names of inputs (`alpha`; `c` for all of an array `c[0]`, …):
    only operations that depend on one of them are counted, as those of a material are not when
    they are done once for many directions. Returns the counts. Raises ValueError for a name that
    is no input.
    """
    changing = _changing(program, varying)
    uses = Counter(o for step in program.steps for o in step.operands if is_value(o))
    uses.update(o for o in program.outputs if is_value(o))
    first = len(program.inputs)
    products = {
        value
        for value, step in enumerate(program.steps, start=first)
        if step.operation == "mul" and uses[value] == 1
    }
    kinds: Counter[str] = Counter()
    for value, step in enumerate(program.steps, start=first):
        if value not in changing:
            continue
        kinds[OPERATIONS[step.operation].kind] += 1
        operands = {operand for operand in step.operands if is_value(operand)}
        if step.operation in ("add", "sub") and not products.isdisjoint(operands):
            kinds["fma"] += 1
    return Cost(**{field.name: kinds[field.name] for field in fields(Cost)})


def _changing(program: Program, varying: Collection[str] | None) -> set[int]:
    if varying is None:
        return set(range(len(program.inputs) + len(program.steps)))
    arrays = [name.partition("[")[0] for name in program.inputs]
    for name in varying:
        if name not in arrays and name not in program.inputs:
            allowed = ", ".join(dict.fromkeys(arrays))
            raise ValueError(f"{name!r} is no input of {program.name}; allowed: {allowed}")
    changing = {
        number
        for number, (name, array) in enumerate(zip(program.inputs, arrays, strict=True))
        if name in varying or array in varying
    }
    for value, step in enumerate(program.steps, start=len(program.inputs)):
        if not changing.isdisjoint(o for o in step.operands if is_value(o)):
            changing.add(value)
    return changing


@dataclass(frozen=True)
class Throughput:
    """Evaluations a second in float32: compiled C on one thread, and JAX on as many as it takes.

    `difference` is the largest difference between the two in what they gave.
    """

    compiled: float
    jax: float
    points: int
    difference: float
    compiler: str
    flags: tuple[str, ...]

    @property
    def ratio(self) -> float:
        """How many times as fast the compiled C is as the jitted JAX function."""
        return self.compiled / self.jax


def throughput(
    function: Function, points: int = 1 << 17, rounds: int = 9, flags: tuple[str, ...] = FLAGS
) -> Throughput:
    """Measure the exported C and the jitted JAX function on the same data, turn by turn.

    Arguments: `function`; `points`, how many random points of its domain an evaluation takes;
    `rounds`, how often each is timed (the fastest counts); `flags` for gcc. Returns the figures.
    Raises ValueError when there is no gcc, or when the code does not compile.
    """
    if points < 1 or rounds < 1:
        raise ValueError(f"points {points} and rounds {rounds}; allowed: at least 1 each")
    inputs = _random_inputs(function, points)
    with tempfile.TemporaryDirectory() as folder:
        compiled = _compile(function, Path(folder), flags)
        # Coefficients are float64 constants: in a float32 world they do not widen the arithmetic.
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
    compiler = _gcc("--version").splitlines()[0]
    difference = float(np.max(np.abs(given - expected)))
    return Throughput(in_c, in_jax, points, difference, compiler, flags)


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
    source.write_text(write(function, "c") + _driver(function), encoding="utf-8")
    # The function is to be measured inside the loop, as a renderer would inline it.
    inlined = ("-fno-semantic-interposition", "-finline-limit=100000")
    _gcc(
        *flags,
        *inlined,
        "-shared",
        "-fPIC",
        str(source),
        "-o",
        str(library),
        "-lm",
    )
    run = ctypes.CDLL(str(library)).evaluate_all
    pointer = np.ctypeslib.ndpointer(np.float32, ndim=2, flags="C_CONTIGUOUS")
    run.argtypes, run.restype = [ctypes.c_long, pointer, pointer], None
    height = 1 if function.result is None else function.result

    def evaluate(inputs: np.ndarray) -> np.ndarray:
        outputs = np.empty((height, inputs.shape[1]), np.float32)
        run(inputs.shape[1], inputs, outputs)
        return outputs

    return evaluate


def _driver(function: Function) -> str:
    """Write the loop over all points: one row of inputs after the other, and so the outputs."""
    arguments, before, row = [], "", 0
    for parameter in function.parameters:
        if parameter.size is None:
            arguments.append(f"in[{row} * n + i]")
        else:
            cells = ", ".join(f"in[{row + j} * n + i]" for j in range(parameter.size))
            before += f"        const float in_{row}[{parameter.size}] = {{{cells}}};\n"
            arguments.append(f"in_{row}")
        row += 1 if parameter.size is None else parameter.size
    call = f"{function.name}({', '.join(arguments)})"
    body = f"        out[i] = {call};\n"
    if function.result is not None:
        call = f"{function.name}({', '.join([*arguments, 'results'])})"
        body = f"        float results[{function.result}];\n        {call};\n"
        body += "".join(
            f"        out[{j} * n + i] = results[{j}];\n" for j in range(function.result)
        )
    return (
        "\nvoid evaluate_all(long n, const float *restrict in, float *restrict out)\n{\n"
        f"    for (long i = 0; i < n; ++i) {{\n{before}{body}    }}\n}}\n"
    )


def _gcc(*arguments: str) -> str:
    if shutil.which("gcc") is None:
        raise ValueError("gcc is not on PATH; allowed: a C compiler of that name (Debian: gcc)")
    done = subprocess.run(
        ["gcc", *arguments], capture_output=True, text=True, timeout=300, check=False
    )
    if done.returncode != 0:
        errors = [line for line in done.stderr.splitlines() if "error" in line]
        raise ValueError(f"gcc failed: {(errors or ['it says not why'])[0].strip()}")
    return done.stdout


def _wait(batched: Callable, columns: list[jax.Array]) -> None:
    jax.block_until_ready(batched(*columns))


def _seconds(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start
