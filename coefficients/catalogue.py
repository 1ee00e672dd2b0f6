"""Names of tables and closed forms: what a user's name stands for.

A name stands for a packaged table (below `coefficients/tables`), for a table in the user's file, or
for a closed form. The command line resolves it once, into an `Entry`, and passes the entry on.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from coefficients.agreement import fitted_form
from coefficients.expression import form_of, reference_of, require_same
from coefficients.packaged import (
    AMBIENT,
    AS_PRINTED,
    EXACT,
    FOLDER,
    FUNCTIONS,
    Kind,
    corrected,
    files,
    is_file,
    is_packaged,
    kind_of,
    names,
    packaged_table,
    unknown,
)
from coefficients.table import Table, read
from fitting import FittedForm, Form
from integrals.reference import Axis
from programs.functions import Function
from quantities import Problem, functions, problem, problems
from quantities.calling_convention import renamed
from quantities.defaults import default_calling
from quantities.problem import ExactCode
from quantities.registry import names as names_of_quantities
from quantities.registry import registered


@dataclass(frozen=True, eq=False)
class Entry:
    """What a name stands for: a quantity, and a table with its fitted form.

    `name` is the name that the user gave. A closed form (kind 'exact') has neither a table nor a
    fitted form.
    """

    name: str
    kind: Kind
    problem: Problem
    table: Table | None = None
    fitted: FittedForm | None = None

    @property
    def axes(self) -> tuple[Axis, ...]:
        """The axes, restricted to the domain of the table or the closed form."""
        if self.fitted is not None:
            return self.fitted.axes
        return self.exact_code.axes

    @property
    def equation(self) -> str:
        """The equation that the value is computed by, as text."""
        return self.require_table().equation if self.table else self.exact_code.equation

    @property
    def remark(self) -> str | None:
        """What a caller of the exported functions must know about their arguments, if anything."""
        if self.fitted is not None:
            return self.problem.calling.remark
        return self.exact_code.remark

    def require_table(self) -> Table:
        """Return the table. Raises ValueError for a closed form, which has none."""
        if self.table is None:
            raise ValueError(
                f"{self.name} has no coefficients: allowed is {self.name} with --to LANG"
            )
        return self.table

    def require_fitted(self) -> FittedForm:
        """Return the fitted form. Raises ValueError for a closed form, which has none."""
        self.require_table()
        assert self.fitted is not None
        return self.fitted

    def functions(self, precision: str = "float", name: str | None = None) -> tuple[Function, ...]:
        """Return the exported functions in the order of the calls; the last returns the value.

        `precision` ("half", "float" or "double") decides how many steps a closed form takes. `name`
        replaces the name of the last function. Raises ValueError for a name that is not an
        identifier.
        """
        if self.fitted is None:
            functions = self.exact_code.functions(precision)
        else:
            functions = self.problem.calling.functions(self.fitted)
        return functions if name is None else renamed(functions, name)

    def arguments_at(self, points: np.ndarray) -> tuple[np.ndarray, ...]:
        """Return the arguments of each function at points (n, axes), as arrays (n, …).

        The results of the first function, which the second takes before its own arguments, are left
        out.
        """
        if self.fitted is None:
            return self.exact_code.arguments_at(points)
        return self.problem.calling.arguments_at(self.fitted, points)

    @property
    def exact_code(self) -> ExactCode:
        """The closed form of the quantity as shader code. The quantity must have one."""
        assert self.problem.exact_code is not None
        return self.problem.exact_code


def resolve(name: str) -> Entry:
    """Return what a name stands for.

    It is a table's name, such as 'ps' (refitted), 'published/ps', 'published/ps@printed' or
    'best/q-9'; the name of a closed form, such as 'exact/ps', or of another function that is
    exported but not fitted, such as 'detail/overlay'; or the path of a table's file. The errata of
    a published table are applied unless '@printed' follows its name. Raises ValueError for any
    other name, and for a file that is not a valid table.
    """
    declared = _declared(registered().values())
    if name in declared:
        return declared[name]
    if is_packaged(name):
        return _kept(name)
    if name.startswith(f"{EXACT}/") and not is_file(name):
        return _closed_form(name)
    kind, slash, _ = name.partition("/")
    if slash and kind in FUNCTIONS and not is_file(name):
        return _function(name)
    if is_file(name):
        return entry_of(corrected(read(Path(name))), name)
    raise unknown(name, names_of_quantities(), declared)


def entry_of(table: Table, name: str) -> Entry:
    """Return the entry of a table that is not packaged.

    If its quantity is not known, or has no such form, the form is that of the table's expression.
    Raises ValueError for a table without an expression then, and for a table that contradicts the
    form or its own expression.
    """
    known = problem(table.quantity) if table.quantity in names_of_quantities() else None
    if known is not None and known.topic and table.about is not None:
        # A user's quantity, such as the column R of data, has the name of a built-in one.
        known = None
    if known is not None and known.has_form(table.form, table.shape):
        fitted = fitted_form(table, known)
        if table.expression is not None:
            require_same(table, fitted.form)
        return Entry(name, "file", known, table, fitted)
    if table.expression is None:
        owner = problem(table.quantity)  # Raises ValueError if it is not known.
        return Entry(name, "file", owner, table, fitted_form(table, owner))
    form = form_of(table, reference_of(table) if known is None else known.reference)
    owner = known or _self_contained(table, form)
    return Entry(name, "file", owner, table, form.fitted(np.array(table.coefficients)))


def _self_contained(table: Table, form: Form) -> Problem:
    """Return the quantity of a table of which nothing else is known."""
    about, reference = table.about, form.reference
    function, names = (about.function, about.arguments) if about else ("", None)
    order = list(names or [axis.name for axis in form.axes])
    axes = sorted(form.axes, key=lambda axis: order.index(axis.name))
    calling = default_calling(table.quantity, axes, reference.symbol, function, names)
    return Problem(reference, (form,), calling)


def load(name: str) -> FittedForm:
    """Return the fitted form of a table with a name or a file's path.

    Call the form with the values of its axes. Raises ValueError as `resolve` does, and for a closed
    form.
    """
    return resolve(name).require_fitted()


def entries(owner: Problem | None = None) -> list[Entry]:
    """Return the packaged tables of one quantity, or of all.

    Those of one quantity are in this order: as printed, published, refitted, best. Those of all are
    in the order of `names`.
    """
    if owner is None:
        declared = _declared(registered().values())
        return [*(_kept(name) for name in names()), *declared.values()]
    order: dict[Kind, int] = {"printed": 0, "published": 1, "refitted": 2, "best": 3}
    kept = [name for name in names() if packaged_table(name).quantity == owner.name]
    found = [*(_kept(name) for name in kept), *_declared([owner]).values()]
    own = [entry for entry in found if entry.problem is owner]
    return sorted(own, key=lambda entry: (order[entry.kind], entry.name))


def published(owner: Problem) -> Entry | None:
    """Return the published table of a quantity, with its errata applied; None if there is none.

    Of several, it is the first.
    """
    name = f"published/{owner.name}"
    return _kept(name) if name in files() else next(iter(_declared([owner]).values()), None)


def printed(owner: Problem) -> Entry | None:
    """Return the published table as printed; None if its errata change no coefficients."""
    name = f"published/{owner.name}{AS_PRINTED}"
    return _kept(name) if name in names() else None


def refitted(owner: Problem) -> Entry | None:
    """Return the refitted table of a quantity; None if there is none."""
    return _kept(owner.name) if owner.name in files() else None


def with_published() -> list[Problem]:
    """List the quantities that have a published table, with which others can be compared."""
    return [owner for owner in problems().values() if published(owner) is not None]


def _declared(owners: Iterable[Problem]) -> dict[str, Entry]:
    """Return the published constants that quantities declare, by name.

    The name is published/QUANTITY for the first of a quantity, and published/QUANTITY-FORM for the
    others.
    """
    return {
        f"published/{each.name}{f'-{constants.form}' if k else ''}": _published_entry(each, k)
        for each in owners
        for k, constants in enumerate(each.published)
    }


@lru_cache(maxsize=64)
def _published_entry(owner: Problem, number: int) -> Entry:
    from coefficients.record import published_table  # noqa: PLC0415  it imports the solvers

    constants = owner.published[number]
    name = f"published/{owner.name}{f'-{constants.form}' if number else ''}"
    table = published_table(owner, constants)
    return Entry(name, "published", owner, table, fitted_form(table, owner))


def is_kept(name: str) -> bool:
    """Tell whether a name is that of a table or a quantity whose tables are kept here."""
    return name in files() or (name in names_of_quantities() and bool(problem(name).topic))


def path_of(name: str) -> Path:
    """Return the file of a packaged table, or the file where a quantity's refit would be."""
    if name in files():
        return files()[name]
    return FOLDER / problem(name).topic / "refit" / f"{name}.json"


