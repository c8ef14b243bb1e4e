#!/usr/bin/env python3
"""Fails where a page of a site loads something from another server, or links to a page or place that is not there.

usage: check_site.py FOLDER
"""
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADS = {("img", "src"), ("script", "src"), ("link", "href"), ("iframe", "src"), ("source", "src"), ("video", "src")}


class Page(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.names, self.links, self.loads = set(), [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name == "id" or (tag, name) == ("a", "name"):
                self.names.add(value)
            elif (tag, name) == ("a", "href"):
                self.links.append(value)
            elif (tag, name) in LOADS:
                self.loads.append(value)


def faults(root):
    pages = {path: Page(path.read_text()) for path in sorted(root.rglob("*.html"))}
    if not pages:
        yield f"{root}: has no pages"
    for path, page in pages.items():
        where = path.relative_to(root)
        for target in page.loads:
            if urlsplit(target).netloc:
                yield f"{where}: loads {target}"
        if path.name == "404.html":  # its links begin at the server's root
            continue
        for target in page.links + page.loads:
            url = urlsplit(target)
            if url.scheme or url.netloc:
                continue
            file = (path.parent / unquote(url.path)).resolve() if url.path else path
            file = file / "index.html" if file.is_dir() else file
            if not file.exists():
                yield f"{where}: {target} is not there"
            elif url.fragment and file in pages and unquote(url.fragment) not in pages[file].names:
                yield f"{where}: {target} names no place of its page"
    for style in root.rglob("*.css"):
        if "url(http" in style.read_text() or "url(//" in style.read_text():
            yield f"{style.relative_to(root)}: loads from another server"


found = list(faults(Path(sys.argv[1]).resolve()))
print("\n".join(found), end="\n" if found else "")
sys.exit(1 if found else 0)
