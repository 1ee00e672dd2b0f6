"""A fitted piecewise-linear NDF as a JSON table. This module needs no JAX."""

import math
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, ValidationError, model_validator

from coefficients.json_text import laid_out, read_object
from coefficients.table_parts import Number, Part, Positive, Text

SCHEMA = "shadefit.ndf/1"
MAX_BYTES = 1 << 20

Values = Annotated[list[Number], Field(min_length=2, max_length=1024)]


class NdfErrors(Part):
    """The errors of a fit: ½ ∫ |ΔD| cos θ dω, and the largest |ΔG1| over `directions` angles."""

    total_variation: Annotated[Number, Field(ge=0)]
    masking: Annotated[Number, Field(ge=0)]
    directions: Annotated[int, Field(ge=1)]


class NdfTable(Part):
    """An isotropic NDF: `values`, per steradian, at the polar angles `knots`, in radians.

    `linear_in` says what it is linear in between knots: "angle" θ or "cos2", cos²θ. ∫ D cos θ dω is
    1. `mass` is c_iso, the mass of the target interpolated at these knots.
    """

    schema_: Literal["shadefit.ndf/1"] = Field(alias="schema")
    target: Text
    linear_in: Literal["angle", "cos2"]
    monotone: bool
    knots: Values
    values: Values
    mass: Positive
    errors: NdfErrors
    command: Text

    @model_validator(mode="after")
    def _ordered(self):
        if len(self.knots) != len(self.values):
            raise ValueError(f"{len(self.knots)} knots and {len(self.values)} values")
        if any(not low < high for low, high in zip(self.knots, self.knots[1:], strict=False)):
            raise ValueError("knots: expected are increasing angles")
        if self.knots[0] != 0 or abs(self.knots[-1] - math.pi / 2) > 1e-12:
            raise ValueError("knots: expected are angles from 0 to π/2")
        if min(self.values) < 0 or max(self.values) == 0:
            raise ValueError("values: expected are numbers ≥ 0 that are not all zero")
        return self


def serialise_ndf(table: NdfTable) -> str:
    """Return a table as JSON text, with keys in a fixed order and all digits of the numbers."""
    return laid_out(table.model_dump(by_alias=True)) + "\n"


def read_ndf(path: Path) -> NdfTable:
    """Read a table from a file. Raises ValueError, with one line, if it is not a valid one."""
    try:
        if not path.is_file():
            raise ValueError(f"{path}: no such file")
        if path.stat().st_size > MAX_BYTES:
            raise ValueError(f"{path} is larger than {MAX_BYTES} bytes: no table of an NDF is")
        return NdfTable.model_validate(read_object(path.read_text("utf-8-sig")), strict=True)
    except ValidationError as error:
        first = error.errors(include_input=False, include_url=False)[0]
        place = ".".join(str(part) for part in first["loc"]) or "the table"
        message = first["msg"].removeprefix("Value error, ")
        raise ValueError(f"{path}: {place[:100]!r}: {message[:200]}") from None
    except (UnicodeDecodeError, RecursionError):
        raise ValueError(f"{path} is no table of an NDF") from None
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror}") from None
