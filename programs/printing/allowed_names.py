"""Names in printed code: those of the user are checked, and local variables avoid all others."""

import re
from collections.abc import Sequence

from programs.functions import Function, require_identifier
from programs.languages import Language


def require_namespace(language: Language, namespace: str) -> None:
    """Raise ValueError for a namespace in a language without, or with a name that is refused."""
    if not language.namespaces:
        raise ValueError(
            f"namespace {namespace!r} is not possible in {language.name}; allowed: none"
        )
    require_identifier("namespace", namespace)
    _require(language, namespace, language.reserved | language.library)


def taken_names(
    language: Language,
    precision: str,
    function: Function,
    functions: Sequence[str],
    ending: Sequence[list[str]],
) -> set[str]:
    """Collect the names that local variables of a function cannot have.

    Arguments: `functions`, the names of all functions of the file; `ending`, the code after them,
    whose local variables have the names of the parameters. Raises ValueError for a name of the
    function, its parameters, its result or their structures that the language does not allow.
    """
    called = {
        word
        for template in [
            *(how.template for how in language.functions[precision].values()),
            *language.clamps.get(precision, ()),
        ]
        for word in re.findall(r"[A-Za-z_]\w*", template)
    }
    later = {
        word
        for block in ending
        for line in block
        for word in re.findall(r"([A-Za-z_]\w*)\(", line.partition(language.comment)[0])
    } - {*functions}
    own = [parameter.name for parameter in function.parameters]
    types = [each.record.name for each in (function, *function.parameters) if each.record]
    if function.result is not None:
        own.append(function.result_name)
    for name in [function.name, *types]:
        _require(language, name, language.reserved | language.library | called)
    members = function.record.vectors if function.record else ()
    for name in [*own, *members]:
        _require(language, name, language.reserved | called | later)
    for name in [*own, *types]:
        if name in functions:
            raise ValueError(f"name {name!r} is a function and a parameter; allowed: one of them")
    return {*language.reserved, *called, *own, *types, *functions}


def _require(language: Language, name: str, refused: frozenset[str] | set[str]) -> None:
    if name in refused or "__" in name or name.startswith(("_", "gl_")):
        raise ValueError(
            f"name {name!r} cannot be used in {language.name}; allowed: identifiers that are no "
            "word, macro, function or type of the language and its library, without '_' in front, "
            "'__' or 'gl_'"
        )
