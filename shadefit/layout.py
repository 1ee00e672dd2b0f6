"""How a table is laid out in lines of a given width. Numbers are never cut.

The columns are side by side if they fit. If they do not, the headers are wrapped, and then the
texts of the first column. If that is not enough, each row becomes a few lines of 'header value'.
"""

from collections.abc import Sequence
from itertools import product
from textwrap import wrap

from rich.cells import cell_len

GAP = "  "
INDENT = "    "
RULE = "─"


def laid_out(
    columns: Sequence[str], rows: Sequence[Sequence[str]], below: int, width: int
) -> tuple[list[str], list[str]]:
    """Return the lines of the header, and the lines of the rows, in at most `width` characters.

    The last `below` cells of a row are on a line of their own under it, each after its header; an
    empty one is left out. A single word that is longer than `width` is not broken.
    """
    count = len(columns) - below
    heads, cells = columns[:count], [row[:count] for row in rows]
    further = [_pairs(columns[count:], row[count:], width) for row in rows]
    whole, broken = map(cell_len, heads), map(_longest_word, heads)
    names = [max(map(of, [row[0] for row in cells]), default=0) for of in (cell_len, _longest_word)]
    tried = product(names, (list(whole), list(broken)))
    found = (_widths(least, head, cells, width) for least, head in tried)
    widths = next((each for each in found if each is not None), None)
    if widths is None:
        return [], _in_pairs(heads, cells, further, width)
    header = _side_by_side(heads, widths, bottom=True)
    lines = []
    for row, more in zip(cells, further, strict=True):
        lines += [*_side_by_side(row, widths), *more]
    return header, lines


def wrapped(text: str, width: int) -> list[str]:
    """Break text at spaces into lines. A word that is longer than `width` stays whole."""
    return wrap(text, width, break_long_words=False, break_on_hyphens=False) or [""]


def _widths(
    least: int, heads: list[int], cells: Sequence[Sequence[str]], width: int
) -> list[int] | None:
    """Return the widths of the columns, or None if they do not fit side by side.

    `heads` are the widths that the headers need, `least` is that of the texts in the first column.
    """
    first, *others = [
        max(head, *(cell_len(row[index]) for row in cells)) if cells else head
        for index, head in enumerate(heads)
    ]
    room = width - sum(others) - len(GAP) * len(others)
    return [min(first, room), *others] if room >= max(least, heads[0]) else None


def _side_by_side(cells: Sequence[str], widths: list[int], bottom: bool = False) -> list[str]:
    """Return the lines of one row; the first column is left-aligned, the others are right."""
    parts = [wrapped(cell, width) for cell, width in zip(cells, widths, strict=True)]
    height = max(map(len, parts))
    lines = []
    for index in range(height):
        texts = [_line_of(part, index, height if bottom else len(part)) for part in parts]
        padded = [
            _pad(text, width, left=column == 0)
            for column, (text, width) in enumerate(zip(texts, widths, strict=True))
        ]
        lines.append(GAP.join(padded).rstrip())
    return lines


def _line_of(part: list[str], index: int, height: int) -> str:
    own = index - (height - len(part))
    return part[own] if 0 <= own < len(part) else ""


def _pad(text: str, width: int, left: bool) -> str:
    space = " " * (width - cell_len(text))
    return text + space if left else space + text


def _in_pairs(
    heads: Sequence[str],
    cells: Sequence[Sequence[str]],
    further: list[list[str]],
    width: int,
) -> list[str]:
    lines = []
    for row, more in zip(cells, further, strict=True):
        lines += [*wrapped(row[0], width), *_pairs(heads[1:], row[1:], width), *more]
    return lines


def _pairs(heads: Sequence[str], cells: Sequence[str], width: int) -> list[str]:
    """Return lines of 'header value'. A pair is on one line, unless it is too long for any."""
    lines: list[str] = []
    for head, cell in zip(heads, cells, strict=True):
        if not cell:
            continue
        pair = f"{head} {cell}".strip()
        if lines and cell_len(lines[-1] + GAP + pair) <= width:
            lines[-1] += GAP + pair
            continue
        lines += [INDENT + each for each in wrapped(pair, width - len(INDENT))]
    return lines


def _longest_word(text: str) -> int:
    return max(map(cell_len, text.split()), default=0)
