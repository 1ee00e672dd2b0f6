"""Breaking expressions and comments into lines of at most WIDTH characters."""

from collections.abc import Sequence
from dataclasses import dataclass

WIDTH = 100
INDENT = "    "


@dataclass(frozen=True)
class Break:
    """A place where a line may be broken; if it is not broken there, it is a space.

    `depth` says how deeply the place is nested in the expression. Lines are broken first at the
    places of least depth.
    """

    depth: int = 0


# A piece of code: texts that are never divided, and places where a line may be broken.
Tokens = list[str | Break]


def nested(tokens: Sequence[str | Break], levels: int = 1) -> Tokens:
    """Nest an expression in another one: its places to break become `levels` deeper."""
    return [Break(t.depth + levels) if isinstance(t, Break) else t for t in tokens]


def on_one_line(tokens: Sequence[str | Break]) -> str:
    """Write an expression on one line."""
    return "".join(" " if isinstance(token, Break) else token for token in tokens)


def break_lines(
    tokens: Sequence[str | Break], indent: str, following: str | None = None
) -> list[str]:
    """Write a statement on as few lines as possible.

    Arguments: `tokens`, the whole statement; `indent`, the indentation of the first line;
    `following`, that of the other lines, by default one level deeper. Returns the lines. None is
    longer than WIDTH, unless a single text is.
    """
    if len(indent) + len(on_one_line(tokens)) <= WIDTH:
        return [indent + on_one_line(tokens)]
    lines = [indent]
    _fill(lines, list(tokens), indent + INDENT if following is None else following, False)
    return lines


def wrap_words(text: str, first: str, following: str) -> list[str]:
    """Wrap prose into lines: `first` starts the first line, `following` starts each other one."""
    lines = [first]
    for word in text.split():
        begun = lines[-1] in (first, following)
        if begun:
            lines[-1] += word
        elif len(lines[-1]) + 1 + len(word) <= WIDTH:
            lines[-1] += " " + word
        else:
            lines.append(following + word)
    return [line.rstrip() for line in lines]


def _fill(lines: list[str], tokens: Tokens, indent: str, after_break: bool) -> None:
    """Append tokens to the last of `lines`, and start new lines where they do not fit.

    The tokens are split at the places of least depth. A piece that fits on a line of its own stays
    together; a longer one is split in the same way. `after_break` says whether a new line may start
    before the first token.
    """
    depths = [token.depth for token in tokens if isinstance(token, Break)]
    for piece in _split(tokens, min(depths)) if depths else [tokens]:
        text = on_one_line(piece)
        space = " " if after_break else ""
        divisible = len(depths) > 0 and any(isinstance(token, Break) for token in piece)
        if len(lines[-1]) + len(space) + len(text) <= WIDTH:
            lines[-1] += space + text
        elif after_break and (len(indent) + len(text) <= WIDTH or not divisible):
            lines.append(indent + text)
        elif divisible:
            _fill(lines, piece, indent, after_break)
        else:
            lines[-1] += text
        after_break = True


def _split(tokens: Tokens, depth: int) -> list[Tokens]:
    pieces: list[Tokens] = [[]]
    for token in tokens:
        if isinstance(token, Break) and token.depth == depth:
            pieces.append([])
        else:
            pieces[-1].append(token)
    return pieces
