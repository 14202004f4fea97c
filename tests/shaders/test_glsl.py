"""bumpshadow.glsl: it is what scripts/glsl.py makes of the header, and compilers of every dialect take it.

A shader that calls every function is compiled as GLSL ES 3.00, GLSL 3.30 and 4.50, and to SPIR-V. From that spirv-cross
makes HLSL, Metal and GLSL again; the HLSL and the GLSL are compiled once more. (There is no compiler of Metal here.)
"""

from __future__ import annotations

import itertools
import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from scripts import glsl
from tests.conftest import TOP
from tests.support.shaders import functions

HEADER = glsl.SOURCE.read_text(encoding="utf-8")
LIBRARY = glsl.TARGET.read_text(encoding="utf-8")
EXAMPLES = sorted(path.name for kind in ("frag", "comp") for path in (TOP / "examples/shader").glob(f"*.{kind}"))

#: CI must have these compilers: there their absence is a failure.
pytestmark = pytest.mark.skipif(
    not all(map(shutil.which, ("glslangValidator", "spirv-val", "spirv-cross"))) and not os.environ.get("CI"),
    reason="no glslangValidator, spirv-val or spirv-cross (Debian: glslang-tools, spirv-tools, spirv-cross)")


# The script -----------------------------------------------------------------------------------------------------


def test_is_what_the_script_makes(capsys: pytest.CaptureFixture[str]) -> None:
    assert glsl.main(["--check"]) == 0 and capsys.readouterr().err == ""


