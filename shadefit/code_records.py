"""What `--json` prints of exported code and proofs: checks, costs and largest errors."""

from typing import Literal

from shadefit.records import Count, ErrorsRecord, Part, Place, Size, TableRecord


class CodeErrors(ErrorsRecord):
    """Errors of exported code; `not_finite` values are left out of them."""

    not_finite: Count


class CheckRecord(Part):
    """Exported code in one language and precision; `errors` are null if it was not run.

    `form`: the difference from the float64 form, `units` the same in units in the last place,
    `allowed` the largest `form` that passes, `integral` the difference from the exact values.
    """

    language: str
    precision: str
    status: Literal["passed", "failed", "not good enough", "not checked"]
    reason: str | None
    tool: str | None
    note: str | None
    form: CodeErrors | None
    units: CodeErrors | None
    allowed: CodeErrors | None
    integral: CodeErrors | None


class VerifiedTable(TableRecord):
    """A table with the checks of its exported code."""

    checks: list[CheckRecord]


class LargestErrorRecord(Part):
    """What is proven of a largest error.

    It is at least `lower`, at the point `at`, and at most
    `upper`, which is null if that is not proven. `boxes` were examined.
    """

    lower: Size
    at: Place
    upper: Size | None
    boxes: Count


class RoundingRecord(Part):
    """What float32 rounding adds to the error of exported code, at most.

    `upper` has the proven bounds by the name of the model of arithmetic; null if there is none.
    `measured` is the largest that was found at fixed points, in IEEE 754 arithmetic.
    """

    upper: dict[str, Size | None]
    measured: Size


class CertifiedTable(TableRecord):
    """A table with what is proven of its largest error; null if there is no closed form.

    It is `understated` if an error was found that is clearly above the one that the table states.
    With --rounding, `rounding` is proven instead.
    """

    state: Literal["proven", "refuted", "not proven", "sampled"]
    largest_error: LargestErrorRecord | None
    understated: bool
    rounding: RoundingRecord | None = None


class ThroughputRecord(Part):
    """Evaluations a second by compiled C and JAX, and the largest difference of their values."""

    compiled: Size
    jax: Size
    ratio: Size
    difference: Size
    points: Count
    compiler: str
    flags: list[str]


class FunctionRecord(Part):
    """The operations of an exported function, by kind."""

    function: str
    evaluated_for: str
    operations: Count
    weighted: Count
    kinds: dict[str, Count]
    throughput: ThroughputRecord | None


class CostedTable(TableRecord):
    """A table with its exported functions, and the closed form's if it is shown beside them."""

    functions: list[FunctionRecord]
