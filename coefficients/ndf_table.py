"""A fitted NDF, one profile or a blend of two, as a JSON table. This module needs no JAX."""

import math
from itertools import pairwise
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from coefficients.json_text import laid_out
from coefficients.table_parts import Number, Part, Positive, Text
from coefficients.table_text import read_text, validated

SCHEMA, BLEND_SCHEMA = "shadefit.ndf/1", "shadefit.ndf-blend/1"
MAX_BYTES = 1 << 20

Values = Annotated[list[Number], Field(min_length=2, max_length=1024)]


class NdfErrors(Part):
    """The errors of a fit: ½ ∫ |ΔD| cos θ dω, and the largest |ΔG1| over `directions` directions.

    Those of a profile in a blend are compared with that profile's own source.
    """

    total_variation: Annotated[Number, Field(ge=0)]
    masking: Annotated[Number, Field(ge=0)]
    directions: Annotated[int, Field(ge=1)]


def _require_profile(part: Any) -> Any:
    """Return a part that has `knots` and `values`. Raises ValueError if they are no NDF."""
    knots, values = part.knots, part.values
    if len(knots) != len(values):
        raise ValueError(f"{len(knots)} knots and {len(values)} values")
    if any(not low < high for low, high in pairwise(knots)):
        raise ValueError("knots: expected are increasing angles")
    if knots[0] != 0 or abs(knots[-1] - math.pi / 2) > 1e-12:
        raise ValueError("knots: expected are angles from 0 to π/2")
    if min(values) < 0 or max(values) == 0:
        raise ValueError("values: expected are numbers ≥ 0 that are not all zero")
    return part


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

    _is_profile = model_validator(mode="after")(_require_profile)


class BlendProfile(Part):
    """One of the two profiles of a blend. `mass` is c_iso, as that of an `NdfTable`."""

    knots: Values
    values: Values
    mass: Positive

    _is_profile = model_validator(mode="after")(_require_profile)


class NdfBlendTable(Part):
    """The blend of two isotropic NDFs, `x` at azimuth 0 and `y` at π/2 (shading/piecewise/blend).

    `errors` are those against the anisotropic `target`, or None if the blend was made of two
    profiles that have no other meaning. All else is as in an `NdfTable`.
    """

    schema_: Literal["shadefit.ndf-blend/1"] = Field(alias="schema")
    target: Text
    linear_in: Literal["angle", "cos2"]
    monotone: bool
    x: BlendProfile
    y: BlendProfile
    errors: NdfErrors | None
    command: Text


def serialise_ndf(table: NdfTable | NdfBlendTable) -> str:
    """Return a table as JSON text, with keys in a fixed order and all digits of the numbers."""
    return laid_out(table.model_dump(by_alias=True)) + "\n"


def read_ndf(path: Path) -> NdfTable | NdfBlendTable:
    """Read a table from a file. Raises ValueError, with one line, if it is not a valid one."""
    return validated(_table_of, read_text(path, MAX_BYTES), str(path))


def _table_of(data: dict[str, Any]) -> NdfTable | NdfBlendTable:
    kind = NdfBlendTable if data.get("schema") == BLEND_SCHEMA else NdfTable
    return kind.model_validate(data, strict=True)