@lru_cache(maxsize=256)
def _kept(name: str) -> Entry:
    """Return a packaged table. Raises ValueError for '@printed' if it is not a published one."""
    table = packaged_table(name)
    owner = problem(table.quantity)
    return Entry(name, kind_of(name), owner, table, fitted_form(table, owner))


def _closed_form(name: str) -> Entry:
    quantity = name.removeprefix(f"{EXACT}/")
    if quantity in names_of_quantities() and problem(quantity).exact_code is not None:
        return Entry(name, "exact", problem(quantity))
    known = [f"{EXACT}/{p.name}" for p in problems().values() if p.exact_code is not None]
    raise ValueError(
        f"no closed form is exported as {name!r}: allowed are {', '.join(known)} and tables' names"
    )


def exported_functions(kind: str | None = None) -> dict[str, Problem]:
    """Return what `quantities.functions` does, and with it the functions of ambient light."""
    found = functions(kind)
    if kind in (None, AMBIENT):
        from coefficients.ambient.problems import ambient_problems  # noqa: PLC0415

        found |= {f"{AMBIENT}/{name}": each for name, each in ambient_problems().items()}
    return found


def _function(name: str) -> Entry:
    """Return the entry of a function that is declared as a quantity without forms."""
    known = exported_functions(name.partition("/")[0])
    if name not in known:
        raise ValueError(f"no function is called {name!r}: allowed are {', '.join(known)}")
    return Entry(name, "exact", known[name])
