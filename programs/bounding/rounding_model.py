"""Models of float32 arithmetic: how far the result of each operation is from the exact one.

An error is stated in units in the last place of the exact result (ULP). One ULP is at most 2^-23
times the result, and half of it is what an operation that rounds to nearest is wrong by.
"""

from collections.abc import Mapping
from dataclasses import dataclass

# One unit in the last place, over the number
ULP = 2.0**-23


@dataclass(frozen=True)
class OperationError:
    """The largest error of an operation: ulps + ulps_of_argument·|x| units, plus `absolute`."""

    ulps: float = 0.0
    ulps_of_argument: float = 0.0
    absolute: float = 0.0

    @property
    def none(self) -> bool:
        """Whether the operation is exact."""
        return self == OperationError()


@dataclass(frozen=True)
class RoundingModel:
    """The errors of all operations. An operation that is not in `errors` has no known bound.

    `arithmetic` is a text for headers.
    """

    name: str
    arithmetic: str
    errors: Mapping[str, OperationError]


_EXACT = dict.fromkeys(
    ("neg", "abs", "min", "max", "select", "lt", "le", "gt", "ge", "eq", "ne", "and", "or", "not"),
    OperationError(),
)
_NEAREST = dict.fromkeys(("add", "sub", "mul", "div", "sqrt"), OperationError(0.5))
_LIBRARY = {
    **dict.fromkeys(
        ("exp", "exp2", "expm1", "log", "log1p", "pow", "sin", "cos", "tan"), OperationError(1.0)
    ),
    **dict.fromkeys(("asin", "acos", "atan", "atan2"), OperationError(1.0)),
    **dict.fromkeys(("sinh", "cosh", "tanh"), OperationError(2.0)),
}
# IEEE 754 rounds the five operations of the second line to nearest. A root that divides one is
# rounded twice. The functions of the C library are not part of that standard: glibc states these
# errors in its manual, in the chapter on known maximum errors.
IEEE = RoundingModel(
    "ieee",
    "IEEE 754 arithmetic, functions within 1 ULP",
    {**_EXACT, **_NEAREST, "rsqrt": OperationError(1.0), **_LIBRARY},
)
# The table "Precision of core SPIR-V instructions" of the Vulkan specification. Sums and products
# are "correctly rounded", but the direction is not specified, so this is one unit. A root is
# 1/inversesqrt: 2 and 2.5 units, and their product. A sine or cosine has an absolute error, for
# arguments in [−π, π].
VULKAN = RoundingModel(
    "vulkan",
    "what Vulkan allows",
    {
        **_EXACT,
        **dict.fromkeys(("add", "sub", "mul"), OperationError(1.0)),
        "div": OperationError(2.5),
        "sqrt": OperationError(4.75),
        "rsqrt": OperationError(2.0),
        **dict.fromkeys(("exp", "exp2"), OperationError(3.0, 2.0)),
        "log": OperationError(3.0, absolute=2.0**-21),
        **dict.fromkeys(("sin", "cos"), OperationError(absolute=2.0**-11)),
    },
)
MODELS: dict[str, RoundingModel] = {model.name: model for model in (IEEE, VULKAN)}
