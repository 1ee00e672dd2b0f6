"""The command line `shadefit`, which consists of the commands in `shadefit.commands`."""

import functools
import inspect
import sys
from collections.abc import Callable
from importlib.metadata import version
from typing import Annotated

import typer

from shadefit.commands.ambient import ambient
from shadefit.commands.bake import bake
from shadefit.commands.certify import certify
from shadefit.commands.compare import compare
from shadefit.commands.cost import cost
from shadefit.commands.curvature import curvature
from shadefit.commands.detail import detail
from shadefit.commands.evaluate import SETTINGS, evaluate
from shadefit.commands.export import export
from shadefit.commands.figures import figures
from shadefit.commands.fit import fit
from shadefit.commands.list import list_tables
from shadefit.commands.maps import maps
from shadefit.commands.maps_encode import encode as maps_encode
from shadefit.commands.ndf import ndf
from shadefit.commands.new import new
from shadefit.commands.refit import refit
from shadefit.commands.render import render
from shadefit.commands.report import report
from shadefit.commands.search import search
from shadefit.commands.verify import verify
from shadefit.encoding import install, visible
from shadefit.environment import fix_environment
from shadefit.standard_streams import READER_GONE, OutputError, end, end_without_output

# Characters; a path may have this many.
_LONGEST_WORD = 400

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


def _add(name: str, command: Callable, examples: str, **options) -> None:
    app.command(name, epilog=examples, **options)(_with_problem_files(command))


def _with_problem_files(command: Callable) -> Callable:
    """Give a command the option -p, which loads a user's quantities before the command runs."""

    @functools.wraps(command)
    def run(*arguments, problem: list[str] | None = None, **options):
        if problem:
            from quantities.loader import load_problems  # noqa: PLC0415

            for each in problem:
                load_problems(each)
        return command(*arguments, **options)

    signature = inspect.signature(command)
    option = inspect.Parameter("problem", inspect.Parameter.KEYWORD_ONLY, default=None)
    option = option.replace(annotation=_ProblemFiles)
    parameters = [*signature.parameters.values(), option]
    # Typer reads a command's options from these two.
    vars(run)["__signature__"] = signature.replace(parameters=parameters)
    run.__annotations__ = {**command.__annotations__, "problem": _ProblemFiles}
    return run


_ProblemFiles = Annotated[
    list[str] | None,
    typer.Option(
        "-p",
        "--problem",
        help="Python file that declares quantities, FILE.py[:NAME]; it is run. May be given again.",
        metavar="FILE",
    ),
]


_add(
    "refit",
    refit,
    "Examples: shadefit refit r g --out /tmp/tables --grid 33; "
    "shadefit refit best/q-9; shadefit refit g --norm linf --out /tmp/tables",
)
_add(
    "fit",
    fit,
    "Example: shadefit fit data.csv --x NdotV,alpha --y E --sigma sigma --form rational:2,2",
)
_add(
    "ndf",
    ndf,
    "Examples: shadefit ndf ggx:0.1 -o ggx.json --to hlsl --code ggx.hlsl; "
    "shadefit ndf ggx:0.2,0.3 --to glsl --verify; "
    "shadefit ndf measured.csv --theta theta --value D --segments 24",
)
_add(
    "curvature",
    curvature,
    "Examples: shadefit curvature head.obj --unit cm -o head.ply; "
    "shadefit curvature head.obj --unit cm --picture head.png --view 30,10; "
    "shadefit curvature hand.glb --unit m --widths none --json",
)
_add("new", new, "Example: shadefit new fresnel --axes eta=1:3")
_add(
    "search",
    search,
    "Examples: shadefit search q --budget 12 --max-error 2e-5; shadefit search ps --jobs 8",
)
_add("compare", compare, "Example: shadefit compare ps my/table.json --json")
_add(
    "evaluate",
    evaluate,
    "Examples: shadefit evaluate ps --alpha 0.35 --theta-f 45deg --theta-u 30deg "
    "--phi 90deg; shadefit evaluate g --density 0.2 --cos-v 0.5; "
    "shadefit evaluate r --points points.csv --out values.npy",
    context_settings=SETTINGS,
)
_add(
    "bake",
    bake,
    "Examples: shadefit bake r --size 64x64 --format ktx2 -o r.ktx2; "
    "shadefit bake exact/g --size 32x32 --format exr --range density=0.001:0.5:logarithmic",
)
_add("list", list_tables, "Example: shadefit list --json")
_add(
    "export",
    export,
    "Examples: shadefit export published/ps -o ps.json; "
    "shadefit export exact/ps --to hlsl --precision half",
)
_add("verify", verify, "Example: shadefit verify ps exact/ps --to wgsl --precision all")
_add(
    "certify",
    certify,
    "Examples: shadefit certify best/q-9 best/g-17; shadefit certify all --out /tmp/tables; "
    "shadefit certify best/ps-11 --at-most 0.07",
)
_add("cost", cost, "Example: shadefit cost ps --throughput")
_add("figures", figures, "Example: shadefit figures figure-5 frontier --out /tmp/figures")
_add(
    "render",
    render,
    "Examples: shadefit render --density 0.1 --tilt 45deg; "
    "shadefit render cloth --sweep --fibers even --size 160",
)
_add(
    "report",
    report,
    "Examples: shadefit report --out /tmp/report.html; "
    "shadefit report -p examples/soft_step.py /tmp/tables/soft.json",
)
maps.command(
    "encode",
    epilog="Example: shadefit maps encode along.png across.png direction.png "
    "--encoding quarter-root -o aniso.dds",
)(maps_encode)
app.add_typer(maps, name="maps")
_add("ambient", ambient, "Example: shadefit ambient --out /tmp/figures")
app.add_typer(detail, name="detail")


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
    """Run the command line. Bad input gives one line on standard error and exit status 2."""
    fix_environment()
    install()
    given = sys.argv[1:] if arguments is None else arguments
    try:
        status = app(given or ["--help"], standalone_mode=False)
    except (typer.TyperException, ValueError) as error:
        message = error.format_message() if isinstance(error, typer.TyperException) else str(error)
        _fail(message, 2)
    except OutputError as error:
        end_without_output(error)
    except OSError as error:
        place = "" if error.filename is None else f"{error.filename}: "
        _fail(f"{place}{error.strerror or error}", 2)
    except MemoryError:
        _fail("the memory does not suffice for this", 2)
    except Exception as error:
        files = sys.modules.get("coefficients.files")
        if files is not None and isinstance(error, files.ReaderGoneError):
            end(READER_GONE)
        loader = sys.modules.get("quantities.loader")
        if loader is None or not isinstance(error, loader.ProblemFileError):
            raise
        # The user's own traceback, as it is.
        print(visible(str(error)), file=sys.stderr)
        end(2)
    end(status or 0)


def _fail(message: str, status: int) -> None:
    # Typer puts the kind of an error into its message; it does not help the user.
    words = visible(message.replace(": Value error, ", ": ")).split()
    print(f"shadefit: {' '.join(map(_shortened, words))}", file=sys.stderr)
    end(status)


def _shortened(word: str) -> str:
    """Return a word of a message, without its middle if nobody could read it as a whole."""
    half = _LONGEST_WORD // 2
    return word if len(word) <= _LONGEST_WORD else f"{word[:half]}…{word[-half:]}"
