"""Coefficient tables, as they are written to JSON and read from it. This module needs no JAX."""

import math
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from coefficients.json_text import laid_out, read_object
from fitting.goal import Norm, Rounding, Side

SCHEMA = "shadefit.table/2"
# An expression has at most this many steps.
MAX_STEPS = 4096
# A larger file is refused before it is parsed. All real tables are far smaller.
MAX_BYTES = 4 << 20

Number = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[Number, Field(gt=0)]
# Text is shown on terminals and in comments of code. It must not have control codes, line breaks,
# characters without width, or characters that change the direction of writing.
UNSEEN = r"\x00-\x1f\x7f-\x9f\u061c\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff"
Text = Annotated[str, Field(max_length=2000, pattern=f"^[^{UNSEEN}]*$")]
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


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


class Argument(_Part):
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


class Nodes(_Part):
    """The fitting grid along one argument."""

    argument: Text
    count: Annotated[int, Field(ge=2)]
    spacing: Literal["uniform", "gauss-legendre"]


class GridRecord(_Part):
    """The fitting grid: nodes along each argument, and lights at each node (0 if there are none).

    A form that was fitted to scattered points has no nodes; `points` is the number of these points.
    """

    nodes: list[Nodes]
    directions: Annotated[int, Field(ge=0)] = 0
    points: Annotated[int, Field(ge=1)] | None = None


class GoalRecord(_Part):
    """What the fit minimised, and its constraints: see fitting/goal.py."""

    norm: Norm
    relative: bool
    side: Side
    rounding: Rounding
    bounded: bool = False


class Expression(_Part):
    """The form as data: the steps that compute its value (coefficients/expression.py)."""

    steps: Annotated[
        list[Annotated[list[Operand], Field(min_length=2, max_length=4)]],
        Field(max_length=MAX_STEPS),
    ]
    value: Operand


class About(_Part):
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


class DataFile(_Part):
    """The data that a form was fitted to: the file's name and SHA-256, and how many rows it has.

    `held_out` rows were not fitted: they judge the fit.
    """

    name: Text
    sha256: Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
    rows: Annotated[int, Field(ge=1)]
    held_out: Annotated[int, Field(ge=0)]


class Reference(_Part):
    """The method of the exact values, and a bound on its error at the points of the fit.

    Of data, the error is the largest standard deviation, or 0 if none is stated.
    """

    leg: Literal["closed_form", "quadrature", "monte_carlo", "data"]
    error: Annotated[Number, Field(ge=0)]
    data: DataFile | None = None


class Uncertainty(_Part):
    """How well the points of a fit determine its coefficients.

    `standard_errors` has one number for each flat coefficient; only a least squares fit has them.
    `condition` is that of the scaled matrix of derivatives. If not `unique`, other coefficients fit
    as well, and `undetermined` names those that can be changed.
    """

    standard_errors: Vector | None = None
    condition: Positive | None = None
    unique: bool
    undetermined: Labels = []


class ErrorRecord(_Part):
    """The rms and the largest absolute error at a number of points; `where` has the largest."""

    rms: Annotated[Number, Field(ge=0)]
    max: Annotated[Number, Field(ge=0)]
    where: Annotated[dict[Text, Number], _CLOSED]
    points: Annotated[int, Field(ge=1)]


class ErrorRecords(_Part):
    """Errors at the points of the fit and at points that it did not use."""

    on_grid: ErrorRecord
    off_grid: ErrorRecord


class LargestErrorRecord(_Part):
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


class Certificates(_Part):
    """What is proven on the whole domain, by branch and bound over a number of boxes.

    Every denominator is at least `denominator_bound`; without a bound there is no denominator.
    Every value is within `range`, and that within the quantity's codomain but for the rounding of
    the proof; without a range this is not proven. No coefficients of the form have a largest error
    below `least_error`. If `conservative_bound` is positive, no value is above the exact one: it is
    a lower bound of a quantity that would be negative there (quantities/fuzz/velvet_form.py).
    Without `largest_error`, the largest error is measured only.
    """

    denominator_bound: Positive | None = None
    boxes: Annotated[int, Field(ge=0)]
    range: Annotated[list[Number], Field(min_length=2, max_length=2)] | None = None
    least_error: Positive | None = None
    conservative_bound: Number | None = None
    largest_error: LargestErrorRecord | None = None

    @model_validator(mode="after")
    def _ordered(self):
        if self.range is not None and not self.range[0] <= self.range[1]:
            raise ValueError(f"range {self.range} is empty")
        return self


class Provenance(_Part):
    """What made the table: the command, the versions of Python and of libraries, and the solver."""

    command: Text
    versions: Annotated[dict[Text, Text], _CLOSED]
    solver: Text


