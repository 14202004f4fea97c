"""What MkDocs (mkdocs.yml) is told besides: pages and files from outside docs/, links to them, names of headings.

`make docs` builds the pages. A link in a page may lead to any file of the tree, as on a page that shows the tree: to
another page it stays a link to that page, and any other file is put beside the pages, in tree/.
"""

from __future__ import annotations

import os
import posixpath
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mkdocs.structure.files import File, Files

if TYPE_CHECKING:
    from mkdocs.config.defaults import MkDocsConfig

TOP = Path(__file__).resolve().parent.parent

#: Pages from outside docs/, which keep their paths.
OUTSIDE = ("CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "reference/README.md", "scenes/data/README.md")
LINK = re.compile(r"(?<=\]\()(?P<path>[^)#:\s]+)(?P<anchor>#[^)\s]*)?(?=\))")


def slug(text: str, separator: str = "-") -> str:
    """The name of a heading as GitHub makes it, so that links to headings lead there as well as here."""
    return re.sub(r"[^\w\- ]", "", text.strip().lower()).replace(" ", separator)


#: A fenced block, or an indented one after an empty line.
BLOCK = re.compile(r"^```[^\0]*?^```|(?<=\n\n) {4}.*(?:\n+ {4}.*)*", re.MULTILINE)


def blank(found: re.Match[str]) -> str:
    return re.sub(r"[^\n]", " ", found[0])


def without_blocks(text: str) -> str:
    """With blanks for blocks of code."""
    return BLOCK.sub(blank, text)


def without_code(text: str) -> str:
    """With blanks for blocks and spans of code, in which nothing is a link."""
    return re.sub(r"(`+)(?!`).+?(?<!`)\1(?!`)", blank, without_blocks(text))


def in_tree(page: str, link: str) -> str:
    """The path from the top of what a link leads to. page: from the top, or as MkDocs names it, from docs/."""
    return posixpath.normpath(posixpath.join(posixpath.dirname(page), link))


def site_path(path: str) -> str:
    """Where the site has a file of the tree; its first page is docs/index.md, not README.md."""
    if path == "README.md":
        return "index.md"
    if path.startswith("docs/"):
        return path.removeprefix("docs/")
    return path if path in OUTSIDE else f"tree/{path}"


def source(page: str) -> str:
    """The path from the top of a page that MkDocs names from docs/."""
    return page if page in OUTSIDE else f"docs/{page}"


def linked(page: str, text: str) -> dict[str, str]:
    """The links of a page to files: as they are written, and the paths from the top."""
    return {link["path"]: in_tree(page, link["path"]) for link in LINK.finditer(without_code(text))}


def rewritten(page: str, text: str) -> str:
    """A page's text with links as the site needs them."""
    plain, here = without_code(text), posixpath.dirname(site_path(page))
    pieces, end = [], 0
    for link in LINK.finditer(plain):
        to = posixpath.relpath(site_path(in_tree(page, link["path"])), here or ".")
        pieces += [text[end:link.start()], to + (link["anchor"] or "")]
        end = link.end()
    return "".join([*pieces, text[end:]])


def on_files(files: Files, config: MkDocsConfig) -> Files:
    for name in OUTSIDE:
        files.append(File.generated(config, name, content=(TOP / name).read_text(encoding="utf-8")))
    wanted = {path for page in files.documentation_pages()
              for path in linked(source(page.src_uri), page.content_string).values()}
    for path in sorted(wanted):
        if site_path(path).startswith("tree/") and (TOP / path).is_file():
            files.append(File.generated(config, site_path(path), abs_src_path=str(TOP / path)))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    return rewritten(source(page.file.src_uri), markdown)


def on_post_page(output: str, **_: Any) -> str:
    """A table may be wider than the screen: it scrolls by itself."""
    return output.replace("<table>", '<div class="wide"><table>').replace("</table>", "</table></div>")


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """The copyright's year is that of LICENSE; a date of building would change the bytes."""
    line = (TOP / "LICENSE").read_text(encoding="utf-8").split("\n")[2]
    config.copyright = f"{line}. MIT licence."
    os.environ.setdefault("SOURCE_DATE_EPOCH", "0")
    return config
