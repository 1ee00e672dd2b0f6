"""How much a glTF file says that it holds, which is compared with its size before it is read."""

import json
import struct
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

_COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_LARGEST_COMPONENT = 4
# Accessors may share data, parts may share accessors, and one without data is all zeros. What
# has more than this many times the bytes of its file, and more than this, only fills the memory.
_TIMES, _ENOUGH = 8, 1 << 27
_GLB_HEADER = 20


def require_bounded_accessors(content: bytes, path: Path) -> None:
    """Raise ValueError if the parts of a glTF or GLB file hold far more than its data.

    What is no such file, or is broken in another way, is left to its reader.
    """
    try:
        document = json.loads(_json_of(content))
    except (ValueError, RecursionError, struct.error):
        return
    sizes = [_accessor_bytes(each) for each in _list_of(document, "accessors")]
    read = sum(sizes[k] for k in _references(document) if k < len(sizes))
    stated = max(sum(sizes), read)
    present = len(content) + sum(_size_of(each, path) for each in _list_of(document, "buffers"))
    allowed = max(_TIMES * present, _ENOUGH)
    if stated > allowed:
        raise ValueError(
            f"{path}: its parts have {stated:.4g} bytes, but its data only {present}: allowed are "
            f"{allowed}"
        )


def _references(document: Any) -> Iterator[int]:
    """Yield the number of an accessor for each time that a part of a mesh refers to it."""
    for shape in _list_of(document, "meshes"):
        for part in _list_of(shape, "primitives"):
            attributes = part.get("attributes")
            named = attributes.values() if isinstance(attributes, dict) else ()
            for number in (*named, part.get("indices")):
                if type(number) is int and number >= 0:
                    yield number


def _json_of(content: bytes) -> bytes:
    """Return the JSON text of a file: that of a GLB file is its first chunk."""
    if not content.startswith(b"glTF"):
        return content
    (length,) = struct.unpack_from("<I", content, 12)
    return content[_GLB_HEADER : _GLB_HEADER + length]


def _list_of(document: Any, key: str) -> list[Mapping[str, Any]]:
    found = document.get(key) if isinstance(document, dict) else None
    return [each for each in found if isinstance(each, dict)] if isinstance(found, list) else []


def _accessor_bytes(accessor: Mapping[str, Any]) -> int | float:
    count, kind = accessor.get("count"), accessor.get("type")
    if not isinstance(count, int | float):
        return 0
    return max(count, 0) * _LARGEST_COMPONENT * _COMPONENTS.get(str(kind), 16)


def _size_of(buffer: Mapping[str, Any], path: Path) -> int:
    """Return the bytes of the file that a buffer is in; 0 if it is in the glTF file itself."""
    name = buffer.get("uri")
    if not isinstance(name, str) or name.startswith("data:") or Path(name).name != name:
        return 0
    try:
        return (path.parent / name).stat().st_size
    except (OSError, ValueError):
        return 0
