"""A preprocessor of mdBook: links that leave `docs/` lead to the repository on the web."""

import json
import pathlib
import posixpath
import re
import sys

DOCS = pathlib.Path(__file__).resolve().parent.parent
ROOT = DOCS.parent
REPOSITORY = "https://github.com/keyway-robotics/keyway/blob/main/"


def target(link: str, folder: str) -> str:
    """Returns the target of a link in a page of `folder`, both relative to `docs/`."""
    path, mark, anchor = link.partition("#")
    if not path or re.match(r"[a-z]+:", link):
        return link
    inside = posixpath.normpath(posixpath.join(folder, path))
    if not inside.startswith("..") and (DOCS / inside).exists():
        return link
    # A page that is included from elsewhere has links that start at the root.
    outside = path if (ROOT / path).exists() else posixpath.normpath(posixpath.join("docs", inside))
    if outside.startswith("docs/"):
        return posixpath.relpath(outside.removeprefix("docs/"), folder or ".") + mark + anchor
    return REPOSITORY + outside + mark + anchor


def visit(items: list) -> None:
    for item in items:
        if chapter := item.get("Chapter"):
            folder = posixpath.dirname(chapter["path"] or "")
            text = re.sub(r"(\]\()([^)\s]+)(\))", lambda m: m[1] + target(m[2], folder) + m[3], chapter["content"])
            chapter["content"] = text
            visit(chapter["sub_items"])


if __name__ == "__main__":
    if sys.argv[1:2] == ["supports"]:
        sys.exit(0)
    _, book = json.load(sys.stdin)
    visit(book.get("items") or book.get("sections"))
    json.dump(book, sys.stdout)
