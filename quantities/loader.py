"""Problem files: Python files in which a user declares quantities.

To name such a file is consent to run it. No file is loaded that was not named: not from the working
folder, not from an environment variable, and never because a table's JSON says so.
"""

import importlib.util
import sys
import traceback
from contextlib import redirect_stdout
from pathlib import Path

from integrals.data import PROBLEM_FOLDER
from quantities.problem import Problem
from quantities.registry import register, unregister

_PROJECT = Path(__file__).parents[1]
_PACKAGES = (
    *("shading", "integrals", "programs", "fitting", "quantities", "coefficients"),
    "shadefit",
)
_JAX_NOTE = "JAX has removed its internal frames"
# What each file declared when it was last loaded, and how the file was named then. Loading it again
# replaces this.
_LOADED: dict[Path, tuple[str, list[Problem]]] = {}


class ProblemFileError(Exception):
    """A problem file raised an error; the text is the traceback within that file alone."""


def load_problems(named: str) -> list[Problem]:
    """Run a problem file and register the quantities that it declares.

    `named` is FILE.py, or FILE.py:NAME for one quantity of several. Quantities that the same file
    declared before are replaced. Returns the quantities. Raises
    ValueError for a file that cannot be read, that declares none, or that declares no NAME; and
    `ProblemFileError` for an error that the file itself raises.
    """
    file, _, wanted = named.partition(".py:")
    path = Path(f"{file}.py" if wanted else named)
    if path.suffix != ".py" or not path.is_file():
        raise ValueError(f"{path} is no problem file: allowed is a Python file, FILE.py[:NAME]")
    try:
        path.read_bytes()
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror or error}") from None
    # The interpreter names files by absolute paths.
    found = {problem.name: problem for problem in _declared(path.absolute())}
    if not found:
        raise ValueError(f"{path} declares no quantity: it needs a module-level shadefit.Problem")
    if wanted and wanted not in found:
        raise ValueError(f"{path} declares no {wanted!r}: allowed are {', '.join(found)}")
    chosen = [found[wanted]] if wanted else list(found.values())
    for problem in chosen:
        _require_published_forms(problem, path)
    _, before = _LOADED.pop(path.resolve(), (named, []))
    for problem in before:
        unregister(problem.name)
    for problem in chosen:
        register(problem)
    _LOADED[path.resolve()] = str(path), chosen
    return chosen


def option_for(problem: Problem) -> list[str]:
    """Return the option that loads a quantity again, for a command; none for a built-in one."""
    files = [file for file, declared in _LOADED.values() if problem in declared]
    return ["-p", files[0]] if files else []


def _declared(path: Path) -> list[Problem]:
    """Run a file as a module and return the quantities that its names stand for."""
    name = f"shadefit_problem_{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    # Traced functions look their source up by the module.
    sys.modules[name] = module
    token = PROBLEM_FOLDER.set(path.parent)
    try:
        # Standard output is for what the command writes.
        with redirect_stdout(sys.stderr):
            spec.loader.exec_module(module)
    # A file that calls sys.exit would end the command as if it had done its work.
    except (Exception, SystemExit, GeneratorExit) as error:
        sys.modules.pop(name, None)
        line = _line_of_misuse(error, path)
        if line is None:
            raise ProblemFileError(_own_traceback(error, path)) from None
        place = "" if str(error).startswith(f"{path.name}:") else f"{path.name}:{line}: "
        raise ValueError(f"{place}{error}") from None
    finally:
        PROBLEM_FOLDER.reset(token)
    values = [value for key, value in vars(module).items() if not key.startswith("__")]
    return list(dict.fromkeys(value for value in values if isinstance(value, Problem)))


def _require_published_forms(problem: Problem, path: Path) -> None:
    """Raise ValueError if published constants do not belong to a form of the quantity."""
    for each in problem.published:
        try:
            size = problem.find_form(each.form).size
        except ValueError as error:
            raise ValueError(f"{path}: published constants of {problem.name}: {error}") from None
        if size != len(each.coefficients):
            raise ValueError(
                f"{path}: published constants of {problem.name}: {len(each.coefficients)} given, "
                f"form {each.form!r} has {size} coefficients"
            )


def _line_of_misuse(error: BaseException, path: Path) -> int | None:
    """Return the line of a file that called this project wrongly; None for an error of its own.

    This project reports misuse by ValueError, or RuntimeError.
    """
    frames = traceback.extract_tb(error.__traceback__)
    own = [frame.lineno for frame in frames if Path(frame.filename) == path]
    last = Path(frames[-1].filename)
    ours = last.is_relative_to(_PROJECT) and last.relative_to(_PROJECT).parts[0] in _PACKAGES
    if own and ours and type(error) in (ValueError, RuntimeError):
        return own[-1]
    return None


def _own_traceback(error: BaseException, path: Path) -> str:
    """Write an error with the lines of the file that led to it, without those of others."""
    own = [
        each for each in traceback.extract_tb(error.__traceback__) if Path(each.filename) == path
    ]
    lines = traceback.format_list(own) if own else [f'  File "{path}"\n']
    # JAX adds a note to every error: that its own frames are left out.
    notes = vars(error).get("__notes__")
    if isinstance(notes, list):
        notes[:] = [each for each in notes if _JAX_NOTE not in str(each)]
    return "".join([*lines, *traceback.format_exception_only(error)]).rstrip()
