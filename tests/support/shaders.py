"""One piece of code twice: in a shader, by WebGL in headless Chromium, and in double on the processor.

A `Job` is written in the C of bumpshadow.h. scripts/glsl.py turns it into GLSL, as it does the header. `on_processor`
compiles all jobs with the header in double, which tests/unit/method has compared with 50 digits. `Gpu.run` computes
them by include/bumpshadow.glsl, in float.
"""

from __future__ import annotations

import base64
import contextlib
import ctypes
import re
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from scripts import glsl
from tests.support.browser import browser, errors

if TYPE_CHECKING:
    from selenium.webdriver import Chrome

Columns = dict[str, np.ndarray]  # by name: a number or a vector for each case

SIZES = {"bs_vec3": 3, "bs_real": 1, "bs_bool": 1, "int": 1}
#: Functions that jobs may use beside the header's.
FUNCTIONS = {"sin": ("float", ["float"]), "cos": ("float", ["float"])}


@dataclass(frozen=True)
class Job:
    """`inputs` and `outputs`: names and types, as "bs_vec3 n; bs_real P, Pu"; an output may be a part, `v.sn`."""

    name: str
    inputs: str
    outputs: str
    body: str

    @staticmethod
    def names(text: str) -> list[tuple[str, str]]:
        found = [part.split(None, 1) for part in text.replace("\n", " ").split(";") if part.strip()]
        return [(name.strip(), kind) for kind, names in found for name in names.split(",")]

    def packing(self) -> list[str]:
        """Statements that give the outputs as numbers of their own, o0, o1, ..."""
        values = []
        for name, kind in self.names(self.outputs):
            if kind == "bs_vec3":
                values += [f"{name}.{axis}" for axis in "xyz"]
            else:
                values.append({"bs_bool": f"{name} ? 1 : 0", "int": f"(bs_real){name}"}.get(kind, name))
        return [f"bs_real o{i} = {value};" for i, value in enumerate(values)]

    def code(self) -> str:
        return "\n".join([self.body.strip(), *self.packing()])


def laid_out(names: Sequence[tuple[str, str]], columns: Mapping[str, Any]) -> np.ndarray:
    """The numbers of each case in a row, rounded to float."""
    parts = [np.asarray(columns[name], float).reshape(-1, SIZES[kind]) for name, kind in names]
    return np.concatenate(parts, axis=1).astype(np.float32)


def taken_apart(names: Sequence[tuple[str, str]], rows: np.ndarray) -> Columns:
    columns, at = {}, 0
    for name, kind in names:
        part = rows[:, at:at + SIZES[kind]].astype(float)
        columns[name] = part if kind == "bs_vec3" else part[:, 0]
        at += SIZES[kind]
    return columns


# On the processor -----------------------------------------------------------------------------------------------


def c_function(job: Job) -> str:
    """Of all cases, in double."""
    lines, at = [], 0
    for name, kind in job.names(job.inputs):
        numbers = ", ".join(f"({'int' if kind == 'int' else 'double'})in[{at + i}]" for i in range(SIZES[kind]))
        lines.append(f"{kind} {name} = {{{numbers}}};")
        at += SIZES[kind]
    count = len(job.packing())
    stores = "".join(f"out[{i}] = o{i};" for i in range(count))
    body = "\n".join(lines)
    return (f"void {job.name}(int cases, const float *in, double *out)\n{{\n"
            f"for (int k = 0; k < cases; k++, in += {at}, out += {count}) {{\n{body}\n{job.code()}\n{stores}\n}}\n}}\n")


class Processor:
    """The jobs, compiled."""

    def __init__(self, jobs: Sequence[Job], folder: Path) -> None:
        source, library = folder / "jobs.c", folder / "jobs.so"
        source.write_text('#define BS_DOUBLE\n#include "bumpshadow.h"\n' + "".join(map(c_function, jobs)))
        subprocess.run(["gcc", "-std=c99", "-O1", "-ffp-contract=off", "-shared", "-fPIC", f"-I{glsl.SOURCE.parent}",
                        source, "-o", library, "-lm"], check=True, timeout=300)
        self.library = ctypes.CDLL(str(library))

    def run(self, job: Job, columns: Mapping[str, Any]) -> Columns:
        rows = np.ascontiguousarray(laid_out(job.names(job.inputs), columns))
        out = np.zeros((len(rows), len(job.packing())))
        function = getattr(self.library, job.name)
        function(ctypes.c_int(len(rows)), rows.ctypes.data_as(ctypes.c_void_p), out.ctypes.data_as(ctypes.c_void_p))
        return taken_apart(job.names(job.outputs), out)


# In a shader ----------------------------------------------------------------------------------------------------

FETCH = """
uniform highp sampler2D inputs;
layout(location = 0) out vec4 result;

float number(int k) { return texelFetch(inputs, ivec2(k / 4, int(gl_FragCoord.y)), 0)[k % 4]; }
"""

