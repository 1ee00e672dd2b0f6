"""The command line `shadefit`: its commands are in `shadefit.commands`."""

import os
import sys
from importlib.metadata import version
from typing import Annotated

import typer

from shadefit.commands import code, pictures, tables

app = typer.Typer(
    name="shadefit",
    help="Exact shading integrals, certified curve fits, and coefficient tables.",
    epilog="Example: shadefit compare r",
    no_args_is_help=False,
    pretty_exceptions_enable=False,
)


def _print_version(wanted: bool | None) -> None:
    if wanted:
        print(f"shadefit {version('shadefit')}")
        raise typer.Exit


for part in (tables, code, pictures):
    app.add_typer(part.app)


@app.callback()
def _global(
    _version: Annotated[
        bool | None,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version."
        ),
    ] = None,
) -> None:
    pass


def main(arguments: list[str] | None = None) -> None:
    """Run the command line; exit status 2 with one line on standard error for bad input."""
    # Whatever the environment says: the references refuse to run without.
    os.environ["JAX_ENABLE_X64"] = "1"
    # One thread: more would change the order of sums, and so the last digits, with the machine.
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    given = sys.argv[1:] if arguments is None else arguments
    try:
        status = app(given or ["--help"], standalone_mode=False)
    except (typer.TyperException, ValueError) as error:
        message = error.format_message() if isinstance(error, typer.TyperException) else str(error)
        _fail(message, 2)
    except BrokenPipeError:
        # The reader of our output has gone: not an error, but Python would complain at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(0)
    sys.exit(status or 0)


def _fail(message: str, status: int) -> None:
    # Typer leaves in what its validator calls the kind of an error.
    words = message.replace(": Value error, ", ": ").split()
    print(f"shadefit: {' '.join(words)}", file=sys.stderr)
    sys.exit(status)
