"""The parts of a table: its arguments, errors, proofs and origin. This module needs no JAX."""

import unicodedata
from typing import Annotated, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from fitting.goal import Norm, Rounding, Side

# An expression has at most this many steps.
MAX_STEPS = 4096

Number = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[Number, Field(gt=0)]
# Text is shown on terminals and in comments of code. It must not have control codes, line breaks,
# characters without width, or characters that change the direction of writing.
UNSEEN = r"\x00-\x1f\x7f-\x9f\u061c\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff"
# Letters, marks and signs that show nothing either
BLANK = "\u034f\u115f\u1160\u17b4\u17b5\u180b\u180c\u180d\u180f\u2800\u3164\uffa0"


def _visible(text: str) -> str:
    for character in text:
        # Control and format characters, surrogates, and variation selectors
        kind, code = unicodedata.category(character), ord(character)
        selector = 0xFE00 <= code <= 0xFE0F or 0xE0100 <= code <= 0xE01EF
        if kind in ("Cc", "Cf", "Cs") or character in BLANK or selector:
            raise ValueError(f"character U+{code:04X} cannot be seen")
    return text


Text = Annotated[str, Field(max_length=2000, pattern=f"^[^{UNSEEN}]*$"), AfterValidator(_visible)]
Name = Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9._-]{0,63}$")]
# In the JSON Schema: no keys are allowed that do not match the pattern of the keys.
_CLOSED = Field(json_schema_extra={"additionalProperties": False})
Vector = Annotated[list[Number], Field(max_length=4096)]
Row = Annotated[list[Number], Field(min_length=1, max_length=4096)]
Labels = Annotated[list[Text], Field(max_length=4096)]
LabelRow = Annotated[list[Text], Field(min_length=1, max_length=4096)]
Pair = Annotated[list[int], Field(min_length=2, max_length=2)]
# The arguments of a family's function, which identify a form (checked by quantities/family.py).
Shape = Annotated[
    dict[Name, int | Number | Text | Annotated[list[Pair], Field(max_length=64)]], _CLOSED
]


Operand = Number | Annotated[str, Field(max_length=64)]
Identifier = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]{0,63}$")]