SCRIPT = """
const [fragment, bytes, width, height, wide] = arguments;
const gl = document.createElement('canvas').getContext('webgl2');
if (!gl || !gl.getExtension('EXT_color_buffer_float')) throw Error('no WebGL 2 with float targets');
const program = gl.createProgram();
const corner = '#version 300 es\\nvoid main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : ' +
    '-1, 0, 1); }';
for (const [kind, text] of [[gl.VERTEX_SHADER, corner], [gl.FRAGMENT_SHADER, fragment]]) {
  const shader = gl.createShader(kind);
  gl.shaderSource(shader, text);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw Error(gl.getShaderInfoLog(shader));
  gl.attachShader(program, shader);
}
gl.linkProgram(program);
if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw Error(gl.getProgramInfoLog(program));
const texture = (w, data) => {
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, w, height, 0, gl.RGBA, gl.FLOAT, data);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
  return gl.getParameter(gl.TEXTURE_BINDING_2D);
};
const target = texture(wide, null);
gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
if (gl.checkFramebufferStatus(gl.FRAMEBUFFER) !== gl.FRAMEBUFFER_COMPLETE) throw Error('no float target');
texture(width, new Float32Array(Uint8Array.from(atob(bytes), (c) => c.charCodeAt(0)).buffer));
gl.useProgram(program);
gl.viewport(0, 0, wide, height);
gl.drawArrays(gl.TRIANGLES, 0, 3);
const out = new Float32Array(4 * wide * height);
gl.readPixels(0, 0, wide, height, gl.RGBA, gl.FLOAT, out);
if (gl.getError() !== gl.NO_ERROR) throw Error('a WebGL error');
const raw = new Uint8Array(out.buffer);
let text = '';
for (let i = 0; i < raw.length; i += 4096) text += String.fromCharCode(...raw.subarray(i, i + 4096));
return btoa(text);
"""


def as_glsl(job: Job) -> list[str]:
    """The job's statements."""
    inputs = "".join(f"{kind} {name};" for name, kind in job.names(job.inputs))
    writer = glsl.Writer(glsl.SOURCE.read_text(encoding="utf-8"))
    return writer.example(job.code(), inputs, FUNCTIONS)


def fragment_shader(job: Job) -> str:
    lines, at = [], 0
    for name, kind in job.names(job.inputs):
        numbers = ", ".join(f"number({at + i})" for i in range(SIZES[kind]))
        to = glsl.TYPES[kind]
        lines.append(f"{to} {name} = {to}({numbers});")
        at += SIZES[kind]
    lines += as_glsl(job)
    count = len(job.packing())
    wide = -(-count // 4) * 4
    lines.append(f"float outputs[{wide}];")
    lines += [f"outputs[{i}] = {f'o{i}' if i < count else '0.0'};" for i in range(wide)]
    lines.append("int at = 4 * int(gl_FragCoord.x);")
    lines.append("result = vec4(outputs[at], outputs[at + 1], outputs[at + 2], outputs[at + 3]);")
    main = "\n".join(f"    {line}" for line in lines)
    library = glsl.TARGET.read_text(encoding="utf-8")
    return f"#version 300 es\n{library}{FETCH}\nvoid main()\n{{\n{main}\n}}\n"


class Gpu:
    """A page with WebGL 2."""

    def __init__(self, driver: Chrome) -> None:
        self.driver = driver

    def run(self, job: Job, columns: Mapping[str, Any]) -> Columns:
        rows = laid_out(job.names(job.inputs), columns)
        rows = np.pad(rows, ((0, 0), (0, -rows.shape[1] % 4)))
        wide = -(-len(job.packing()) // 4)
        data = base64.b64encode(rows.tobytes()).decode()
        out = self.driver.execute_script(SCRIPT, fragment_shader(job), data, rows.shape[1] // 4, len(rows), wide)
        numbers = np.frombuffer(base64.b64decode(out), np.float32).reshape(len(rows), 4 * wide)
        return taken_apart(job.names(job.outputs), numbers)


@contextlib.contextmanager
def gpu() -> Iterator[Gpu]:
    """At its end nothing may be wrong in the console, but that reading back takes time."""
    with browser(webgl=True) as driver:
        driver.get("data:text/html,<title>shaders</title>")
        yield Gpu(driver)
        found = [message for message in errors(driver) if "GPU stall due to ReadPixels" not in message]
        assert not found, found


def functions(text: str) -> dict[str, str]:
    """Those that bumpshadow.glsl defines, with their bodies."""
    found = re.findall(r"^\w+ (bs_\w+)\([^)]*\)(?:\n\{\n(.*?)^\}| \{ (.*?) \}$)", text, re.MULTILINE | re.DOTALL)
    return {name: long or short for name, long, short in found}


def called(text: str) -> set[str]:
    """The functions bs_... that a text calls."""
    return set(re.findall(r"\b(bs_\w+)\(", text))
