"""`shadefit search`: fit many forms of a quantity, and find the best for each cost."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from shadefit.commands.names import require_quantities
from shadefit.commands.options import (
    Bounded,
    Json,
    Norm,
    Relative,
    Rounding,
    Side,
    goal_fields,
)

if TYPE_CHECKING:
    from coefficients.search import Found, Result
    from coefficients.workers import Workers
    from quantities import Problem
    from shadefit.records import FoundTable


# Below this α the built-in forms are not fitted.
LEAST_END = 0.01
# Each process takes about 0.5 GB.
MOST_JOBS = 256


def search(
    quantity: Annotated[
        str,
        typer.Argument(
            help="A quantity of 'shadefit list', such as ps or ggx-scale, or one of -p FILE.",
            metavar="QUANTITY",
        ),
    ],
    budget: Annotated[
        int | None,
        typer.Option(help="Most operations that a call may have (for ps, a direction)."),
    ] = None,
    max_error: Annotated[
        float | None, typer.Option(help="Print only forms whose largest error is at most this.")
    ] = None,
    lower: Annotated[
        list[str] | None,
        typer.Option(
            help="Lower end of an axis of the forms' domain, as in alpha=0.05; may be given again. "
            "By default alpha=0.15 for ps and r.",
            metavar="NAME=VALUE",
        ),
    ] = None,
    norm: Norm = None,
    side: Side = None,
    rounding: Rounding = None,
    relative: Relative = False,
    bounded: Bounded = False,
    out: Annotated[
        Path,
        typer.Option(help="Folder for tables and the plot; forms with a table are not refitted."),
    ] = Path("build/search"),
    jobs: Annotated[
        int, typer.Option(help="Fits at a time, each in a process of its own. By default 1.")
    ] = 1,
    cluster: Annotated[
        str | None,
        typer.Option(
            help="Scheduler of a dask cluster whose workers make the fits, such as "
            "tcp://host:8786, instead of this machine.",
            metavar="ADDRESS",
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Fit many forms of a quantity. Print and plot their operations and largest errors.

    By default the largest error is minimised, and coefficients are float32.
    """
    require_quantities([quantity], "no forms are known of")
    from coefficients.files import require_writable, write_whole_bytes
    from coefficients.search import Search
    from fitting import Goal
    from quantities import problems
    from shadefit.figures.search import draw
    from shadefit.progress import line_in_pipe, stages

    fields: dict[str, Any] = {"norm": "linf", "rounding": "float32"}
    fields |= goal_fields(norm, side, rounding, relative, bounded)
    goal = Goal(**fields)
    # A quantity with a single form has nothing to search among.
    known = {
        name: each
        for name, each in problems().items()
        if each.candidates is not None or len(each.single_forms) > 1
    }
    if quantity not in known and quantity in problems():
        raise ValueError(f"{quantity} has a single form: a search needs several to choose from")
    if quantity not in known:
        raise ValueError(f"no forms are known of {quantity!r}: allowed are {', '.join(known)}")
    if budget is not None and budget < 1:
        raise ValueError(f"budget = {budget}: at least one operation is needed")
    if max_error is not None and not max_error > 0:
        raise ValueError(f"max-error = {max_error}: it must be positive")
    workers = _workers(jobs, cluster)
    owner = known[quantity]
    ends = {**owner.search_lower, **_lower_ends(owner, lower or [])}
    require_writable(out)
    wanted = Search(owner, goal, out, budget, ends)
    in_pipe = line_in_pipe()
    with stages() as progress:
        line = progress.begin(quantity)

        def tell(stage: str, done: int, total: int) -> None:
            line.show(f"{quantity}: {stage}", done, total)
            in_pipe(f"{quantity}: {stage}", done, total)

        tell("which forms to try", 0, 0)
        result = wanted.run(tell, workers)
    drawn = out / f"{quantity}-frontier"
    for extension, data in draw(known[quantity], result).items():
        write_whole_bytes(drawn.with_suffix(f".{extension}"), data)
    good = [each for each in result.best if max_error is None or each.largest <= max_error]
    if json:
        _print_json(quantity, result, good)
    else:
        limit = "" if max_error is None else f"; {len(good)} of them within {max_error:g}"
        _print(quantity, result, good, limit, drawn)