def test_check_tells_what_is_stale(tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
                                   capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(glsl, "TARGET", tmp_path / "bumpshadow.glsl")
    assert glsl.main(["--check"]) == 1 and "stale" in capsys.readouterr().err
    assert glsl.main([]) == 0 and glsl.main(["--check"]) == 0
    assert glsl.TARGET.read_text(encoding="utf-8") == LIBRARY
    glsl.TARGET.write_text(LIBRARY.replace("0.5", "0.25"), encoding="utf-8")
    assert glsl.main(["--check"]) == 1


def test_nothing_is_left_out() -> None:
    """Every function and every comment of the header, from the first type on."""
    mine = set(re.findall(r"^static inline \w+ (bs_\w+)\(", HEADER, re.MULTILINE))
    assert set(functions(LIBRARY)) == mine - {"bs_cross", "bs_dot"} and len(mine) > 30
    comments = re.findall(r"/\*.*?\*/", HEADER[HEADER.index(glsl.BODY_BEGINS):], re.DOTALL)
    missing = [c for c in comments if c not in LIBRARY and ";\n" not in c]  # those with examples are written again
    assert not missing and len(comments) > 50
    assert not re.search(r"bs_(real|vec3|bool)\b|\bBS_(SQRT|ABS)|static|inline|struct \w+ \w+ ?[;=]", LIBRARY)


WRONG = {
    "bs_real p = 1;\n    while (p < x) p = 2;": "While",
    "bs_real in = x;": "the name 'in', which GLSL keeps for itself",
    "bs_real p = y;": "the unknown name 'y'",
    "bs_real p = sinf(x);": "the unknown function 'sinf'",
    "bs_bool p = x;": "a float where a bool is wanted: x",
    "double p = x;": "a type that is not bs_..., or int",
    "bs_view v = {x, x};": "2 values where bs_view has 3",
    "bs_view v = {x, x, x};\n    v.c = 1;": "the unknown field 'c' of bs_view",
    "int p = 1 % 2, q = p << 2;": "the operator <<",
    "bs_real p = x;\n    /* lost */": "a comment at a place where it can't be kept",
}


@pytest.mark.parametrize("body, message", WRONG.items())
def test_what_cannot_be_said(body: str, message: str) -> None:
    """An error with its line, in place of wrong GLSL."""
    more = f"static inline bs_real bs_more(bs_real x)\n{{\n    {body}\n}}\n\n#endif\n"
    with pytest.raises(glsl.CannotSayError, match=rf"^include/bumpshadow\.h:\d+: .*{re.escape(message)}") as error:
        glsl.Writer(HEADER[:HEADER.rindex("#endif")] + more).write()
    line = int(str(error.value).split(":")[1])
    assert HEADER.count("\n") <= line <= HEADER.count("\n") + 6


# Compilers ------------------------------------------------------------------------------------------------------


def run(*command: object, folder: Path = TOP) -> str:
    done = subprocess.run([str(word) for word in command], cwd=folder, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}"
    return done.stdout


@cache
def every_function() -> str:
    """A main that calls each function with numbers that are not known before, and adds up all it returns."""
    known = glsl.Writer(HEADER).known
    numbers = itertools.count()

    def made(kind: str) -> str:
        if kind in known.structs:
            return f"{kind}({', '.join(map(made, known.structs[kind].values()))})"
        x = f"given[{next(numbers) % 4}]"
        return {"float": x, "int": f"int({x})", "bool": f"{x} > 0.5", "vec3": f"vec3({x}, 1.0, {x})"}[kind]

    def parts(kind: str, value: str) -> Iterator[str]:
        if kind in known.structs:
            for name, inner in known.structs[kind].items():
                yield from parts(inner, f"{value}.{name}")
        else:
            yield {"float": value, "int": f"float({value})", "bool": f"({value} ? 1.0 : 0.0)",
                   "vec3": f"dot({value}, {value})"}[kind]

    lines = ["float sum = 0.0;"]
    for name, (result, wanted) in known.functions.items():
        if name.startswith("bs_") and name not in glsl.BUILT_IN:
            lines.append(f"{result} of_{name} = {name}({', '.join(map(made, wanted))});")
            lines.append(f"sum += {' + '.join(parts(result, f'of_{name}'))};")
    return "void main()\n{\n    " + "\n    ".join([*lines, "color = vec4(sum);"]) + "\n}\n"


#: For each dialect: the version, and what is given and returned.
DIALECTS = {
    "es300": ("300 es", "in highp vec4 given;\nout highp vec4 color;\n"),
    "330": ("330 core", "in vec4 given;\nout vec4 color;\n"),
    "430": ("430 core", "in vec4 given;\nout vec4 color;\n"),
    "450": ("450", "layout(location = 0) in vec4 given;\nlayout(location = 0) out vec4 color;\n"),
}


def shader(dialect: str, main: str) -> str:
    version, declared = DIALECTS[dialect]
    return f"#version {version}\n{LIBRARY}{declared}{main}"


@pytest.fixture(scope="module")
def spirv(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Every function, for Vulkan."""
    folder = tmp_path_factory.mktemp("spirv")
    (folder / "every.frag").write_text(shader("450", every_function()))
    run("glslangValidator", "-V", folder / "every.frag", "-o", folder / "every.spv")
    return folder / "every.spv"


@pytest.mark.parametrize("dialect", DIALECTS)
def test_compiles(dialect: str, tmp_path: Path) -> None:
    (tmp_path / "every.frag").write_text(shader(dialect, every_function()))
    run("glslangValidator", tmp_path / "every.frag")


@pytest.mark.parametrize("target", [["-V"], ["-G"], ["-V", "--target-env", "vulkan1.3"]], ids="-".join)
def test_spirv(target: list[str], tmp_path: Path) -> None:
    (tmp_path / "every.frag").write_text(shader("450", every_function()))
    run("glslangValidator", *target, tmp_path / "every.frag", "-o", tmp_path / "every.spv")
    environment = "opengl4.5" if target == ["-G"] else target[-1] if len(target) > 1 else "vulkan1.0"
    run("spirv-val", "--target-env", environment, tmp_path / "every.spv")


def test_in_every_stage(tmp_path: Path) -> None:
    """A vertex and a compute shader may include it, too."""
    vertex = "void main() { gl_Position = vec4(bs_normal(vec3(1.0), vec3(0.0, 1.0, 2.0)), 1.0); }\n"
    (tmp_path / "x.vert").write_text(f"#version 450\n{LIBRARY}{vertex}")
    compute = ("layout(local_size_x = 8) in;\nlayout(std430, binding = 0) buffer Taus { float tau[]; };\n"
               "void main() { uint i = gl_GlobalInvocationID.x; tau[i] = bs_tau0(bs_view(-0.5, 1.0, 1.0), tau[i]); }\n")
    (tmp_path / "x.comp").write_text(f"#version 450\n{LIBRARY}{compute}")
    for name in ("x.vert", "x.comp"):
        run("glslangValidator", "-V", tmp_path / name, "-o", tmp_path / "x.spv")


def calls_all(text: str) -> None:
    """All functions are in what spirv-cross has made (those that only a call of another one needs, too)."""
    assert set(functions(LIBRARY)) - set(re.findall(r"\b(bs_\w+)\(", text)) == set()


@pytest.mark.parametrize("model", ["50", "60"])
def test_hlsl(model: str, spirv: Path, tmp_path: Path) -> None:
    text = run("spirv-cross", spirv, "--hlsl", "--shader-model", model)
    calls_all(text)
    (tmp_path / "every.frag").write_text(text)
    run("glslangValidator", "-D", "-V", "-e", "main", "-S", "frag", tmp_path / "every.frag", "-o", tmp_path / "x.spv")


def test_metal(spirv: Path) -> None:
    for version in ("10200", "20100", "30000"):
        text = run("spirv-cross", spirv, "--msl", "--msl-version", version)
        calls_all(text)
        assert "#include <metal_stdlib>" in text and re.search(r"^fragment main0_out main0\(", text, re.MULTILINE)


@pytest.mark.parametrize("words", [["--version", "300", "--es"], ["--version", "330", "--no-es"],
                                   ["--version", "450", "--no-es"], ["--version", "450", "--vulkan-semantics"]],
                         ids=["es300", "330", "450", "vulkan"])
def test_glsl_again(words: list[str], spirv: Path, tmp_path: Path) -> None:
    text = run("spirv-cross", spirv, *words)
    calls_all(text)
    (tmp_path / "every.frag").write_text(text)
    vulkan = ["-V", "-o", tmp_path / "x.spv"] if "--vulkan-semantics" in words else []
    run("glslangValidator", *vulkan, tmp_path / "every.frag")


# Examples -------------------------------------------------------------------------------------------------------

GIVEN = """
vec3 s, Qu, Qw, Quu, Quw, Qww, X, light;
float P, Pu, Pw, Pmin, Pmax, t0, t_hit, u, w, u0, w0, curvature;
const int N = 8;
float height(float u, float w) { return 0.1 * u * w; }
"""


def by_its_head(name: str, folder: Path) -> Path:
    """Does what the head of an example says, in a copy; where its files are then."""
    shutil.copytree(TOP / "examples/shader", folder / "examples/shader")
    shutil.copytree(TOP / "include", folder / "include")
    made = folder / "examples/shader"
    commands = re.findall(r"^ \* {5}((?:glslangV|spirv).*)$", (made / name).read_text(encoding="utf-8"), re.MULTILINE)
    assert commands
    for command in commands:
        run(*command.split(), folder=made)
    return made


@pytest.mark.parametrize("name", EXAMPLES)
def test_example(name: str, tmp_path: Path) -> None:
    made = by_its_head(name, tmp_path)
    for path in made.glob("*.spv"):
        run("spirv-val", "--target-env", "vulkan1.2", path)
    if name == "raytraced.frag":
        assert "intersection_query" in run("spirv-cross", made / "frag.spv", "--msl", "--msl-version", "30000")
        assert "RayQuery<" in run("spirv-cross", made / "frag.spv", "--hlsl", "--shader-model", "65")


def test_the_page_shows_what_is_made(tmp_path: Path) -> None:
    """The HLSL and the Metal of docs/shaders.md are what spirv-cross has made of shift.comp; GLSL is the file's."""
    made = by_its_head("shift.comp", tmp_path)
    page = (TOP / "docs/shaders.md").read_text(encoding="utf-8")
    start = (made / "start.glsl").read_text(encoding="utf-8")
    for language, text in (("hlsl", (made / "shift.hlsl").read_text()), ("metal", (made / "shift.metal").read_text()),
                           ("glsl", LIBRARY + start)):
        shown = re.findall(rf"^```{language}\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
        assert shown and all(block in text for block in shown), f"{language}: {shown}"


def test_examples_in_comments(tmp_path: Path) -> None:
    """Those of the file's comments, one after the other in one function, as they build on each other."""
    found = re.findall(r"(?:^ \* {5}.*\n)+", LIBRARY, re.MULTILINE)
    code = [re.sub(r"^ \* {5}", "    ", text, flags=re.MULTILINE) for text in found]
    code = [text for text in code if re.search(r";\s*(//.*)?$", text, re.MULTILINE)]
    assert len(code) == 3
    code[1] = "bs_slab slab = b;\n" + code[1]
    main = f"{GIVEN}void main()\n{{\n{''.join(code)}color = vec4(t0, m.tau, dark ? 1.0 : 0.0, np.x);\n}}\n"
    for dialect in DIALECTS:
        (tmp_path / "x.frag").write_text(shader(dialect, main))
        run("glslangValidator", tmp_path / "x.frag")
