"""A small writer of manual pages in man(7), and what turns Markdown into them: the part that docs/ uses.

Tables become lists, as rows of sentences don't fit into a terminal. What Markdown this does not know is an error.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

BOLD, ITALIC, PLAIN = "\\fB", "\\fI", "\\fR"


def escaped(text: str, *, code: bool = False) -> str:
    """Any text as roff. code: its letters are typed as they are shown."""
    text = text.replace("\\", "\\e")
    if code:
        for letter, name in {"-": "\\-", "^": "\\(ha", "~": "\\(ti", "`": "\\(ga", "'": "\\(aq"}.items():
            text = text.replace(letter, name)
    return "".join(c if ord(c) < 128 else f"\\[u{ord(c):04X}]" for c in text)


def inline(text: str) -> str:
    """A paragraph of Markdown, in one line."""
    out = ""
    for part in re.split(r"(`[^`]+`|\*\*.+?\*\*|(?<!\w)\*[^* ][^*]*\*|!?\[[^\]]*\]\([^)]*\))", text):
        if part.startswith("`"):
            out += BOLD + escaped(part[1:-1], code=True) + PLAIN
        elif part.startswith("**"):
            out += BOLD + escaped(part[2:-2].replace("`", "")) + PLAIN
        elif part.startswith("*") and len(part) > 2:
            out += ITALIC + escaped(part[1:-1]) + PLAIN
        elif found := re.fullmatch(r"\[([^\]]*)\]\(([^)]*)\)", part):
            out += inline(found[1]) + (f" ({escaped(found[2])})" if found[2].startswith("http") else "")
        elif not part.startswith("!["):
            out += escaped(part)
    return out


def names_bold(text: str, pattern: str) -> str:
    """Plain text, in which names of an interface are bold."""
    parts = re.split(rf"({pattern})", text)
    return "".join(BOLD + escaped(part.strip("`"), code=True) + PLAIN if k % 2 else escaped(part)
                   for k, part in enumerate(parts))


class Page:
    """Lines of a page. Texts that are given to it are roff."""

    def __init__(self, name: str, section: int, source: str, date: str, about: str) -> None:
        self.lines = ['.\\" Made by scripts/man.py: change what it is made from.',
                      f'.TH {name.upper()} {section} "{date}" "{source}" "{MANUALS[section]}"']
        self.fresh = True  # a paragraph needs no space above
        self.heading("NAME")
        self.text(f"{escaped(name, code=True)} \\- {escaped(about)}")

    def __str__(self) -> str:
        return "\n".join(self.lines) + "\n"

    def heading(self, text: str, level: int = 1) -> None:
        self.lines.append(f".{'SH' if level == 1 else 'SS'} {text.upper() if level == 1 else text}")
        self.fresh = True

    def text(self, text: str) -> None:
        """Broken after sentences, so that changes of the page are small."""
        for line in re.split(r"(?<=[.:;]) (?=[A-Z\\`(])", " ".join(text.split())):
            self.lines.append(("\\&" if line.startswith((".", "'")) else "") + line)
        self.fresh = False

    def paragraph(self, text: str) -> None:
        if not self.fresh:
            self.lines.append(".PP")
        self.text(text)

    def entry(self, tag: str, text: str) -> None:
        """Of a list of terms."""
        self.lines += [".TP", tag]
        self.text(text or "\\&")

    def item(self, mark: str, text: str) -> None:
        self.lines.append(f".IP {mark} 4")
        self.text(text)

    def code(self, lines: Sequence[str]) -> None:
        if not self.fresh:
            self.lines.append(".PP")
        self.lines += [".RS 4", ".EX"]
        self.lines += [("\\&" if line.startswith(".") else "") + escaped(line, code=True) for line in lines]
        self.lines += [".EE", ".RE"]
        self.fresh = False


MANUALS = {1: "Commands", 3: "Library", 5: "File formats"}


# Markdown -------------------------------------------------------------------------------------------


def cells(row: str) -> list[str]:
    return [cell.strip().replace("\\|", "|") for cell in re.split(r"(?<!\\)\|", row.strip().strip("|"))]


def table(page: Page, rows: Sequence[str]) -> None:
    """An entry a row: its first cell, the second, and the others with what stands above them."""
    head, _, *rest = (cells(row) for row in rows)
    for row in rest:
        more = [f"{head[k].capitalize()}: {cell}." for k, cell in enumerate(row) if k > 1 and cell]
        page.entry(inline(row[0]), inline(". ".join([row[1].rstrip("."), *[" ".join(more)]]) if more else row[1]))


def blocks(text: str) -> list[list[str]]:
    """Paragraphs, tables, lists and headings; a block of code is one with the lines that fence it."""
    found: list[list[str]] = [[]]
    fenced = False
    for line in text.splitlines():
        if line.startswith("```"):
            if not fenced:
                found.append([])
            found[-1].append(line)
            fenced = not fenced
            if not fenced:
                found.append([])
        elif fenced or (line.strip() and not line.startswith("#")):
            found[-1].append(line)
        else:
            found += [[line], []] if line.strip() else [[]]
    return [block for block in found if block]


def items(block: Sequence[str]) -> list[tuple[str, str]]:
    """Of a list: marks and texts."""
    found: list[tuple[str, str]] = []
    for line in block:
        if mark := re.match(r"(-|\d+\.) +", line):
            found.append(("\\(bu" if mark[1] == "-" else mark[1], line[mark.end() :]))
        else:
            found[-1] = (found[-1][0], f"{found[-1][1]} {line.strip()}")
    return found


def markdown(page: Page, text: str) -> None:
    """A document below its title; what comes before the first heading is the description."""
    page.heading("DESCRIPTION")
    for block in blocks(text.partition("\n")[2]):
        first = block[0]
        if first.startswith("#"):
            marks, _, name = first.partition(" ")
            page.heading(escaped(name.replace("`", "")), len(marks) - 1)
        elif first.startswith("```"):
            page.code(block[1:-1])
        elif first.startswith("    "):
            page.code([line[4:] for line in block])
        elif first.startswith("|"):
            table(page, block)
        elif re.match(r"(-|\d+\.) ", first):
            for mark, words in items(block):
                page.item(mark, inline(words))
        elif first.startswith("<"):
            raise ValueError(f"no HTML in a manual page: {first}")
        elif words := inline(" ".join(block)).strip():
            page.paragraph(words)
