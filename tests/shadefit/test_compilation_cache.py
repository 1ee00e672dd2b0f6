"""The cache of compiled programs: where it is, when it is refused, and that it changes nothing."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from shadefit import compilation_cache
from shadefit.compilation_cache import cache_root, is_safe, use_cache

pytestmark = pytest.mark.skipif(not hasattr(os, "geteuid"), reason="files have no owner here")


@pytest.fixture
def safe(tmp_path):
    # pytest's own folders are private; /tmp is sticky.
    assert all(not each.stat().st_mode & 0o022 for each in (tmp_path, tmp_path.parent))
    return tmp_path


def environment(folder: Path) -> dict[str, str]:
    return {"SHADEFIT_CACHE": str(folder)}


def test_the_folder_is_made_for_the_user_alone_and_jax_is_told(safe):
    given = environment(safe / "new" / "cache")
    folder = use_cache(given)
    assert folder is not None
    assert folder.parent == (safe / "new" / "cache").resolve()
    assert [each.stat().st_mode & 0o777 for each in (folder, *folder.parents[:2])] == [0o700] * 3
    assert given["JAX_COMPILATION_CACHE_DIR"] == str(folder)
    assert given["JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS"] == "0"


def test_a_second_command_finds_the_same_folder(safe):
    assert use_cache(environment(safe / "a")) == use_cache(environment(safe / "a"))


def test_the_variable_turns_it_off():
    given = {"SHADEFIT_CACHE": "off", "HOME": "/nowhere"}
    assert use_cache(given) is None
    assert "JAX_COMPILATION_CACHE_DIR" not in given


def test_a_folder_of_jax_s_own_variable_is_kept(safe):
    given = {**environment(safe / "a"), "JAX_COMPILATION_CACHE_DIR": "/elsewhere"}
    assert use_cache(given) is None
    assert given["JAX_COMPILATION_CACHE_DIR"] == "/elsewhere"
    assert not (safe / "a").exists()


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"HOME": "/h", "XDG_CACHE_HOME": "/x"}, "/x/shadefit/compiled"),
        ({"HOME": "/h"}, "/h/.cache/shadefit/compiled"),
        # The specification says that a relative path is to be ignored.
        ({"HOME": "/h", "XDG_CACHE_HOME": "x"}, "/h/.cache/shadefit/compiled"),
        ({"HOME": "h"}, None),
        ({}, None),
    ],
)
def test_the_place_follows_the_specification_of_cache_folders(monkeypatch, given, expected):
    monkeypatch.setattr(sys, "platform", "linux")
    assert cache_root(given) == (None if expected is None else Path(expected))


@pytest.mark.parametrize("mode", [0o777, 0o770, 0o755, 0o1777])
def test_a_folder_that_others_may_enter_is_refused_and_not_mended(safe, mode):
    folder = use_cache(environment(safe / "a"))
    assert folder is not None
    folder.chmod(mode)
    given = environment(safe / "a")
    assert use_cache(given) is None
    assert "JAX_COMPILATION_CACHE_DIR" not in given
    assert folder.stat().st_mode & 0o7777 == mode


def test_a_folder_below_one_that_others_may_write_is_refused_unless_it_is_sticky(safe):
    open_to_all = safe / "shared"
    open_to_all.mkdir()
    open_to_all.chmod(0o777)
    assert use_cache(environment(open_to_all / "a")) is None
    open_to_all.chmod(0o1777)
    assert use_cache(environment(open_to_all / "a")) is not None


def test_a_link_to_a_folder_that_others_may_write_is_refused(safe):
    open_to_all = safe / "shared"
    open_to_all.mkdir()
    open_to_all.chmod(0o777)
    (safe / "link").symlink_to(open_to_all)
    assert use_cache(environment(safe / "link")) is None


def test_a_folder_of_another_user_is_refused(safe, monkeypatch):
    folder = use_cache(environment(safe / "a"))
    assert folder is not None
    owner = os.geteuid()
    monkeypatch.setattr(os, "geteuid", lambda: owner + 1)
    assert not is_safe(folder)
    assert use_cache(environment(safe / "a")) is None


def test_a_folder_that_cannot_be_made_is_no_error(safe):
    (safe / "file").write_text("")
    assert use_cache(environment(safe / "file" / "a")) is None
    (safe / "dangling").symlink_to(safe / "nowhere")
    assert use_cache(environment(safe / "dangling")) is None


def test_the_oldest_entries_are_removed_when_the_cache_is_large(safe, monkeypatch):
    folder = use_cache(environment(safe / "a"))
    assert folder is not None
    for number in range(8):
        entry = folder / f"entry-{number}"
        entry.write_bytes(bytes(100))
        os.utime(entry, (number, number))
    monkeypatch.setattr(compilation_cache, "MOST_BYTES", 800)
    use_cache(environment(safe / "a"))
    assert len(list(folder.iterdir())) == 8
    monkeypatch.setattr(compilation_cache, "MOST_BYTES", 799)
    use_cache(environment(safe / "a"))
    assert sorted(each.name for each in folder.iterdir()) == [f"entry-{k}" for k in (5, 6, 7)]


_PROGRAM = """
import sys
import warnings
from shadefit.compilation_cache import use_cache
use_cache()
import jax, jax.numpy as jnp
print(jax.jit(lambda x: jnp.sin(x) * 3 + 1)(jnp.arange(3.0)))
"""


def run(folder: Path) -> subprocess.CompletedProcess:
    """Run a program that compiles with the cache in a folder."""
    variables = {**os.environ, "SHADEFIT_CACHE": str(folder), "JAX_ENABLE_X64": "1"}
    command = [sys.executable, "-W", "error", "-c", _PROGRAM]
    return subprocess.run(command, env=variables, capture_output=True, text=True, check=False)


def test_a_broken_entry_is_compiled_again_in_silence(safe):
    first = run(safe / "a")
    entries = [each for each in (safe / "a").glob("*/*") if each.is_file()]
    assert entries
    for each in entries:
        # As a writer leaves it that was killed
        each.write_bytes(each.read_bytes()[:-20])
    second = run(safe / "a")
    assert first.returncode == second.returncode == 0
    assert first.stderr == second.stderr == ""
    assert first.stdout == second.stdout == "[1.         3.52441295 3.72789228]\n"
