"""README and docs/: links lead somewhere, the pages are built without a network, and every example is tried.

Commands of kage run here, on smaller pictures. What is not run is named in NOT_RUN, with the reason.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path

import pytest

from scripts import docs_pages, tree
from tests.conftest import PROGRAM, TOP, not_sanitized

PAGES = [name for name in tree.names() if name.endswith(".md")]
TEXTS = {name: (TOP / name).read_text(encoding="utf-8") for name in PAGES}


# Links ----------------------------------------------------------------------------------------------------------------


def headings(text: str) -> set[str]:
    """The names that links may give: GitHub numbers those that are there twice."""
    names: list[str] = []
    for title in re.findall(r"^#+ +(.+?) *$", docs_pages.without_blocks(text), re.MULTILINE):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)|`", r"\1", title)
        name = docs_pages.slug(plain)
        names.append(f"{name}-{names.count(name)}" if name in names else name)
    return set(names)


def broken_links(page: str, text: str) -> Iterator[str]:
    """Files and headings that are not there; those of the web are not asked."""
    for link in re.finditer(r"\]\(<?([^)\s>]+)>?\)", docs_pages.without_code(text)):
        path, _, anchor = link[1].partition("#")
        if re.match(r"\w+:", path):
            continue
        to = docs_pages.in_tree(page, path) if path else page
        if path and (not (TOP / to).exists() or to.startswith("../")):
            yield f"{page}: {link[1]}: no such file"
        elif anchor and anchor not in headings(TEXTS.get(to, text if to == page else "")):
            yield f"{page}: {link[1]}: no such heading"


def test_links_lead_somewhere() -> None:
    assert len(PAGES) > 20
    assert [line for page, text in TEXTS.items() for line in broken_links(page, text)] == []


@pytest.mark.parametrize(("text", "wrong"), [
    ("[a](gone.md)", "gone.md: no such file"), ("[a](scene.md#gone)", "scene.md#gone: no such heading"),
    ("# A\n[a](#b)", "#b: no such heading"), ("[a](../../x.md)", "../../x.md: no such file"),
    ("[a](../README.md)\n`[a](gone.md)`\n\n    [a](gone.md)\n", ""), ("# A `b` (c)\n[a](#a-b-c)", ""),
])
def test_a_broken_link_is_noticed(text: str, wrong: str) -> None:
    assert list(broken_links("docs/x.md", text)) == ([f"docs/x.md: {wrong}"] if wrong else [])


def test_every_page_can_be_found() -> None:
    """docs/index.md leads to each page of docs/."""
    linked = set(docs_pages.linked("docs/index.md", TEXTS["docs/index.md"]).values())
    assert {page for page in PAGES if re.fullmatch(r"docs/[\w-]+\.md", page)} - linked - {"docs/index.md"} == set()


# The site -------------------------------------------------------------------------------------------------------------


class Resources(HTMLParser):
    """What a page loads by itself."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = dict(attrs)
        loads = given.get("src") or (given.get("href") if tag == "link" else None)
        if loads and given.get("rel") != "canonical":
            self.found.append(loads)


