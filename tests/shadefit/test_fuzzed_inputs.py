"""Random and hostile inputs: read, or refused in one line. `corpus` keeps what once failed."""

import base64
import json
import math
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
import typer
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from shadefit.commands.bake import _range, _size
from shadefit.commands.form_texts import parsed_form
from shadefit.commands.options import angle
from shadefit.images import read_image
from shadefit.images.image import image_of
from shadefit.images.writing import png_bytes
from shadefit.render.srgb import parse_colour

CORPUS = Path(__file__).parent / "corpus"
REFUSED = {
    name: json.loads((CORPUS / f"{name}.json").read_text("utf-8")) for name in ("options", "png")
}
READERS = {
    "colour": lambda text: parse_colour(text, "fiber"),
    "angle": angle,
    "size": _size,
    "range": _range,
    "form": lambda text: parsed_form(text, 2),
}
FEW = settings(
    max_examples=80,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


def message_of(read, given) -> str | None:
    """Return the message of a refusal, which must be of one line, or None."""
    try:
        read(given)
    except (ValueError, typer.BadParameter) as error:
        message = getattr(error, "message", str(error))
        assert message and "\n" not in message and "Traceback" not in message
        return message
    return None


# Options


@pytest.mark.parametrize(
    ("kind", "text"), [(kind, text) for kind, texts in REFUSED["options"].items() for text in texts]
)
def test_texts_that_mean_nothing_are_refused(kind, text):
    assert message_of(READERS[kind], text) is not None


PARTS = st.sampled_from(["1", "-", "+", ".", "e", "x", ":", ",", "=", "#", "deg", "rational", " "])
TEXTS = st.lists(PARTS | st.characters(), max_size=12).map("".join)


@FEW
@given(TEXTS)
def test_any_text_is_read_or_refused_in_one_line(text):
    for kind, read in READERS.items():
        if message_of(read, text) is None:
            value = read(text)
            assert kind != "colour" or all(0 <= part <= 1 for part in value)
            assert kind != "angle" or not math.isnan(value)


# PNG


def chunks_of(data: bytes) -> list[tuple[bytes, bytes]]:
    found, place = [], 8
    while place < len(data):
        (length,) = struct.unpack(">I", data[place : place + 4])
        found.append((data[place + 4 : place + 8], data[place + 8 : place + 8 + length]))
        place += 12 + length
    return found


def joined(chunks: list[tuple[bytes, bytes]]) -> bytes:
    """Join chunks to a file, with the right lengths and checksums, so that readers go on."""
    body = [
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in chunks
    ]
    return b"".join([b"\x89PNG\r\n\x1a\n", *body])


IMAGES = [
    chunks_of(png_bytes(image_of(np.full((3, 5, channels), 0.25, np.float32), "linear", "x"), bits))
    for channels in (1, 3, 4)
    for bits in (8, 16)
]
KINDS = st.sampled_from([b"iCCP", b"gAMA", b"tRNS", b"PLTE", b"zTXt", b"eXIf", b"acTL", b"fcTL"])
# Edits of a list of chunks: another byte, a cut, a chunk removed, repeated or added
NUMBERS = st.tuples(st.integers(0, 40), st.integers(0, 255))
EDITS = st.lists(
    st.tuples(st.sampled_from(["byte", "cut", "drop", "again"]), st.integers(0, 9), NUMBERS)
    | st.tuples(KINDS, st.integers(0, 9), st.binary(max_size=40)),
    max_size=3,
)


def edited(chunks, edits) -> bytes:
    chunks = list(chunks)
    for what, index, more in edits:
        if not chunks:
            break
        place = index % len(chunks)
        kind, data = chunks[place]
        if isinstance(what, bytes):
            chunks.insert(place, (what, more))
        elif what == "drop":
            del chunks[place]
        elif what == "again":
            chunks.insert(place, chunks[more[0] % len(chunks)])
        else:
            cut = more[0] % (len(data) + 1)
            rest = bytes([more[1]]) + data[cut + 1 :] if what == "byte" else b""
            chunks[place] = (kind, data[:cut] + rest)
    return joined(chunks)


def read_png(path: Path, data: bytes) -> str | None:
    path.write_bytes(data)

    def read(given):
        assert np.isfinite(read_image(given, "linear").pixels).all()

    message = message_of(read, path)
    assert message is None or message.startswith(str(path))
    return message


@pytest.mark.parametrize("name", REFUSED["png"])
def test_png_files_that_once_failed_are_refused(tmp_path, name):
    assert read_png(tmp_path / "a.png", base64.b64decode(REFUSED["png"][name])) is not None


def test_the_unchanged_images_are_read(tmp_path):
    for chunks in IMAGES:
        assert read_png(tmp_path / "a.png", joined(chunks)) is None


@FEW
@given(st.sampled_from(IMAGES), EDITS, st.none() | st.integers(0, 200))
def test_any_changed_png_is_read_or_refused_in_one_line(tmp_path, chunks, edits, length):
    read_png(tmp_path / "a.png", edited(chunks, edits)[:length])