class Part(BaseModel):
    """A part of a JSON object: it has no other keys, and its values are not converted."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Argument(Part):
    """One argument: its name, its unit ('rad' or '1'), and its domain, a closed interval.

    `symbol` is the argument's symbol in the equation, if that is not the name.
    """

    name: Text
    symbol: Text | None = None
    unit: Literal["1", "rad"]
    domain: Annotated[list[Number], Field(min_length=2, max_length=2)]

    @model_validator(mode="after")
    def _ordered(self):
        if not self.domain[0] < self.domain[1]:
            raise ValueError(f"domain {self.domain} is empty")
        return self


class Nodes(Part):
    """The fitting grid along one argument."""

    argument: Text
    count: Annotated[int, Field(ge=2)]
    spacing: Literal["uniform", "gauss-legendre"]


class GridRecord(Part):
    """The fitting grid: nodes along each argument, and lights at each node (0 if there are none).

    A form that was fitted to scattered points has no nodes; `points` is the number of these points.
    """

    nodes: list[Nodes]
    directions: Annotated[int, Field(ge=0)] = 0
    points: Annotated[int, Field(ge=1)] | None = None


class GoalRecord(Part):
    """What the fit minimised, and its constraints: see fitting/goal.py."""

    norm: Norm
    relative: bool
    side: Side
    rounding: Rounding
    bounded: bool = False


class Expression(Part):
    """The form as data: the steps that compute its value (coefficients/expression.py)."""

    steps: Annotated[
        list[Annotated[list[Operand], Field(min_length=2, max_length=4)]],
        Field(max_length=MAX_STEPS),
    ]
    value: Operand


class About(Part):
    """What is known of a user's quantity, so that code can be written without the user's file.

    `function` is the name of the exported function. `arguments` maps the names of the axes to those
    of the function's arguments, in the order of the call. `codomain` is the interval of the exact
    values, if it is stated.
    """

    symbol: Text
    definition: Text
    meaning: Text
    function: Identifier
    arguments: Annotated[dict[Text, Identifier], _CLOSED, Field(min_length=1, max_length=8)]
    codomain: Annotated[list[Number], Field(min_length=2, max_length=2)] | None = None

    @model_validator(mode="after")
    def _ordered(self):
        if self.codomain is not None and not self.codomain[0] <= self.codomain[1]:
            raise ValueError(f"codomain {self.codomain} is empty")
        return self


class DataFile(Part):
    """The data that a form was fitted to: the file's name and SHA-256, and how many rows it has.

    `held_out` rows were not fitted: they judge the fit.
    """

    name: Text
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    rows: Annotated[int, Field(ge=1)]
    held_out: Annotated[int, Field(ge=0)]


class Reference(Part):
    """The method of the exact values, and a bound on its error at the points of the fit.

    Of data, the error is the largest standard deviation, or 0 if none is stated.
    """

    leg: Literal["closed_form", "quadrature", "monte_carlo", "data"]
    error: Annotated[Number, Field(ge=0)]
    data: DataFile | None = None


class Uncertainty(Part):
    """How well the points of a fit determine its coefficients.

    `standard_errors` has one number for each flat coefficient; only a least squares fit has them.
    `condition` is that of the scaled matrix of derivatives. If not `unique`, other coefficients fit
    as well, and `undetermined` names those that can be changed.
    """

    standard_errors: Vector | None = None
    condition: Positive | None = None
    unique: bool
    undetermined: Labels = []


class ErrorRecord(Part):
    """The rms and the largest absolute error at a number of points; `where` has the largest."""

    rms: Annotated[Number, Field(ge=0)]
    max: Annotated[Number, Field(ge=0)]
    where: Annotated[dict[Text, Number], _CLOSED]
    points: Annotated[int, Field(ge=1)]

    @model_validator(mode="after")
    def _ordered(self):
        # The two are equal if all errors are; then either may be rounded up.
        if not self.rms <= self.max * (1 + 1e-12):
            raise ValueError(f"the rms error {self.rms} is above the largest error {self.max}")
        return self


class ErrorRecords(Part):
    """Errors at the points of the fit and at points that it did not use."""

    on_grid: ErrorRecord
    off_grid: ErrorRecord


class LargestErrorRecord(Part):
    """The largest absolute error on the whole domain, as a theorem (docs/certify.md).

    No error is above `upper`. At the point `at` it is at least `lower`. `boxes` is the number of
    boxes of the proof.
    """

    lower: Annotated[Number, Field(ge=0)]
    at: Annotated[dict[Text, Number], _CLOSED]
    upper: Annotated[Number, Field(ge=0)]
    boxes: Annotated[int, Field(ge=1)]

    @model_validator(mode="after")
    def _ordered(self):
        if not self.lower <= self.upper:
            raise ValueError(f"the largest error is at least {self.lower} and at most {self.upper}")
        return self


class LocalOptimalityRecord(Part):
    """How much a small change of the coefficients could lower the largest error.

    To first order, and at the points of the fit, no change that alters the values there by at most
    the largest error (rms) lowers it by more than the fraction `decrease`. `extrema` is the number
    of points that show this. It is computed in floating point (docs/certify.md).
    """

    decrease: Annotated[Number, Field(ge=0)]
    extrema: Annotated[int, Field(ge=1)]


class RoundingRecord(Part):
    """A proven bound of a rounding error, and the number of boxes of the proof."""

    upper: Positive
    boxes: Annotated[int, Field(ge=1)]


class Float32Rounding(Part):
    """What float32 rounding adds at most to the error of the exported functions (docs/certify.md).

    `ieee` is for IEEE 754 arithmetic and functions that are within one unit in the last place,
    `vulkan` for the errors that the Vulkan specification allows. What is missing is not proven.
    """

    ieee: RoundingRecord | None = None
    vulkan: RoundingRecord | None = None


class Certificates(Part):
    """What is proven on the whole domain, by branch and bound over a number of boxes.

    Every denominator is at least `denominator_bound`; without a bound there is no denominator.
    Every value is within `range`, and that within the quantity's codomain but for the rounding of
    the proof; without a range this is not proven. No coefficients of the form have a largest error
    below `least_error`. If `conservative_bound` is positive, no value is above the exact one: it is
    a lower bound of a quantity that would be negative there (quantities/fuzz/velvet_form.py).
    Without `largest_error`, the largest error is measured only, and so is the rounding of exported
    code without `float32_rounding`. `local_optimality` is for a form that has no `least_error`. It
    is no proof.
    """

    denominator_bound: Positive | None = None
    boxes: Annotated[int, Field(ge=0)]
    range: Annotated[list[Number], Field(min_length=2, max_length=2)] | None = None
    least_error: Positive | None = None
    local_optimality: LocalOptimalityRecord | None = None
    conservative_bound: Number | None = None
    largest_error: LargestErrorRecord | None = None
    float32_rounding: Float32Rounding | None = None

    @model_validator(mode="after")
    def _ordered(self):
        if self.range is not None and not self.range[0] <= self.range[1]:
            raise ValueError(f"range {self.range} is empty")
        return self


class Provenance(Part):
    """What made the table: the command, the versions of Python and of libraries, and the solver."""

    command: Text
    versions: Annotated[dict[Text, Text], _CLOSED]
    solver: Text


class Erratum(Part):
    """One erratum of a published table. `exchange_rows`: two rows of coefficients to exchange."""

    id: Name
    where: Text
    printed: Text | None = None
    corrected: Text | None = None
    why: Text
    exchange_rows: Annotated[list[int], Field(min_length=2, max_length=2)] | None = None


class Publication(Part):
    """Where a published table is printed, the clamps of its listing, and its errata."""

    source: Text
    appendix: Text
    listing: Text
    clamps: Annotated[dict[Text, list[Number | None]], _CLOSED]
    errata: list[Erratum]
