"""Problem files: Python files in which a user declares quantities.

To name such a file is consent to run it. No file is loaded that was not named: not from the working
folder, not from an environment variable, and never because a table's JSON says so.
"""

import importlib.util
import sys
import traceback
from pathlib import Path

from quantities.problem import Problem
from quantities.registry import register, unregister

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
    found = {problem.name: problem for problem in _declared(path)}
    if not found:
        raise ValueError(f"{path} declares no quantity: it needs a module-level shadefit.Problem")
    if wanted and wanted not in found:
        raise ValueError(f"{path} declares no {wanted!r}: allowed are {', '.join(found)}")
    chosen = [found[wanted]] if wanted else list(found.values())
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
    try:
        spec.loader.exec_module(module)
    except Exception as error:
        del sys.modules[name]
        raise ProblemFileError(_own_traceback(error, path)) from None
    values = [value for key, value in vars(module).items() if not key.startswith("__")]
    return list(dict.fromkeys(value for value in values if isinstance(value, Problem)))


def _own_traceback(error: Exception, path: Path) -> str:
    """Write an error with the lines of the file that led to it, without those of others."""
    own = [
        each for each in traceback.extract_tb(error.__traceback__) if Path(each.filename) == path
    ]
    lines = traceback.format_list(own) if own else [f'  File "{path}"\n']
    return "".join([*lines, *traceback.format_exception_only(error)]).rstrip()
