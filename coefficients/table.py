"""Coefficient tables, as they are written to JSON and read from it. This module needs no JAX."""

import math
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from coefficients.json_text import laid_out
from coefficients.table_parts import (
    About,
    Argument,
    Certificates,
    ErrorRecords,
    Expression,
    GoalRecord,
    GridRecord,
    LabelRow,
    Labels,
    Name,
    Part,
    Provenance,
    Publication,
    Reference,
    Row,
    Shape,
    Text,
    Uncertainty,
    Vector,
)
from coefficients.table_text import read_text, validated

SCHEMA = "shadefit.table/2"
# A larger file is refused before it is parsed. All real tables are far smaller.
MAX_BYTES = 4 << 20


class Table(Part):
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
        if len(names) < len(self.arguments):
            raise ValueError("arguments: a name is there twice")
        self._require_own(names)
        if self.about is not None and set(self.about.arguments) != names:
            raise ValueError("about.arguments: expected is a name for each argument")
        return self

    def _require_own(self, names: set[str]) -> None:
        """Raise ValueError for a place or nodes of arguments that the table does not have."""
        proven = self.certificates.largest_error if self.certificates else None
        places = {"certificates.largest_error.at": proven.at} if proven else {}
        if self.errors is not None:
            places["errors.on_grid.where"] = self.errors.on_grid.where
            places["errors.off_grid.where"] = self.errors.off_grid.where
        for what, place in places.items():
            if set(place) != names:
                raise ValueError(f"{what}: expected is a number for each argument")
        nodes = [each.argument for each in self.grid.nodes] if self.grid else []
        if len(set(nodes)) < len(nodes) or not set(nodes) <= names:
            raise ValueError("grid.nodes: expected are nodes of different arguments of the table")
        if self.publication is not None and not set(self.publication.clamps) <= names:
            raise ValueError("publication.clamps: expected are arguments of the table")

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
    return validated(partial(Table.model_validate, strict=True), text, source)


def read(path: Path) -> Table:
    """Read a table from a file. Raises ValueError if it is missing or not a valid table."""
    return parse(read_text(path, MAX_BYTES), str(path))


def serialise(table: Table) -> str:
    """Return a table as JSON text.

    Keys have a fixed order, and numbers have as many digits as are needed to read the same number
    again.
    """
    data = table.model_dump(by_alias=True, exclude_none=True)
    return laid_out(data) + "\n"
