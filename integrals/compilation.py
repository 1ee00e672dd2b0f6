"""Compilation of functions that are called a few times, where compiling takes longer than running.

XLA then compiles in half the time. The code that it makes is about as fast for functions that spend
their time in roots, exponentials and divisions, and up to twice as slow for others.
"""

import functools
from collections.abc import Callable, Sequence
from typing import Any

import jax

# Options of XLA. Its newer emitters of fused loops, LLVM's last optimisations, and the division of
# a module among several threads of the compiler take most of the time.
FEW_CALLS = {
    "xla_cpu_use_fusion_emitters": False,
    "xla_backend_optimization_level": 1,
    "xla_cpu_parallel_codegen_split_count": 1,
}


def jit_for_few_calls(
    function: Callable[..., Any] | None = None, *, static: Sequence[int] = ()
) -> Callable[..., Any]:
    """Compile a function by `jax.jit` with the options for few calls; also a decorator.

    `static` are the positions of the arguments that JAX does not trace. Call the result with
    arrays: it cannot be called inside a function that JAX traces.
    """
    if function is None:
        return functools.partial(jit_for_few_calls, static=static)
    return jax.jit(function, static_argnums=tuple(static), compiler_options=FEW_CALLS)