def test_the_pages_are_built_without_a_network(tmp_path: Path) -> None:
    """With --strict a link that MkDocs can't follow is an error; the pages load nothing from elsewhere."""
    site = tmp_path / "site"
    environment = {**os.environ, "http_proxy": "http://127.0.0.1:9", "https_proxy": "http://127.0.0.1:9"}
    done = subprocess.run([sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "-d", site], cwd=TOP,
                          env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    pages = [path for path in site.rglob("*.html") if path.name != "404.html"]
    assert len(pages) > 20
    for path in pages:
        parser = Resources()
        parser.feed(path.read_text(encoding="utf-8"))
        for name in parser.found:
            assert name.startswith("data:") or (path.parent / name.split("?")[0]).exists(), f"{path.name} loads {name}"
    assert "http" not in re.sub(r"/\*.*?\*/", "", (site / "pages.css").read_text(), flags=re.DOTALL)


# Commands -------------------------------------------------------------------------------------------------------------

COMMAND = re.compile(r"(make|kage|build/float/kage|scripts/\w+|python|pip|cc|apt|git|dask|povray|spirv-cross|sh)\b")

#: Beginnings of commands that no test types as they stand, and why.
NOT_RUN = {
    "kage view": "needs a window: tests/view", "build/float/kage view": "needs a window: tests/view",
    "cc ": "tests/program/test_examples.py builds each example so",
    "povray ": "tests/program/test_pov.py renders what is exported",
    "spirv-cross ": "tests/shaders/test_glsl.py",
    "pip ": "needs a network", "apt ": "needs a network; tests/verify/deb.py installs the packages",
    "scripts/bootstrap ": "installs packages: tests/program/test_scripts.py",
    "scripts/fuzz": "takes minutes: `make fuzz` in CI", "scripts/deb": "takes minutes: tests/verify/deb.py",
    "git show": "an archive has no history",
    "dask ": "needs machines", "python -m kage.sweep": "tests/python/test_sweep.py",
    "python examples/mitsuba_shadows.py": "tests/python/test_mitsuba.py",
    "scripts/venv ": "its module or file is looked up below", "make": "its target is looked up below",
}


def commands() -> list[tuple[str, str]]:
    """The commands in blocks of code, with their pages; a line that ends in a backslash goes on."""
    found = []
    for page, text in TEXTS.items():
        if page.startswith(("docs/", "README", "CONTRIBUTING", "SECURITY")):
            code = "\n".join(docs_pages.BLOCK.findall(text)).replace("\\\n", " ")
            found += [(page, line.strip()) for line in code.splitlines() if COMMAND.match(line.strip())
                      and not re.match(r"\s*kage\.|\s*python/|\s*make\w", line) and "[OPTIONS]" not in line]
    return found


COMMANDS = commands()


def words(line: str) -> list[str]:
    return shlex.split(line, comments=True)


def is_kage(line: str) -> bool:
    return line.startswith(("kage ", "build/float/kage ")) and not line.startswith(tuple(NOT_RUN))


def test_each_command_is_run_or_named() -> None:
    assert len(COMMANDS) > 40 and sum(is_kage(line) for _, line in COMMANDS) > 12
    others = [f"{page}: {line}" for page, line in COMMANDS if not is_kage(line)]
    assert [told for told in others if not told.split(": ", 1)[1].startswith(tuple(NOT_RUN))] == []
    assert [begin for begin in NOT_RUN if not any(line.startswith(begin) for _, line in COMMANDS)] == []


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder as the pages take it: the scenes, the program, a scene of one's own, and a model."""
    folder = tmp_path_factory.mktemp("desk")
    (folder / "scenes").symlink_to(TOP / "scenes")
    (folder / "build" / "float").mkdir(parents=True)
    for path in PROGRAM.parent.glob("kage*"):
        if path.is_file() and os.access(path, os.X_OK):
            (folder / "build" / "float" / path.name).symlink_to(path)
    first = re.findall(r"```yaml\n(.*?)```", TEXTS["docs/scene.md"], re.DOTALL)[0]
    (folder / "scene.yaml").write_text(first)
    shutil.copy(TOP / "scenes" / "models" / "corner.glb", folder / "room.glb")
    shutil.copy(TOP / "scenes" / "models" / "sand-8.png", folder / "bricks.png")
    return folder


def smaller(typed: list[str]) -> list[str]:
    """A render with fewer pixels."""
    if typed[1:2] != ["render"]:
        return typed
    if "--size" in typed:
        typed[typed.index("--size") + 1] = "32x24"
        return typed
    return [*typed, "--size", "32x24"]


@pytest.mark.parametrize("page", sorted({page for page, line in COMMANDS if is_kage(line)}))
def test_commands_of_kage(desk: Path, page: str) -> None:
    """One after another, as a reader types them; what they leave may be overwritten by the next page."""
    for line in (line for where, line in COMMANDS if where == page and is_kage(line)):
        typed = smaller([str(PROGRAM), *words(line)[1:]])
        if typed[1] in ("render", "import"):
            typed.append("--overwrite")
        done = subprocess.run(typed, cwd=desk, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, f"{page}: {line}\n{done.stderr}"


def test_targets_and_modules_are_there() -> None:
    makefile = (TOP / "Makefile").read_text()
    targets = set(re.findall(r"^([\w-]+)(?= ?[\w -]*:(?!=))", makefile, re.MULTILINE))
    for page, line in COMMANDS:
        typed = words(line)
        if typed[0] == "make":
            wanted = [word for word in typed[1:] if "=" not in word]
            assert set(wanted) <= targets, f"{page}: {line}"
        if "-m" in typed and typed[typed.index("-m") + 1] != "pytest":
            module = typed[typed.index("-m") + 1].replace(".", "/")
            places = [TOP / module, TOP / f"{module}.py", TOP / "python" / module]
            assert any(place.exists() for place in places), f"{page}: {line}"
        for word in typed[1:]:
            if re.match(r"(scripts|tests|examples|scenes)/", word.split("=")[-1]):
                assert (TOP / word.split("=")[-1].split(",")[0]).exists(), f"{page}: {line}: {word}"


#: Blocks of other languages, and the test that takes each page's.
TAKEN = {
    ("README.md", "python"): "tests/program/test_docs.py",
    ("docs/python.md", "python"): "tests/python/test_docs.py",
    ("docs/gbuffer.md", "python"): "tests/python/test_methods_docs.py",
    ("docs/methods-python.md", "python"): "tests/python/test_methods_docs.py",
    ("docs/library.md", "c"): "tests/program/test_examples.py",
    ("docs/scene.md", "yaml"): "tests/program/test_input.py",
    ("docs/sweep.md", "python"): "tests/python/test_sweep.py",
    ("docs/sweep.md", "yaml"): "tests/python/test_sweep.py",
    ("docs/shaders.md", "glsl"): "tests/shaders/test_glsl.py",
    ("docs/shaders.md", "hlsl"): "tests/shaders/test_glsl.py",
    ("docs/shaders.md", "metal"): "tests/shaders/test_glsl.py",
}
SHOWN = {"sh", "text"}  # commands, as above; what is printed


def test_each_block_has_a_test() -> None:
    blocks = {(page, language) for page, text in TEXTS.items()
              for language in re.findall(r"^```(\w+)", text, re.MULTILINE) if language not in SHOWN}
    assert blocks - TAKEN.keys() == set() and TAKEN.keys() - blocks == set()
    for (page, _), test in TAKEN.items():
        assert Path(page).name in (TOP / test).read_text(encoding="utf-8"), f"{test} does not read {page}"


@not_sanitized
def test_the_readme_in_python(desk: Path) -> None:
    (block,) = re.findall(r"^```python\n(.*?)^```", TEXTS["README.md"], re.DOTALL | re.MULTILINE)
    path = os.pathsep.join([str(PROGRAM.parent / "python"), *sys.path])
    done = subprocess.run([sys.executable, "-c", block.replace("640, 480", "32, 24")], cwd=desk, capture_output=True,
                          text=True, env={**os.environ, "PYTHONPATH": path})
    assert done.returncode == 0 and (desk / "cube.png").exists(), done.stderr
