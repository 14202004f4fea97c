"""The manual pages and docs/kage.md, from what is written once: the program's table of options, docs/scene.md, and the
comments of the headers.

    scripts/venv python -m scripts.man [--kage PROGRAM] [--into FOLDER]

They are under version control, so that `make install` needs no Python. A test compares them with their sources.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from scripts.roff import Page, escaped, inline, markdown, names_bold

TOP = Path(__file__).resolve().parent.parent
Table = dict[str, Any]

#: When the pages were last read through by a person.
DATE = "2026-11-26"

ABOUT = {
    "kage": "render shadows of other objects on bump-mapped surfaces",
    "kage-scene": "scene files of kage",
    "libkage": "the library of kage",
    "bumpshadow": "shadows on bump-mapped surfaces, to copy into a renderer",
}
FROM_STDIN = "A SCENE `-` is read from standard input."
SEE = {"kage": "kage(1)", "kage-scene": "kage-scene(5)", "libkage": "kage(3)", "bumpshadow": "bumpshadow(3)"}
LIMITS = "What `--limit WHAT=N` can make smaller:"
MESSAGES = "Messages are on standard error; of a scene they are `file:line:column: what is wrong`, and show the place."


def read_table(kage: Path) -> Table:
    found: Table = json.loads(subprocess.run([kage, "table"], check=True, capture_output=True, text=True).stdout)
    found["commands"] = [command for command in found["commands"] if not command["hidden"]]
    return found


def capital(text: str) -> str:
    return text[0].upper() + text[1:]


def synopsis(command: Table) -> str:
    needed = command["needed"]
    return " ".join(["kage", command["name"], *command["operands"][:needed],
                     *(f"[{word}]" for word in command["operands"][needed:]), "[OPTIONS]"])


def commands_of(table: Table, option: Table) -> list[str]:
    return [command["name"] for command in table["commands"] if command["bit"] & option["commands"]]


def of_whom(table: Table, option: Table) -> str:
    """Which commands have an option."""
    names = commands_of(table, option)
    return "Of all commands." if len(names) == len(table["commands"]) else f"Of {', '.join(names)}."


def words(option: Table) -> str:
    """What an option does, as sentences."""
    text = option["text"]
    if not re.match(r"\w+:", text):  # a value
        text = capital(text)
    return f"{text}. {option['more']}".strip()


def tag(option: Table) -> str:
    names = ", ".join(f"\\fB{escaped(option[key], code=True)}\\fR" for key in ("letter", "name") if option[key])
    return f"{names} \\fI{escaped(option['argument'])}\\fR" if option["argument"] else names


def see_also(page: Page, own: str) -> None:
    page.heading("SEE ALSO")
    page.text(",\n".join(f"\\fB{escaped(name.split('(')[0], code=True)}\\fR({name.split('(')[1]}"
                         for key, name in SEE.items() if key != own))


# kage(1) and docs/kage.md ---------------------------------------------------------------------------


def kage_page(page: Page, table: Table) -> None:
    page.heading("SYNOPSIS")
    for k, command in enumerate(table["commands"]):
        page.lines += [".br"] if k else []
        page.text(escaped(synopsis(command), code=True))
    page.heading("DESCRIPTION")
    page.text("\\fBkage\\fR renders shadows of other objects on bump-mapped surfaces, by Sumi and Noma's method. "
              "Scenes are files in YAML, which \\fBkage\\-scene\\fR(5) describes. " + inline(FROM_STDIN))
    page.heading("COMMANDS")
    for command in table["commands"]:
        page.heading(escaped(synopsis(command).removesuffix(" [OPTIONS]"), code=True), 2)
        page.text(escaped(capital(command["text"]) + "."))
        for more in filter(None, command["more"].split("\n\n")):
            page.paragraph(inline(more))
        for line, does in zip(command["examples"][::2], command["examples"][1::2], strict=True):
            page.entry(f"\\fB{escaped(line, code=True)}\\fR", escaped(does))
    page.heading("OPTIONS")
    page.text("A value follows its option as the next word, or after an equals sign: \\fB\\-\\-size 640x480\\fR, "
              "\\fB\\-\\-size=640x480\\fR, \\fB\\-o FILE\\fR, \\fB\\-oFILE\\fR. "
              "After \\fB\\-\\-\\fR no word is an option.")
    for group, heading in enumerate(table["headings"]):
        page.heading(heading, 2)
        for option in table["options"]:
            if option["about"] == group:
                page.entry(tag(option), inline(f"{words(option)} {of_whom(table, option)}"))
    page.heading("LIMITS")
    page.text(inline(LIMITS))
    for limit in table["limits"]:
        page.entry(f"\\fB{escaped(limit['name'], code=True)}\\fR",
                   escaped(f"{capital(limit['text'])}: {limit['most']}."))
    page.heading("METHODS")
    for method in table["methods"]:
        page.entry(f"\\fB{escaped(method['name'], code=True)}\\fR", escaped(method["text"]))
    page.heading("EXIT STATUS")
    for end in table["exit"]:
        page.entry(f"\\fB{end['status']}\\fR", inline(capital(end["text"]) + "."))
    page.heading("DIAGNOSTICS")
    page.text(inline(MESSAGES))


def kage_markdown(table: Table) -> str:
    about = ("Made by `scripts/man.py` from the program's own table, as are `kage --help` and the manual page kage(1). "
             "A value follows its option as the next word, or after an equals sign; after `--` no word is an option.")
    out = ["# The program kage", "", *textwrap.wrap(f"{about} {FROM_STDIN}", 118), ""]
    for command in table["commands"]:
        out += [f"## kage {command['name']}", "", f"`{synopsis(command)}`", "",
                *textwrap.wrap(capital(command["text"]) + ".", 118), ""]
        for more in filter(None, command["more"].split("\n\n")):
            out += [*textwrap.wrap(more, 118), ""]
        examples = command["examples"]
        for line, does in zip(examples[::2], examples[1::2], strict=True):
            out += [f"    # {does}", f"    {line}"]
        own = [option for option in table["options"] if option["commands"] & command["bit"]]
        out += [*([""] if examples else []), "| option | meaning |", "|---|---|"]
        for option in own:
            names = ", ".join(f"`{option[key]}`" for key in ("letter", "name") if option[key])
            argument = f" `{option['argument']}`" if option["argument"] else ""
            out.append(f"| {names}{argument} | {words(option)} |".replace("8|16", "8\\|16").replace("y|z", "y\\|z"))
        out.append("")
    out += ["## Limits", "", LIMITS, "", "| limit | of what | built in |", "|---|---|---|"]
    out += [f"| `{limit['name']}` | {limit['text']} | {limit['most']} |" for limit in table["limits"]]
    out += ["", "## Methods", "", "| method | what it does |", "|---|---|"]
    out += [f"| `{method['name']}` | {method['text']} |" for method in table["methods"]]
    out += ["", "## Exit status", "", "| status | meaning |", "|---|---|"]
    out += [f"| {end['status']} | {end['text']} |" for end in table["exit"]]
    return "\n".join([*out, "", MESSAGES]) + "\n"


# Headers --------------------------------------------------------------------------------------------

NAME = r"\b(?:kage|bs|KAGE|BS)_\w+|`[^`]+`"


def comment_text(comment: str) -> list[tuple[bool, list[str]]]:
    """Of a comment: paragraphs, and pieces of code, which are (True, lines)."""
    found: list[tuple[bool, list[str]]] = []
    for raw in comment.strip().splitlines():
        line = re.sub(r"^ \*( |$)", "", raw)
        code = line.startswith("    ")
        if not line.strip() or "SPDX-License" in line:
            found.append((False, []))
        elif found and found[-1][0] == code:
            found[-1][1].append(line[4:] if code else line)
        else:
            found.append((code, [line[4:] if code else line]))
    return [(code, lines) for code, lines in found if lines]


def say(page: Page, comment: str) -> None:
    for code, lines in comment_text(comment):
        if code:
            page.code(lines)
        else:
            page.paragraph(names_bold(" ".join(line.strip() for line in lines), NAME))


def declarations(text: str) -> Iterator[tuple[str, str, str]]:
    """(comment, "", ""), or ("", declaration, what stands behind it in its line). Comments in a struct stay in it."""
    at = 0
    while at < len(text):
        if text.startswith("/*", at):
            end = text.index("*/", at) + 2
            yield text[at + 2 : end - 2], "", ""
        elif text[at] == "#":
            end = text.index("\n", at)
            if re.match(r"#define (KAGE|BS)_[A-Z_]+ (?!__)\S", text[at:end]):
                yield "", text[at:end], ""
        elif text[at].isspace():
            end = at + 1
        else:
            end = declaration_end(text, at)
            declaration = text[at:end]
            behind = re.compile(r"[ ]*/\*(.*?)\*/", re.DOTALL).match(text, end)
            yield "", declaration, behind[1] if behind else ""
            end = behind.end() if behind else end
        at = end


def declaration_end(text: str, at: int) -> int:
    """Behind a declaration's semicolon, or a function's body."""
    depth, end = 0, at
    while True:
        if text.startswith("/*", end):
            end = text.index("*/", end)
        depth += {"{": 1, "}": -1}.get(text[end], 0)
        end += 1
        body = text[at:end].startswith("static inline")
        if depth == 0 and (text[end - 1] == ";" or (body and text[end - 1] == "}")):
            return end


def prototype(declaration: str) -> list[str]:
    """Broken behind commas."""
    text = " ".join(re.sub(r"\{.*", ";", declaration, flags=re.DOTALL).split()).replace(" ;", ";")
    text = re.sub(r"^(KAGE_API|static inline) ", "", text).replace(" ", "\0").replace(",\0", ", ")
    lines = textwrap.wrap(text, 72, subsequent_indent=" " * 8, break_long_words=False, break_on_hyphens=False)
    return [line.replace("\0", " ") for line in lines]


def fields(body: str, end: str) -> Iterator[tuple[str, str]]:
    """Of a struct or an enum, where each ends so: a field, and the comment behind it or above it."""
    above, held = "", ""
    for line in re.findall(r"/\*.*?\*/|[^/]+?(?:\n|(?=/\*)|$)", body, re.DOTALL):
        comment = re.fullmatch(r"/\*(.*)\*/", line, re.DOTALL)
        if comment and held:
            yield held, one_line(comment[1])
            held = ""
        elif comment:
            above = one_line(comment[1])
        elif line.strip():
            *whole, held = [" ".join(piece.split()) for piece in re.split(rf"(?<={end})\s", line.strip())]
            for piece in whole:
                yield piece, ""
            if line.endswith("\n"):
                yield held, above
                held = above = ""
    if held:
        yield held, above


def one_line(comment: str) -> str:
    return " ".join(re.sub(r"\n\s*\*", " ", comment).split())


def declare(page: Page, declaration: str, comments: list[str]) -> None:
    """What is declared, in bold; then what is said of it; a struct's fields as a list."""
    found = re.match(r"(typedef (?:struct|enum) \w+|enum) \{(.*)\}([^}]*);$", declaration, re.DOTALL)
    page.lines += [*([] if page.fresh else [".PP"]), ".nf"]
    lines = declaration.splitlines() if declaration.startswith("#") else prototype(declaration)
    if found:
        lines = [f"{found[1]} {{ ... }}{found[3]};"]
    page.lines += [f"\\fB{escaped(line, code=True)}\\fR" for line in lines]
    page.lines.append(".fi")
    page.fresh = False
    if not found and not any(comment.strip() for comment in comments):
        return
    page.lines.append(".RS 4")
    page.fresh = True
    for comment in comments:
        say(page, comment)
    if found:
        for code, comment in fields(found[2], "," if "enum" in found[1] else ";"):
            page.entry(f"\\fB{escaped(code.rstrip(',;'), code=True)}\\fR", names_bold(comment, NAME))
    page.lines.append(".RE")
    page.fresh = False


