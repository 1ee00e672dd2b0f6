"""Processor time of searches: `python benchmarks/search_times.py [QUANTITY …]`.

Each search begins with an empty folder, once without the cache of compiled programs, and once with
what the first run has put into a cache.
"""

import argparse
import os
import sys
import tempfile
from pathlib import Path

from processes import Run, run


def search(quantity: str, folder: Path, cache: Path) -> Run:
    """Search among the forms of a quantity."""
    command = [sys.executable, "-m", "shadefit", "search", quantity, "--out", str(folder)]
    return run(command, {"SHADEFIT_CACHE": str(cache)})


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("quantity", nargs="*", default=["q", "g"])
    quantities = parser.parse_args().quantity
    print(f"load average {os.getloadavg()[0]:.2f} on {os.cpu_count()} processors\n")
    print("| | CPU seconds | tables | MiB |\n| --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as place:
        for quantity in quantities:
            for when in ("first run", "again"):
                folder = Path(place) / f"{quantity}-{when}"
                each = search(quantity, folder, Path(place) / "cache")
                name, count = f"`shadefit search {quantity}`, {when}", len([*folder.glob("*.json")])
                print(f"| {name} | {each.processor:.1f} | {count} | {each.mebibytes:.0f} |")


if __name__ == "__main__":
    main()
