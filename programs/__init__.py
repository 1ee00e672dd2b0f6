"""Straight-line programs: a JAX function of scalars, written as one operation after the other.

A program is traced from the jaxpr of a function. The same program is printed as shader code, its
operations are counted, and its values are bounded on whole boxes. Nothing here knows which quantity
a function computes.

* `tracing`: from a JAX function to a program
* `bounding`: proofs by interval arithmetic
* `printing` and `languages`: source code, and how each language is spelled
* `toolchains`: compiling, running, verifying and timing the code

The names below are the public ones. They are imported when they are first used, so that a
program that needs only `programs.rounded_text` waits neither for JAX nor for NumPy.
"""

from typing import TYPE_CHECKING

from programs.public_names import import_when_used

if TYPE_CHECKING:
    from programs.bounding.branch_and_bound import Bounds as Bounds
    from programs.bounding.branch_and_bound import BranchAndBound as BranchAndBound
    from programs.bounding.denominators import DenominatorBound as DenominatorBound
    from programs.bounding.denominators import bound_below as bound_below
    from programs.bounding.denominators import prove_no_pole as prove_no_pole
    from programs.cost import KINDS as KINDS
    from programs.cost import Cost as Cost
    from programs.cost import count_operations as count_operations
    from programs.functions import Function as Function
    from programs.functions import Parameter as Parameter
    from programs.functions import Record as Record
    from programs.functions import function as function
    from programs.functions import group_inputs as group_inputs
    from programs.functions import input_names as input_names
    from programs.languages import LANGUAGES as LANGUAGES
    from programs.languages import Language as Language
    from programs.languages import language as language
    from programs.languages import precision_of as precision_of
    from programs.operations import OPERATIONS as OPERATIONS
    from programs.precision import PRECISIONS as PRECISIONS
    from programs.printing.printer import write_source as write_source
    from programs.program import Program as Program
    from programs.program import Step as Step
    from programs.program import evaluate as evaluate
    from programs.program import interpret as interpret
    from programs.program import is_value as is_value
    from programs.program import reachable_values as reachable_values
    from programs.program import subprogram as subprogram
    from programs.toolchains.difference import Difference as Difference
    from programs.toolchains.process import ToolchainError as ToolchainError
    from programs.toolchains.registry import toolchain as toolchain
    from programs.toolchains.throughput import Throughput as Throughput
    from programs.toolchains.throughput import measure_throughput as measure_throughput
    from programs.toolchains.verification import CallSequence as CallSequence
    from programs.toolchains.verification import Check as Check
    from programs.toolchains.verification import Trial as Trial
    from programs.toolchains.verification import check as check
    from programs.tracing.tracer import trace as trace

__getattr__, __dir__, __all__ = import_when_used(
    __name__,
    {
        "programs.bounding.branch_and_bound": ("Bounds", "BranchAndBound"),
        "programs.bounding.denominators": ("DenominatorBound", "bound_below", "prove_no_pole"),
        "programs.cost": ("KINDS", "Cost", "count_operations"),
        "programs.functions": (
            "Function",
            "Parameter",
            "Record",
            "function",
            "group_inputs",
            "input_names",
        ),
        "programs.languages": ("LANGUAGES", "Language", "language", "precision_of"),
        "programs.operations": ("OPERATIONS",),
        "programs.precision": ("PRECISIONS",),
        "programs.printing.printer": ("write_source",),
        "programs.program": (
            "Program",
            "Step",
            "evaluate",
            "interpret",
            "is_value",
            "reachable_values",
            "subprogram",
        ),
        "programs.toolchains.difference": ("Difference",),
        "programs.toolchains.process": ("ToolchainError",),
        "programs.toolchains.registry": ("toolchain",),
        "programs.toolchains.throughput": ("Throughput", "measure_throughput"),
        "programs.toolchains.verification": ("CallSequence", "Check", "Trial", "check"),
        "programs.tracing.tracer": ("trace",),
    },
)
