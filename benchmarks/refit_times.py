"""Processor time of refits: `python benchmarks/refit_times.py [--write FOLDER] [--grids N,N,…]`.

(a) The four tables of the paper, and these with `velvet`, on 65×65 nodes: once with an empty cache
of compiled programs, once again, and by plain NumPy and SciPy with the closed forms
(closed_form_scipy.py). (b) `refit ps` on finer grids. `--write` puts the tables into
FOLDER/performance.md, between its comments, and the plot beside it.
"""

import argparse
import json
import os
import sys
import tempfile
from pathlib import Path

from matplotlib.figure import Figure
from processes import Run, run

HERE = Path(__file__).parent
PAPER = ["ps", "g", "q", "r"]
GRIDS = [65, 129, 257, 513, 1025]
MARK = "<!-- made by make bench: {} -->"
LEFT_OUT = (
    "Left out by NumPy and SciPy: the joint fit of P_s (its six surfaces are fitted one by one), "
    "errors off the grid and the search for the largest, error bounds of the exact values, proofs "
    "that there is no pole, bounds of the values, the files. Left out by shadefit: its joint fit "
    "of P_s uses 17×17 of the 65×65 materials, and measures the errors at all of them."
)


def refit(names: list[str], folder: str, cache: str = "off", grid: int = 65) -> Run:
    """Refit tables into a folder."""
    command = [sys.executable, "-m", "shadefit", "refit", *names, "--grid", str(grid)]
    return run([*command, "--out", folder, "--json"], {"SHADEFIT_CACHE": cache})


def compare() -> dict[str, tuple[float, float]]:
    """Return processor seconds and MiB of each way to refit the paper's tables."""
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for names in (PAPER, [*PAPER, "velvet"]):
            cache = str(Path(folder) / "-".join(names))
            for when in ("first run", "again"):
                key = f"`shadefit refit {' '.join(names)}`, {when}"
                found[key] = refit(names, folder, cache)
        peer = run([sys.executable, str(HERE / "closed_form_scipy.py")])
    parts = json.loads(peer.output)["notes"]
    print(f"rms errors by NumPy and SciPy: {parts}", file=sys.stderr)
    found["NumPy and SciPy, closed forms known"] = peer
    return {name: (each.processor, each.mebibytes) for name, each in found.items()}


def finer(grids: list[int]) -> dict[int, tuple[float, float]]:
    """Return processor seconds and MiB of `refit ps` on grids of so many nodes an axis."""
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        for count in grids:
            each = refit(["ps"], folder, grid=count)
            found[count] = each.processor, each.mebibytes
    return found


def comparison_table(found: dict[str, tuple[float, float]]) -> str:
    last = list(found.values())[-1][0]
    rows = [
        f"| {name} | {seconds:.1f} | {seconds / last:.1f} | {memory:.0f} |"
        for name, (seconds, memory) in found.items()
    ]
    head = ["| | CPU seconds | to the last | MiB |", "| --- | --- | --- | --- |"]
    return "\n".join([*head, *rows])


def grid_table(found: dict[int, tuple[float, float]]) -> str:
    rows = [
        f"| {count}² | {count**2 * 2304 / 1e6:,.0f} | {seconds:.1f} | {memory:.0f} |"
        for count, (seconds, memory) in found.items()
    ]
    head = ["| grid | million exact values | CPU seconds | MiB |", "| --- | --- | --- | --- |"]
    return "\n".join([*head, *rows])


def plot(found: dict[int, tuple[float, float]]) -> Figure:
    figure = Figure(figsize=(6.4, 2.6), layout="constrained")
    left, right = figure.subplots(1, 2)
    materials = [count**2 / 1e6 for count in found]
    seconds, memory = zip(*found.values(), strict=True)
    left.plot(materials, seconds, "o-", color="#0072b2")
    left.set(xlabel="million materials", ylabel="CPU seconds", ylim=(0, None), xlim=(0, None))
    right.plot(materials, memory, "s-", color="#d55e00")
    # Room for the markers of the largest, which the edge would cut.
    top = 1.08 * max(memory)
    right.set(xlabel="million materials", ylabel="peak memory, MiB", ylim=(0, top), xlim=(0, None))
    return figure


def replaced(text: str, name: str, table: str) -> str:
    """Put a table between its two comments in a page."""
    begin, end = MARK.format(name), MARK.format(f"end of {name}")
    before, _, rest = text.partition(begin)
    _, found, after = rest.partition(end)
    if not found:
        raise SystemExit(f"the page has no comments {begin} and {end}")
    return f"{before}{begin}\n\n{table}\n\n{end}{after}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", type=Path, help="folder of performance.md")
    parser.add_argument("--grids", default=",".join(map(str, GRIDS)))
    options = parser.parse_args()
    grids = [int(each) for each in options.grids.split(",") if each]
    print(f"load average {os.getloadavg()[0]:.2f} on {os.cpu_count()} processors\n")
    tables = {"refits": comparison_table(compare())}
    print(f"{tables['refits']}\n\n{LEFT_OUT}\n")
    if grids:
        found = finer(grids)
        tables["grids"] = grid_table(found)
        print(tables["grids"])
    if options.write:
        page = options.write / "performance.md"
        text = page.read_text(encoding="utf-8")
        for name, table in tables.items():
            text = replaced(text, name, table)
        page.write_text(text, encoding="utf-8")
        if grids:
            # What it imports needs float64.
            os.environ["JAX_ENABLE_X64"] = "1"
            from shadefit.figures.style import render  # noqa: PLC0415

            files = render(lambda: plot(found))
            (options.write / "performance.png").write_bytes(files["png"])


if __name__ == "__main__":
    main()
