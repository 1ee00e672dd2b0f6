"""`shadefit search`: families of forms, fitted one after the other, and the frontier among them.

A candidate's table is written as soon as it is fitted; a later run with the same folder takes it
from there, so that an interrupted search goes on where it stopped.
"""

import hashlib
import itertools
import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

from coefficients.catalogue import PUBLISHED, form_of, from_fit, load, names_of_best
from coefficients.files import require_writable, write_whole, write_whole_bytes
from coefficients.shaders import functions_of
from coefficients.table import SCHEMA, Table, read, serialise
from fitting import Form, Goal, common_domain, improve, judge
from fitting.families import candidates
from fitting.grow import grown_r
from integrals import R
from programs.cost import count
from programs.tracing.tracer import trace
from shadefit.figures.frontier import best_so_far, closed_form
from shadefit.figures.search import draw
from shadefit.terminal import print_json, print_table, stages


@dataclass(frozen=True)
class Found:
    """A candidate: its table's name, file, operations a call, and errors off the grid."""

    name: str
    form: str
    coefficients: int
    operations: int
    rms: float
    largest: float
    file: str


def run(
    quantity: str,
    budget: int | None,
    max_error: float | None,
    least_alpha: float,
    goal: Goal,
    out: Path,
    as_json: bool,
) -> None:
    """Fit every candidate of a quantity that is within the budget, and print the frontier."""
    if quantity not in PUBLISHED:
        raise ValueError(f"no forms of {quantity!r} are known: allowed are {', '.join(PUBLISHED)}")
    if budget is not None and budget < 1:
        raise ValueError(f"budget = {budget}: at least one operation is needed")
    if max_error is not None and not max_error > 0:
        raise ValueError(f"max-error = {max_error}: it must be positive")
    if not 0.01 <= least_alpha < 1:
        raise ValueError(f"least-alpha = {least_alpha}: allowed are 0.01 to below 1")
    require_writable(out)
    found, refused, candidate = [], 0, None
    with stages() as progress:
        task = progress.add_task(quantity, total=None)
        for form in _candidates(quantity, least_alpha):

            def tell(stage: str, done: int = len(found)) -> None:
                progress.update(task, description=f"{quantity}: {done} forms; {stage}")

            # The count needs no values: forms beyond the budget are never fitted.
            if budget is not None and _operations(_blank(form)) > budget:
                continue
            if _refusal(form, goal, out).is_file():
                refused += 1
                continue
            table = _made_before(form, goal, out) or _fitted(form, goal, out, tell)
            if table is None:
                refused += 1
                continue
            found.append(_found(table, out))
            candidate = form
    if candidate is None:
        raise ValueError(f"no form of {quantity} was found within {budget} operations")
    best = best_so_far(found)
    good = [each for each in best if max_error is None or each.largest <= max_error]
    published = _published(quantity, candidate)
    drawn = out / f"{quantity}-frontier"
    exact = _exact(quantity)
    for extension, data in draw(quantity, found, best, published, exact).items():
        write_whole_bytes(drawn.with_suffix(f".{extension}"), data)
    if as_json:
        records = {"frontier": best, "good": good, "all": found}
        print_json(
            {
                "quantity": quantity,
                "published": asdict(published),
                "exact": [asdict(each) for each in exact],
                "refused": refused,
                **{key: [asdict(each) for each in value] for key, value in records.items()},
            }
        )
        return
    limit = "" if max_error is None else f"; {len(good)} of them within {max_error:g}"
    print_table(
        f"{quantity}: the frontier of {len(found)} forms{limit}",
        ["table", "form", "coefficients", "operations", "rms", "largest", "published / this"],
        [_row(each, published) for each in (published, *(good or best), *exact)],
        f"Operations a call, of P_s a direction. {refused} forms refused: they have poles, or are "
        f"not shown to have none. Plot: {drawn}.png",
    )


def _candidates(quantity: str, least_alpha: float) -> Iterator[type[Form]]:
    if quantity != "r":
        return candidates(quantity, least_alpha)
    # The best sets of monomials that are known are not all on the way of a greedy choice.
    known = [type(form_of(load(name))) for name in names_of_best()]
    sets = [form for form in known if form.integral is R and form.axes[0].lower == least_alpha]
    return itertools.chain(sets, grown_r(least_alpha))


def _name(form: type[Form], goal: Goal) -> str:
    """Name a candidate by its family and a digest of its shape and goal: the same in every run."""
    text = json.dumps([form.shape, asdict(goal)], sort_keys=True)
    return f"{form.name}-{hashlib.sha256(text.encode()).hexdigest()[:10]}"


def _blank(form: type[Form]) -> Table:
    size = len(form.coefficient_names())
    return Table.model_validate(
        {
            "schema": SCHEMA,
            "name": "blank",
            "quantity": form.integral.name,
            "form": form.name,
            "shape": form.shape,
            "equation": form.equation,
            "arguments": [
                {"name": axis.name, "unit": axis.unit, "domain": [axis.lower, axis.upper]}
                for axis in form.axes
            ],
            # Numbers that are neither zero nor one nor equal: no operation is saved by them.
            "coefficients": [0.37 + 0.013 * k for k in range(size)],
            "coefficient_names": form.coefficient_names(),
        }
    )


def _operations(table: Table) -> int:
    return count(trace(functions_of(table)[-1])).operations


def _made_before(form: type[Form], goal: Goal, out: Path) -> Table | None:
    path = out / f"{_name(form, goal)}.json"
    if not path.is_file():
        return None
    table = read(path)
    made_for = Goal() if table.goal is None else Goal(**table.goal.model_dump())
    same = (table.form, table.shape, made_for) == (form.name, form.shape, goal)
    return table if same and table.errors is not None else None


def _refusal(form: type[Form], goal: Goal, out: Path) -> Path:
    """Give the file that says why a candidate was refused, so that it is not tried again."""
    return out / f"{_name(form, goal)}.refused.txt"


def _fitted(form: type[Form], goal: Goal, out: Path, tell) -> Table | None:
    """Fit a candidate and write its table; None, and why, where it is refused."""
    name = _name(form, goal)
    try:
        fit = improve(form, goal, tell)
    except ValueError as error:
        write_whole(_refusal(form, goal, out), f"{error}\n")
        return None
    table = from_fit(fit, f"shadefit search {form.integral.name}", name)
    write_whole(out / f"{name}.json", serialise(table))
    return table


def _found(table: Table, out: Path) -> Found:
    errors = table.errors
    assert errors is not None
    return Found(
        table.name,
        table.form,
        table.size,
        _operations(table),
        errors.off_grid.rms,
        errors.off_grid.max,
        str(out / f"{table.name}.json"),
    )


def _published(quantity: str, candidate: type[Form]) -> Found:
    """Judge the published table where the candidates, which share a domain, are defined too."""
    name = f"published/{quantity}"
    table = load(name)
    form = form_of(table)
    errors = judge(form, common_domain([type(form), candidate]))
    return Found(
        name, table.form, table.size, _operations(table), errors.rms, errors.largest, "coefficients"
    )


def _exact(quantity: str) -> list[Found]:
    """Give the closed form, at which every frontier ends; R has none."""
    return [
        Found(mark.name, "exact", 0, mark.operations, mark.rms, mark.largest, "")
        for mark in closed_form(quantity)
    ]


def _row(each: Found, published: Found) -> list[str]:
    return [
        each.name,
        each.form,
        str(each.coefficients),
        str(each.operations),
        f"{each.rms:.3e}",
        f"{each.largest:.3e}",
        f"{published.largest / each.largest:.1f}",
    ]
