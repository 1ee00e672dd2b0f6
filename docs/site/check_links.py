"""Check that every link of a built site leads somewhere: `python check_links.py FOLDER`.

Links to other pages, to files, and to places within a page are followed. Links that a reader may
click to other hosts are not; a script, style or picture from another host is refused, because the
site needs no network.
"""

import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

_LINKS = ("href", "src", "poster", "data")


class _Page(HTMLParser):
    """The links of a page and the names of its places."""

    def __init__(self) -> None:
        super().__init__()
        # The element and its link.
        self.links: list[tuple[str, str]] = []
        self.places: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Collect the links and the names of an element."""
        for name, value in attrs:
            if value is None:
                continue
            if name in _LINKS:
                self.links.append((tag, value))
            if name == "id" or (tag == "a" and name == "name"):
                self.places.add(value)


def read_page(path: Path) -> _Page:
    """Read the links and places of an HTML file."""
    page = _Page()
    page.feed(path.read_text(encoding="utf-8"))
    return page


def broken_links(folder: Path) -> Iterator[str]:
    """Yield 'PAGE: LINK: why' for every link in the HTML files of a folder that leads nowhere."""
    pages = {path.resolve(): read_page(path) for path in sorted(folder.rglob("*.html"))}
    for path, page in pages.items():
        for tag, link in page.links:
            why = _fault(tag, link, path, pages, folder.resolve())
            if why:
                yield f"{path.relative_to(folder.resolve())}: {link}: {why}"


def _fault(tag: str, link: str, path: Path, pages: dict[Path, _Page], folder: Path) -> str | None:
    """Return why a link leads nowhere, or None."""
    parts = urlsplit(link)
    if parts.scheme in ("data", "mailto", "javascript"):
        return None
    if parts.scheme or parts.netloc:
        return None if tag == "a" else "is on another host"
    target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
    if target.is_dir():
        target /= "index.html"
    if not target.is_relative_to(folder) or not target.is_file():
        return "no such file"
    if parts.fragment and target in pages and unquote(parts.fragment) not in pages[target].places:
        return "no such place"
    return None


def main() -> None:
    """Print the broken links; the exit status is 1 if there are any."""
    folder = Path(sys.argv[1])
    found = sorted(set(broken_links(folder)))
    print("\n".join(found) or f"{len(list(folder.rglob('*.html')))} pages, no broken link")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
