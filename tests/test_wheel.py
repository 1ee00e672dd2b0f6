"""The built packages, installed without the checkout: complete, working, and never written into.

The dependencies are those of the environment that runs the tests, so that no network is needed.
"""

import hashlib
import json
import os
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile
from pathlib import Path

import pytest

pytestmark = pytest.mark.wheel

ROOT = Path(__file__).parent.parent
PACKAGES = (
    *("shading", "integrals", "programs", "fitting", "quantities", "coefficients", "shadefit"),
)
POINT = ("evaluate", "q", "--density", "0.3")


def packaged_files() -> set[str]:
    """Return the files below the packages, relative to the checkout."""
    every = (path for package in PACKAGES for path in (ROOT / package).rglob("*"))
    return {
        path.relative_to(ROOT).as_posix()
        for path in every
        if path.is_file() and "__pycache__" not in path.parts
    }


def uv(*arguments: str) -> None:
    own = shutil.which("uv", path=f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    assert own is not None
    subprocess.run([own, *arguments, "--offline", "--quiet"], check=True, cwd=ROOT)


@pytest.fixture(scope="session")
def built(tmp_path_factory) -> Path:
    """A folder with the sdist, and the wheel that was built from the sdist."""
    folder = tmp_path_factory.mktemp("dist")
    uv("build", "--no-build-isolation", "--python", sys.executable, "--out-dir", str(folder))
    return folder


@pytest.fixture(scope="session")
def environment(built, tmp_path_factory) -> Path:
    """An environment with the wheel, and with the dependencies of the one that runs the tests."""
    folder = tmp_path_factory.mktemp("environment") / "venv"
    uv("venv", "--python", sys.executable, str(folder))
    (wheel,) = built.glob("*.whl")
    uv("pip", "install", "--no-deps", "--python", str(folder / "bin" / "python"), str(wheel))
    (packages,) = folder.glob("lib/*/site-packages")
    # A path within such a file does not run the .pth files there: the checkout is not found.
    (packages / "dependencies.pth").write_text(sysconfig.get_path("purelib"))
    return folder


@pytest.fixture(scope="session")
def installed(environment) -> Path:
    """The folder of the installed packages; it is the same after all tests as before."""
    (packages,) = environment.glob("lib/*/site-packages")
    before = digests(packages)
    for path in packages.rglob("*"):
        path.chmod(path.stat().st_mode & ~0o222)
    yield packages
    assert digests(packages) == before


def digests(folder: Path) -> dict[str, str]:
    files = (path for path in folder.rglob("*") if path.is_file())
    return {str(path): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


@pytest.fixture
def run(environment, installed, tmp_path):
    """Run the installed command in an empty folder: status, output and errors."""

    def command(*arguments: str) -> tuple[int, str, str]:
        kept = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
        done = subprocess.run(
            [environment / "bin" / "shadefit", *arguments],
            capture_output=True,
            text=True,
            cwd=tmp_path,
            env={**kept, "PYTHONDONTWRITEBYTECODE": "1"},
            check=False,
        )
        return done.returncode, done.stdout, done.stderr

    return command


def test_the_wheel_has_every_file_of_the_packages(built):
    (wheel,) = built.glob("*.whl")
    with zipfile.ZipFile(wheel) as archive:
        names = set(archive.namelist())
        (metadata,) = (name for name in names if name.endswith(".dist-info/METADATA"))
        text = archive.read(metadata).decode()
    about = {name for name in names if ".dist-info/" in name}
    assert names - about == packaged_files()
    assert any(name.endswith("/licenses/LICENSE") for name in about)
    assert "License-Expression: Apache-2.0\n" in text
    assert "Author: shadefit contributors\n" in text


def test_the_sdist_has_what_the_tests_need(built):
    (sdist,) = built.glob("*.tar.gz")
    with tarfile.open(sdist) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    assert packaged_files() <= names
    for name in ("LICENSE", "CITATION.cff", "Makefile", "requirements.lock", "README.md"):
        assert name in names
    assert {"tests/test_wheel.py", "docs/closed-form.md", "examples/soft_step.py"} <= names
    assert not [name for name in names if "__pycache__" in name]


def test_it_is_the_installed_package_that_runs(environment, installed, tmp_path):
    code = "import shadefit, coefficients; print(shadefit.__file__, coefficients.__file__)"
    kept = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    command = [environment / "bin" / "python", "-B", "-c", code]
    done = subprocess.run(
        command, capture_output=True, text=True, cwd=tmp_path, env=kept, check=True
    )
    for path in done.stdout.split():
        assert Path(path).is_relative_to(installed)


def test_tables_are_listed(run):
    status, out, _ = run("list", "--json")
    assert status == 0
    tables = {path.stem for path in (ROOT / "coefficients" / "tables").rglob("*.json")}
    listed = {table["name"].partition("@")[0].split("/")[-1] for table in json.loads(out)["tables"]}
    assert listed == tables


def test_a_quantity_is_evaluated(run):
    status, out, _ = run(*POINT, "--json")
    assert status == 0
    found = json.loads(out)
    # Q(0.3) = 2 E₃(0.3)
    assert found["legs"]["closed_form"]["value"] == pytest.approx(0.600083653128029, abs=1e-14)
    assert {table["kind"] for table in found["tables"]} == {"published", "refitted", "best"}


@pytest.mark.parametrize("folder", ["empty", "looks like a checkout"])
def test_a_table_is_refitted_into_a_folder_and_only_there(run, tmp_path, folder):
    kept = []
    if folder != "empty":
        # The folder where the command runs does not matter.
        (tmp_path / "pyproject.toml").write_text('[project]\nname = "shadefit"\n')
        (tmp_path / "coefficients" / "tables" / "fuzz" / "refit").mkdir(parents=True)
        kept = ["coefficients", "pyproject.toml"]
    for name in ("q", "best/q-9"):
        status, out, error = run("refit", name)
        assert (status, out) == (2, "")
        assert (
            error == f"shadefit: {name} comes with an installed package: give a folder by --out\n"
        )
    assert not list(tmp_path.rglob("*.json"))
    assert sorted(path.name for path in tmp_path.iterdir()) == kept
    assert run("refit", "q", "--out", str(tmp_path / "tables"))[0] == 0
    # On the grid of the packaged table it is the same table.
    packaged = ROOT / "coefficients" / "tables" / "fuzz" / "refit" / "q.json"
    made = json.loads((tmp_path / "tables" / "q.json").read_text())
    assert made["coefficients"] == pytest.approx(
        json.loads(packaged.read_text())["coefficients"], rel=1e-9
    )
    assert sorted(path.name for path in tmp_path.iterdir()) == [*kept, "tables"]


def test_every_command_that_writes_leaves_the_package_alone(run, tmp_path):
    """The fixture `installed` compares the whole package afterwards."""
    for command in (
        ["search", "q", "--budget", "4"],
        ["certify", "q", "--out", "proven"],
        ["bake", "q", "--size", "8", "--format", "csv"],
        ["new", "lobe"],
    ):
        assert run(*command)[0] == 0, command
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "build",
        "lobe.py",
        "proven",
        "q.csv",
    ]


def test_code_is_exported(run, tmp_path):
    assert run("export", "best/q-9", "--to", "python", "-o", "q.py")[0] == 0
    assert "def FuzzAveragePenetration(" in (tmp_path / "q.py").read_text()
    # A language whose compiler needs a header that comes with the package.
    status, out, _ = run("verify", "best/q-9", "--to", "metal", "--json")
    (check,) = json.loads(out)["tables"][0]["checks"]
    assert status == 0
    assert check["status"] in ("passed", "not checked")