class Erratum(_Part):
    """One erratum of a published table. `exchange_rows`: two rows of coefficients to exchange."""

    id: Name
    where: Text
    printed: Text | None = None
    corrected: Text | None = None
    why: Text
    exchange_rows: Annotated[list[int], Field(min_length=2, max_length=2)] | None = None


class Publication(_Part):
    """Where a published table is printed, the clamps of its listing, and its errata."""

    source: Text
    appendix: Text
    listing: Text
    clamps: Annotated[dict[Text, list[Number | None]], _CLOSED]
    errata: list[Erratum]


class Table(_Part):
    """The coefficients of a form of one quantity, with their errors, proofs and origin.

    A fitted table has `grid`, `weight`, `reference`, `errors`, `certificates` and `provenance`. A
    published table has `publication` instead. Tables of the older schema /1 have no `expression`.
    """

    schema_: Literal["shadefit.table/1", "shadefit.table/2"] = Field(alias="schema")
    name: Name
    quantity: Name
    form: Name
    shape: Shape | None = None
    equation: Text
    arguments: Annotated[list[Argument], Field(min_length=1, max_length=8)]
    coefficients: Vector | Annotated[list[Row], Field(min_length=1, max_length=64)]
    coefficient_names: Labels | Annotated[list[LabelRow], Field(min_length=1, max_length=64)]
    expression: Expression | None = None
    about: About | None = None
    grid: GridRecord | None = None
    weight: Name | None = None
    goal: GoalRecord | None = None
    reference: Reference | None = None
    errors: ErrorRecords | None = None
    certificates: Certificates | None = None
    uncertainty: Uncertainty | None = None
    provenance: Provenance | None = None
    publication: Publication | None = None

    @model_validator(mode="after")
    def _shapes(self):
        if _shape(self.coefficients) != _shape(self.coefficient_names):
            raise ValueError(
                f"coefficients have shape {_shape(self.coefficients)}, "
                f"their names {_shape(self.coefficient_names)}"
            )
        if self.schema_ == SCHEMA and self.expression is None:
            raise ValueError("expression is missing")
        names = {each.name for each in self.arguments}
        if self.about is not None and set(self.about.arguments) != names:
            raise ValueError("about.arguments: expected is a name for each argument")
        return self

    @property
    def size(self) -> int:
        """How many coefficients there are."""
        return math.prod(_shape(self.coefficients))


def _shape(nested: list) -> tuple[int, ...]:
    if nested and isinstance(nested[0], list):
        lengths = {len(row) for row in nested}
        if len(lengths) > 1:
            raise ValueError(f"rows have different lengths: {sorted(lengths)}")
        return (len(nested), lengths.pop())
    return (len(nested),)


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema that every table is validated against."""
    return Table.model_json_schema(by_alias=True)


def parse(text: str, source: str) -> Table:
    """Read a table from JSON text. `source` is its name in error messages.

    Raises ValueError with a message of one line for anything that is not a valid table.
    """
    try:
        return Table.model_validate(read_object(text), strict=True)
    except ValidationError as error:
        first = error.errors(include_input=False, include_url=False)[0]
        # The place of an error contains keys and indices, and the types that the validator tried.
        # Only keys and indices help a reader.
        parts = [str(part) for part in first["loc"] if "[" not in str(part)]
        place = ".".join(parts) or "the table"
        message = first["msg"].removeprefix("Value error, ")
        raise ValueError(f"{source}: {_one_line(place)}: {_one_line(message)}") from None
    except RecursionError:
        raise ValueError(f"{source} is no JSON table: nested too deeply") from None
    except ValueError as error:
        raise ValueError(f"{source} is no JSON table: {_one_line(str(error))}") from None


def _one_line(text: str) -> str:
    """Shorten text and remove control codes, because it may come from a hostile file."""
    shown = " ".join("".join(c if c.isprintable() else " " for c in text[:300]).split())
    return shown if len(text) <= 200 else f"{shown[:200]}…"


def read(path: Path) -> Table:
    """Read a table from a file. Raises ValueError if it is missing or not a valid table."""
    try:
        if not path.is_file():
            raise ValueError(f"{path}: no such file")
        if path.stat().st_size > MAX_BYTES:
            raise ValueError(f"{path} is larger than {MAX_BYTES} bytes: no table is")
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError:
        raise ValueError(f"{path} is no UTF-8 text") from None
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror}") from None
    return parse(text, str(path))


def serialise(table: Table) -> str:
    """Return a table as JSON text.

    Keys have a fixed order, and numbers have as many digits as are needed to read the same number
    again.
    """
    data = table.model_dump(by_alias=True, exclude_none=True)
    return laid_out(data) + "\n"
