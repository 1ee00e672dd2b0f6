"""A worker process that compiles HLSL to SPIR-V with DXC's library; `hlsl.py` starts it as a file.

Arguments: the library, then the compiler's flags or `--version`. The source is read from standard
input, and the code is written to standard output. Errors are written to standard error, with exit
status 1. The library has a COM interface: the first word of an object points to its function table.
"""

import ctypes
import sys
from uuid import UUID

COMPILER = UUID("73e22d93-e6ce-47f3-b5bf-f0664f39c1b0")  # class
COMPILER3 = UUID("228b4687-5a6a-4730-900c-9702b2203f54")  # interfaces
RESULT = UUID("58346cda-dde7-4497-9461-6f87af5e0659")
VERSION = UUID("b04f5b50-2059-4f12-a8ff-a1e0cde1cc7e")
UTF8 = 65001


class Text(ctypes.Structure):
    """A source: its bytes, their number and their code page."""

    _fields_ = (
        ("bytes", ctypes.c_char_p),
        ("size", ctypes.c_size_t),
        ("encoding", ctypes.c_uint32),
    )


def identifier(uuid: UUID):
    """Return a UUID in COM's memory layout."""
    return ctypes.create_string_buffer(uuid.bytes_le, 16)


def method(thing: ctypes.c_void_p, slot: int, result, *kinds):
    """Return the function in a slot of an object's function table, bound to the object."""
    assert thing.value is not None
    table = ctypes.cast(thing, ctypes.POINTER(ctypes.POINTER(ctypes.c_void_p))).contents
    kind = ctypes.CFUNCTYPE(result, ctypes.c_void_p, *kinds)
    return lambda *arguments: kind(table[slot])(thing, *arguments)


def checked(status: int) -> None:
    """Exit if a call has failed."""
    if status < 0:
        sys.exit(f"DXC failed with status {status & 0xFFFFFFFF:#x}")


def instance(library, interface: UUID) -> ctypes.c_void_p:
    """Make a compiler object and return one of its interfaces."""
    made = ctypes.c_void_p()
    create = library.DxcCreateInstance
    create.restype = ctypes.c_int32
    checked(create(identifier(COMPILER), identifier(interface), ctypes.byref(made)))
    return made


def blob(thing: ctypes.c_void_p) -> bytes:
    """Return the bytes of a blob; none for a null pointer."""
    if not thing.value:
        return b""
    start = method(thing, 3, ctypes.c_void_p)()
    size = method(thing, 4, ctypes.c_size_t)()
    return ctypes.string_at(start, size) if size else b""


def version(library) -> str:
    """Name the compiler and its version."""
    major, minor = ctypes.c_uint32(), ctypes.c_uint32()
    ask = method(instance(library, VERSION), 3, ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p)
    checked(ask(ctypes.byref(major), ctypes.byref(minor)))
    return f"DXC {major.value}.{minor.value}"


def compiled(library, source: bytes, flags: list[str]) -> tuple[bytes, bytes, bool]:
    """Compile, and return the code, the compiler's messages and whether it succeeded."""
    text = Text(source, len(source), UTF8)
    words = (ctypes.c_wchar_p * len(flags))(*flags)
    result = ctypes.c_void_p()
    pointer = ctypes.c_void_p
    run = method(
        instance(library, COMPILER3),
        *(3, ctypes.c_int32),
        *(pointer, pointer, ctypes.c_uint32, pointer, pointer, pointer),
    )
    answer = identifier(RESULT)
    checked(run(ctypes.byref(text), words, len(flags), None, answer, ctypes.byref(result)))
    status, code, complaints = ctypes.c_int32(), ctypes.c_void_p(), ctypes.c_void_p()
    checked(method(result, 3, ctypes.c_int32, pointer)(ctypes.byref(status)))
    checked(method(result, 4, ctypes.c_int32, pointer)(ctypes.byref(code)))
    checked(method(result, 5, ctypes.c_int32, pointer)(ctypes.byref(complaints)))
    return blob(code), blob(complaints), status.value >= 0


def main() -> None:
    """Compile standard input to standard output."""
    library = ctypes.CDLL(sys.argv[1])
    if sys.argv[2:] == ["--version"]:
        print(version(library))
        return
    code, complaints, good = compiled(library, sys.stdin.buffer.read(), sys.argv[2:])
    sys.stderr.buffer.write(complaints)
    if not good:
        sys.exit(1)
    sys.stdout.buffer.write(code)


if __name__ == "__main__":
    main()
