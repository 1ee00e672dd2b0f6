"""Memory: what is free goes back to the system, and long commands stay below a gigabyte."""

import subprocess
import sys
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from shadefit import memory
from shadefit.images import image_of, write_image

LINUX = pytest.mark.skipif(sys.platform != "linux", reason="memory is read from /proc")
# Bytes that a command may take
BUDGET = 1_000_000_000
# The rest is left to other machines, and to what two threads happen to compile at a time.
MARGIN = 0.95
_COMMAND = r"""
import re, sys
from pathlib import Path
from shadefit.cli import main
sys.argv = ["shadefit", *sys.argv[1:]]
try:
    main()
except SystemExit as end:
    assert not end.code, end.code
# The peak of getrusage would count the process that started this one, too.
print(re.search(r"VmHWM:\s+(\d+) kB", Path("/proc/self/status").read_text())[1])
"""

_SMALL_BLOCKS = """
from shadefit import memory
before = memory.resident()
blocks = [bytes([number % 251]) * (1 << 16) for number in range(2000)]
held = memory.resident()
assert held - before > 100e6, (before, held)
# The last one keeps the top of the heap from shrinking.
del blocks[:-1]
kept = memory.resident()
assert held - kept < 50e6, (held, kept)
memory.give_back(kept_below=1 << 60)
after = memory.resident()
assert held - after > 100e6, (held, after)
"""


def peak(*arguments: str) -> int:
    """Run a command without the cache of compiled programs. Return its peak memory in bytes."""
    done = subprocess.run(
        [sys.executable, "-c", _COMMAND, *arguments], capture_output=True, text=True, check=True
    )
    return 1024 * int(done.stdout.splitlines()[-1])


@LINUX
def test_free_memory_goes_back_to_the_system():
    """Many small blocks stay with the C library when they are freed, until they are given back.

    In a process of its own: one that has run other tests takes the blocks from memory that it has.
    """
    subprocess.run([sys.executable, "-c", _SMALL_BLOCKS], check=True)


@LINUX
def test_programs_are_dropped_only_beyond_the_limit():
    compiled = 0

    @jax.jit
    def twice(x):
        nonlocal compiled
        compiled += 1
        return 2 * x

    for limit, count in ((1 << 60, 1), (0, 2)):
        twice(jnp.ones(3))
        memory.give_back(kept_below=limit)
        assert float(twice(jnp.ones(3)).sum()) == 6
        assert compiled == count


def test_a_system_that_does_not_say_its_memory_keeps_programs(monkeypatch):
    monkeypatch.setattr(memory, "_STATUS", Path("/proc/none"))
    assert memory.resident() is None
    memory.give_back(kept_below=0)


@LINUX
@pytest.mark.slow
def test_the_largest_rendering_stays_below_a_gigabyte(tmp_path):
    """Of one scene: a second one adds its four images, of 25 MB each."""
    most = peak("render", "sphere", "--size", "1024", "--out", str(tmp_path))
    assert most < MARGIN * BUDGET - 4 * 25e6
    assert (tmp_path / "render.exr").stat().st_size > 50e6


@LINUX
@pytest.mark.slow
def test_a_report_stays_below_a_gigabyte(tmp_path):
    """Of pictures that are there, but for the one that takes the most memory."""
    pictures = tmp_path / "pictures"
    pictures.mkdir()
    for picture in Path("docs/figures").glob("*.png"):
        if picture.stem != "ambient-cloth":
            (pictures / picture.name).write_bytes(picture.read_bytes())
    page = tmp_path / "report.html"
    assert peak("report", "--pictures", str(pictures), "--out", str(page)) < MARGIN * BUDGET
    assert "figure-ambient-cloth" in page.read_text()


@LINUX
@pytest.mark.slow
def test_maps_are_worked_on_in_bands(tmp_path):
    """Filtering keeps both maps in float64, 0.2 GB here, and encoding one; no copies of them."""
    for name, colour in (("normal", (0.5, 0.5, 1.0)), ("grey", (0.5,))):
        pixels = np.full((2048, 2048, len(colour)), colour, np.float32)
        write_image(tmp_path / f"{name}.png", image_of(pixels, "linear", name))
    normal, grey = (str(tmp_path / f"{name}.png") for name in ("normal", "grey"))
    filtering = ("--colour-space", "linear", "--convention", "opengl", "--method", "clean")
    out = ("--out", str(tmp_path / "out.dds"))
    encoding = ("--format", "rgba8", "--no-mips", "--json")
    assert peak("maps", "filter", normal, grey, *filtering, *out, "--json") < 0.7e9
    assert (
        peak("maps", "encode", grey, grey, grey, *encoding, "-o", str(tmp_path / "e.dds")) < 0.7e9
    )
