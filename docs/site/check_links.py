"""Checks that links of a built site lead to files of the site: `check_links.py FOLDER`."""

import html.parser
import pathlib
import sys
import urllib.parse


class Links(html.parser.HTMLParser):
    """The links, pictures and anchors of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.anchors: set[str] = set()

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        for name, value in attributes:
            if value and (tag, name) in {("a", "href"), ("img", "src")}:
                self.links.append(value)
            if value and name == "id":
                self.anchors.add(value)


def read(page: pathlib.Path) -> Links:
    links = Links()
    links.feed(page.read_text())
    return links


def main(folder: pathlib.Path) -> int:
    # The pages for printing and for errors repeat others with paths of their own.
    pages = [page for page in folder.rglob("*.html") if page.name not in {"print.html", "404.html", "toc.html"}]
    read_pages = {page.resolve(): read(page) for page in pages}
    faults = []
    for page, content in read_pages.items():
        for link in content.links:
            url = urllib.parse.urlsplit(link)
            if url.scheme or url.netloc:
                continue
            path = urllib.parse.unquote(url.path)
            target = (page.parent / path).resolve() if path else page
            if not target.exists():
                faults.append(f"{page.name}: {link} does not exist")
            elif url.fragment and target in read_pages and url.fragment not in read_pages[target].anchors:
                faults.append(f"{page.name}: {link}: no such heading")
    print("\n".join(faults) or f"{len(pages)} pages, all links lead somewhere")
    return 1 if faults or len(pages) < 20 else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