def _workers(jobs: int, cluster: str | None) -> "Workers | None":
    """Return what fits candidates side by side; None for one fit after the other in this process.

    Raises ValueError for a number of jobs that is not allowed, and for jobs on a cluster.
    """
    from coefficients.workers import Cluster, LocalProcesses

    if not 1 <= jobs <= MOST_JOBS:
        raise ValueError(f"jobs = {jobs}: allowed are 1 to {MOST_JOBS}")
    if cluster is None:
        return None if jobs == 1 else LocalProcesses(jobs)
    if jobs != 1:
        raise ValueError(f"jobs = {jobs} with --cluster: the cluster decides their number")
    return Cluster(cluster)


def _lower_ends(owner: "Problem", given: list[str]) -> dict[str, float]:
    """Read texts such as 'alpha=0.05' as lower ends of axes, by the names of the axes.

    Raises ValueError for an axis that forms cannot be restricted in, and for a value outside it.
    """
    axes = {axis.name: axis for axis in owner.axes}
    allowed = list(axes if owner.candidates is None else owner.search_lower)
    found = {}
    for text in given:
        name, _, value = text.partition("=")
        if name not in allowed:
            offered = f"allowed are {', '.join(allowed)}" if allowed else "it takes none"
            raise ValueError(f"--lower {text}: {name!r} cannot be restricted: {offered}")
        try:
            end = float(value)
        except ValueError:
            raise ValueError(f"--lower {text}: {value!r} is no number") from None
        axis = axes[name]
        least = max(axis.lower, LEAST_END if owner.topic else axis.lower)
        if not least <= end < axis.upper:
            raise ValueError(f"--lower {text}: allowed are {least:g} to below {axis.upper:g}")
        found[name] = end
    return found


def _print_json(quantity: str, result: "Result", good: "list[Found]") -> None:
    from shadefit.outputs import SearchOutput
    from shadefit.terminal import print_json

    def record(each: "Found") -> "FoundTable":
        return _record(quantity, each)

    print_json(
        SearchOutput(
            quantity=quantity,
            published=None if result.published is None else record(result.published),
            exact=list(map(record, result.exact)),
            refused=result.refused,
            frontier=list(map(record, result.best)),
            good=list(map(record, good)),
            all=list(map(record, result.found)),
        )
    )


def _record(quantity: str, each: "Found") -> "FoundTable":
    from shadefit.records import ErrorsRecord, FoundTable

    return FoundTable(
        name=each.name,
        kind=each.kind,
        quantity=quantity,
        form=each.form,
        equation=each.equation,
        file=each.file,
        errors=ErrorsRecord(rms=each.rms, max=each.largest, where=each.where, points=each.points),
        size=each.coefficients,
        operations=each.operations,
    )


def _print(quantity: str, result: "Result", good: "list[Found]", limit: str, drawn: Path) -> None:
    from shadefit.terminal import print_lines, print_table

    first = [] if result.published is None else [result.published]
    print_table(
        f"{quantity}: the frontier of {len(result.found)} forms{limit}",
        ["table", "form", "coefficients", "operations", "rms", "largest", "published / this"],
        [_row(each, result.published) for each in (*first, *(good or result.best), *result.exact)],
        f"Operations a call, of P_s a direction. {result.refused} forms refused: they have poles, "
        "or are not shown to have none.",
    )
    print_lines(f"plot {drawn}.png")


def _row(each: "Found", published: "Found | None") -> list[str]:
    return [
        each.name,
        each.form or "exact",
        str(each.coefficients),
        str(each.operations),
        f"{each.rms:.3e}",
        f"{each.largest:.3e}",
        "—" if published is None else f"{published.largest / each.largest:.1f}",
    ]
