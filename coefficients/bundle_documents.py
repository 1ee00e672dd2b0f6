"""Bundles that are documents with a description: the Interactive Shader Format and MaterialX."""

import json
from collections.abc import Mapping, Sequence
from xml.sax.saxutils import escape

from coefficients.entry_points import Tables, arguments_of, decimal, height_name, label_of, middle
from programs.languages.spelling import shortest_decimal
from programs.printing.identifiers import ascii_text
from programs.printing.node_graph import Argument, Result, Source, node_graph

# MaterialX 1.38 and later read it.
_MATERIALX_VERSION = "1.38"
_ISF_VERSION = "2"


def isf_document(tables: Tables, headers: Sequence[Mapping[str, str]], source: str) -> str:
    """Put the description of one table's inputs, as JSON in a comment, above its source.

    The headers are in the source.
    """
    del headers
    (functions,) = tables
    *others, last = arguments_of(functions)
    sliders = [(each.name, label_of(each), *each.domain, middle(each)) for each in others]
    sliders.append((height_name(functions), "value at the upper edge", 0.1, 10.0, 1.0))
    keys = ("NAME", "LABEL", "MIN", "MAX", "DEFAULT")
    described = {
        "ISFVSN": _ISF_VERSION,
        "DESCRIPTION": f"{functions[-1].name} from left to right over {label_of(last)}",
        "CATEGORIES": ["Generator"],
        "INPUTS": [{"TYPE": "float", **dict(zip(keys, each, strict=True))} for each in sliders],
    }
    # Nothing in the JSON may end the comment.
    comment = json.dumps(described, indent=2).replace("*/", "* /")
    return f"/*{comment}*/\n\n{source}"


def materialx_document(tables: Tables, headers: Sequence[Mapping[str, str]], source: str) -> str:
    """Write a MaterialX document: for each table a node definition and a graph of standard nodes.

    The headers are documentation of the definitions. Code in a language (`source`) is not in the
    document, because renderers of MaterialX do not agree about it.
    """
    del source
    lines = ['<?xml version="1.0"?>', f'<materialx version="{_MATERIALX_VERSION}">']
    for functions, header in zip(tables, headers, strict=True):
        name = functions[-1].name
        told = [ascii_text(functions[-1].summary)]
        told += [ascii_text(f"{label}: {text}") for label, text in header.items()]
        node = {"name": f"ND_{name}_float", "node": name, "nodegroup": "math"}
        lines.append(f"  <nodedef {_attributes(node | {'doc': chr(10).join(told)})}>")
        for each in arguments_of(functions):
            low, high = map(decimal, each.domain)
            value = {"name": each.name, "type": "float", "value": decimal(middle(each))}
            shown = {"uiname": label_of(each), "uimin": low, "uimax": high}
            lines.append(f"    <input {_attributes(value | shown)} />")
        lines += ['    <output name="out" type="float" />', "  </nodedef>"]
        lines += _graph(functions, name)
    return "\n".join([*lines, "</materialx>"]) + "\n"


def _graph(functions: Sequence, name: str) -> list[str]:
    nodes, value = node_graph(functions)
    lines = [f'  <nodegraph name="NG_{name}_float" nodedef="ND_{name}_float">']
    for number, node in enumerate(nodes):
        lines.append(f'    <{node.category} name="{_node_name(number)}" type="float">')
        for place, source in node.inputs:
            given = {"name": place, "type": "float"} | _connection(source)
            lines.append(f"      <input {_attributes(given)} />")
        lines.append(f"    </{node.category}>")
    output = {"name": "out", "type": "float"} | _connection(value)
    return [*lines, f"    <output {_attributes(output)} />", "  </nodegraph>"]


def _connection(source: Source) -> dict[str, str]:
    if isinstance(source, Argument):
        return {"interfacename": source.name}
    if isinstance(source, Result):
        return {"nodename": _node_name(source.node)}
    return {"value": shortest_decimal(source, "float")}


def _node_name(number: int) -> str:
    return f"step{number}"


def _attributes(values: Mapping[str, str]) -> str:
    # XML reads a plain line break in an attribute as a space. The reference before it is the line
    # break that is meant; the plain one makes the text legible in the file.
    quoted = {'"': "&quot;", "\n": "&#10;\n"}
    return " ".join(f'{name}="{escape(text, quoted)}"' for name, text in values.items())