def header_page(page: Page, name: str) -> None:
    text = (TOP / "include" / name).read_text()
    head, _, rest = text.partition("*/")
    page.heading("SYNOPSIS")
    page.lines += [".nf", f"\\fB#include <{name}>\\fR", ".fi"]
    page.fresh = False
    page.heading("DESCRIPTION")
    say(page, head.removeprefix("/*").partition("\n")[2])
    page.heading("INTERFACE")
    rest = re.sub(r'#ifdef __cplusplus\n.*?#endif\n', "", rest, flags=re.DOTALL)
    held = ""  # the comment before a declaration
    for comment, declaration, behind in declarations(rest):
        if "Permission is hereby granted" in comment:
            break
        if declaration:
            declare(page, declaration, [held, behind])
            held = ""
            continue
        say(page, held)
        section = re.match(r"\s*---- (.*?) ----(.*)", comment, re.DOTALL)
        held = section[2] if section else comment
        if section:
            page.heading(escaped(section[1]), 2)
    say(page, held)


# ----------------------------------------------------------------------------------------------------


def pages(kage: Path) -> dict[str, str]:
    """What is made, by path from the top."""
    table = read_table(kage)
    source = f"kage {table['version']}"
    made = {name: Page(title, section, source, DATE, ABOUT[name])
            for name, title, section in (("kage", "kage", 1), ("kage-scene", "kage-scene", 5), ("libkage", "kage", 3),
                                         ("bumpshadow", "bumpshadow", 3))}
    kage_page(made["kage"], table)
    markdown(made["kage-scene"], (TOP / "docs" / "scene.md").read_text())
    header_page(made["libkage"], "kage.h")
    header_page(made["bumpshadow"], "bumpshadow.h")
    for name, page in made.items():
        see_also(page, name)
    files = {f"man/{SEE[name].replace('(', '.').rstrip(')')}": str(page) for name, page in made.items()}
    return files | {"docs/kage.md": kage_markdown(table)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kage", type=Path, default=TOP / "build" / "float" / "kage")
    parser.add_argument("--into", type=Path, default=TOP)
    options = parser.parse_args()
    for name, text in pages(options.kage).items():
        path = options.into / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


if __name__ == "__main__":
    main()
