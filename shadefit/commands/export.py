"""`shadefit export`: write a table as JSON, or tables as shader code whose header states errors."""

from pathlib import Path
from typing import Annotated, Literal

import typer

from shadefit.commands.names import require_tables
from shadefit.completion import complete_language, complete_shader

_JSON = "json"


def export(
    tables: Annotated[
        list[str],
        typer.Argument(
            help="Names or paths of tables; for code also names of functions, such as exact/ps "
            "or detail/overlay.",
            autocompletion=complete_shader,
        ),
    ],
    to: Annotated[
        str | None,
        typer.Option(
            help="Language of the code, or json; by default that of --output's suffix, or json.",
            metavar="LANG",
            autocompletion=complete_language,
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="File to write; by default standard output."),
    ] = None,
    precision: Annotated[
        str | None,
        typer.Option(
            help="half, float or double; by default float, for JavaScript double. In glsl-es, half "
            "is mediump and float is highp."
        ),
    ] = None,
    name: Annotated[
        str | None,
        typer.Option(help="Name of the function; by default that of the paper's listing."),
    ] = None,
    constants: Annotated[
        Literal["inline", "table"] | None,
        typer.Option(help="Where the code has its constants; by default inline."),
    ] = None,
    interface: Annotated[
        Literal["listing", "material"] | None,
        typer.Option(
            help="listing: the functions of the paper, with arrays that differ between tables. "
            "material: FuzzPsMaterial returns a structure and FuzzPs takes it, the same for every "
            "table of P_s and its closed form. By default listing."
        ),
    ] = None,
    layout: Annotated[
        Literal["array", "struct", "vec4"] | None,
        typer.Option(
            help="Content of that structure, or of the one that a sampler returns: an array, "
            "single numbers, or vectors of four for a constant buffer; by default array."
        ),
    ] = None,
    cosines: Annotated[
        bool,
        typer.Option("--cosines", help="Take NdotT, the cosine, in place of the angle thetaF."),
    ] = False,
    prefix: Annotated[
        str | None, typer.Option(help="What names of functions and structures begin with.")
    ] = None,
    namespace: Annotated[
        str | None, typer.Option(help="Namespace of the functions (cpp, cuda, hlsl, metal, slang).")
    ] = None,
    together: Annotated[
        str | None,
        typer.Option(
            help="Name of one function that returns the values of all tables, and computes once "
            "what they share, such as a denominator.",
            metavar="NAME",
        ),
    ] = None,
    bundle: Annotated[
        str | None,
        typer.Option(
            help="shadertoy, isf, unity, unreal, materialx or blender-osl: a file for this "
            "program, with its entry points, in its language, and with --interface material.",
            metavar="HOST",
        ),
    ] = None,
) -> None:
    """Write a table as JSON, or tables as code in a language.

    The code is run if its compiler is installed. Its header states the error
    that was measured.
    """
    require_tables(tables)
    if output == Path("-"):
        output = None
    if bundle is not None:
        from coefficients.bundles import bundle as find_bundle
        from coefficients.bundles import language_of_bundle

        to, interface = to or language_of_bundle(bundle), interface or "material"
        layout = layout or find_bundle(bundle).layout
    key = _language(to, output)
    from coefficients.files import require_writable_file, write_whole
    from shadefit.encoding import shown_json

    if output is not None:
        require_writable_file(output)
    for_code = {
        "precision": precision,
        "name": name,
        "constants": constants,
        "interface": interface,
        "layout": layout,
        "cosines": cosines or None,
        "prefix": prefix,
        "namespace": namespace,
        "bundle": bundle,
        "together": together,
    }
    if key == _JSON:
        for option, given in for_code.items():
            if given is not None:
                raise ValueError(f"--{option} {given!r} is for code: allowed with --to LANG")
        if len(tables) > 1:
            raise ValueError(
                f"{len(tables)} tables are for code: JSON is of one; allowed: --to LANG"
            )
        text = _content(tables[0])
    else:
        from coefficients.catalogue import resolve
        from coefficients.code_options import CodeOptions
        from coefficients.exported_code import source_file
        from coefficients.stated_errors import require_stated

        options = CodeOptions(
            interface=interface or "listing",
            layout=layout or "array",
            cosines=cosines,
            prefix=prefix or "",
            namespace=namespace,
            bundle=bundle,
            together=together,
        )
        entries = [resolve(each) for each in tables]
        for entry in entries:
            require_stated(entry)
        text = source_file(entries, key, precision, name, constants or "inline", options)
    if output is None:
        print(shown_json(text) if key == _JSON else text, end="")
    else:
        write_whole(output, text)


def _content(name: str) -> str:
    """Return a table as JSON. A packaged table is written without JAX."""
    from coefficients.packaged import is_packaged, packaged_table
    from coefficients.table import serialise

    if is_packaged(name):
        return serialise(packaged_table(name))
    from coefficients.catalogue import resolve
    from coefficients.stated_errors import require_stated

    entry = resolve(name)
    table = entry.require_table()
    require_stated(entry)
    return serialise(table)


def _language(to: str | None, output: Path | None) -> str:
    """Return the key of the language, or 'json'.

    Raises ValueError for a name of a file that does not say what is to be written to it, or that
    contradicts the language.
    """
    from programs.languages import language, language_of_file, require_suffix

    file = "" if output is None else output.name
    if to is None:
        if output is None or file.lower().endswith(".json"):
            return _JSON
        found = language_of_file(file)
        if found is None:
            raise ValueError(
                f"{file!r} has no suffix that says what to write: allowed are that of a language, "
                ".json, or --to LANG"
            )
        return found
    if to.lower() == _JSON:
        return _JSON
    key = language(to).key
    if file.lower().endswith(".json"):
        raise ValueError(f"{file!r} is no name for code: allowed is .json without --to {to}")
    require_suffix(file, key)
    return key
