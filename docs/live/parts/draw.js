
/* ---- drawing: a program for each scene's kind and each method, made when it is first needed ---- */

const source = Object.fromEntries([...document.querySelectorAll('[type="x-shader/x-fragment"]')].map((script) =>
  [script.id.replace(".glsl", ""), script.textContent.replace(/^\n/, "")])); /* in their order */
const NAMES = ["PLANE", "RECTANGLE", "SPHERE", "BOX", ...Object.values(DEFINES)];
const VERTEX = `#version 300 es
void main() { gl_Position = vec4(ivec2(gl_VertexID & 1, gl_VertexID >> 1) * 4 - 1, 0, 1); }`;

let gl = null, parallel = null, programs = new Map(), textures = {}, samplesOf = {};

function definesOf(s, method) {
  const scene = scenes[s.scene];
  return { GROUND: scene.ground.kind.toUpperCase(), CASTER: scene.caster.kind.toUpperCase(), METHOD: DEFINES[method],
    SHIFTED: s.shade && method !== "displaced" ? 1 : 0, MARCH_STEPS: method === "march" ? s.march : 1,
    OWN_STEPS: s.own && method !== "displaced" ? s.steps : 0 };
}

function shaderText(defines) {
  const lines = [...NAMES.map((name, i) => `#define ${name} ${i + 1}`),
    ...Object.entries(defines).map(([name, value]) => `#define ${name} ${value}`)];
  return ["#version 300 es", "precision highp float;", "precision highp int;", ...lines, ""].join("\n") +
    Object.values(source).join("\n");
}

function compile(kind, text) {
  const shader = gl.createShader(kind);
  gl.shaderSource(shader, text);
  gl.compileShader(shader);
  return shader;
}

function programOf(defines) {
  const key = JSON.stringify(defines);
  if (programs.has(key)) return programs.get(key);
  const program = gl.createProgram();
  const shaders = [compile(gl.VERTEX_SHADER, VERTEX), compile(gl.FRAGMENT_SHADER, shaderText(defines))];
  for (const shader of shaders) gl.attachShader(program, shader);
  gl.linkProgram(program);
  if (programs.size >= 40) { /* sliders of steps make many */
    const [oldest, old] = programs.entries().next().value;
    gl.deleteProgram(old.program);
    programs.delete(oldest);
  }
  programs.set(key, { program, shaders, uniforms: null });
  return programs.get(key);
}

/* Whether a program can be used without waiting for its compiler. */
function isCompiled({ program, uniforms }) {
  return uniforms !== null || !parallel || gl.getProgramParameter(program, parallel.COMPLETION_STATUS_KHR) === true;
}

/* Once it is compiled. */
function uniformsIn(made) {
  const { program, shaders } = made;
  if (made.uniforms) return made.uniforms;
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost())
    throw new Error("the shaders do not compile: " + shaders.map((x) => gl.getShaderInfoLog(x)).join("") +
      gl.getProgramInfoLog(program));
  for (const shader of shaders) gl.deleteShader(shader);
  made.uniforms = [];
  for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i++) {
    const { name, type } = gl.getActiveUniform(program, i);
    made.uniforms.push({ name, type, at: gl.getUniformLocation(program, name) });
  }
  return made.uniforms;
}

/* The values of all uniforms, by name. */
function uniformsOf(s, width, height, side) {
  const scene = scenes[s.scene], { bump } = scene.ground, map = maps[bump.map], scale = bump.scale * s.height;
  const ends = [map.low, map.high].map((x) => Math.fround(scale * (x * map.unit - bump.zero)));
  const values = { ...cameraOf(s, scene, width / height), background: scene.background, light_at: lightOf(s, scene),
    light_color: scene.light.color, samples: 0, map_k: bump.k, map_o: bump.o, map_cells: bump.cells,
    map_repeats: bump.repeats, scale, zero: bump.zero, Pmin: Math.min(...ends), Pmax: Math.max(...ends),
    sample_width: scene.ground.sample_width, picture: [width, height], samples_side: side };
  scene.materials.forEach((material, i) => {
    for (const [key, value] of Object.entries(material)) values[`material[${i}].${key}`] = value;
  });
  for (const of of ["ground", "caster"])
    for (const [key, value] of Object.entries(scene[of])) values[`${of}_${key}`] = value;
  return values;
}

function setUniform({ name, type, at }, value) {
  if (value === undefined) throw new Error(`no value for the uniform ${name}`);
  if (type === gl.FLOAT) gl.uniform1f(at, value);
  else if (type === gl.FLOAT_VEC2) gl.uniform2fv(at, value);
  else if (type === gl.FLOAT_VEC3) gl.uniform3fv(at, value);
  else if (type === gl.INT_VEC2) gl.uniform2iv(at, value);
  else gl.uniform1i(at, value);
}

function textureOf(name) {
  if (!textures[name]) {
    const { columns, rows, samples } = samplesOf[name];
    textures[name] = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, textures[name]);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.R32F, columns, rows, 0, gl.RED, gl.FLOAT, samples);
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
      gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
  }
  return textures[name];
}

/* Draw columns x0 to x1 of the picture by one method, with side x side samples a pixel. */
function drawPart(s, method, width, height, x0, x1, side) {
  const made = programOf(definesOf(s, method)), uniforms = uniformsIn(made);
  const values = uniformsOf(s, width, height, side);
  gl.useProgram(made.program);
  gl.bindTexture(gl.TEXTURE_2D, textureOf(scenes[s.scene].ground.bump.map));
  for (const uniform of uniforms) setUniform(uniform, values[uniform.name]);
  gl.scissor(x0, 0, x1 - x0, height);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
}

/* What is drawn where: [method, first column, column behind the last]. */
function partsOf(s, width) {
  const x = Math.round(s.line * width);
  return [[s.left, 0, x], [s.right, x, width]].filter(([, x0, x1]) => x1 > x0);
}

/* Begin to compile what a picture needs. Whether all is ready. */
function isReady(s, width) {
  return partsOf(s, width).map(([method]) => programOf(definesOf(s, method))).every(isCompiled);
}

function drawPicture(s, width, height, side) {
  gl.viewport(0, 0, width, height);
  gl.enable(gl.SCISSOR_TEST);
  for (const [method, x0, x1] of partsOf(s, width)) drawPart(s, method, width, height, x0, x1, side);
}

function startGl() {
  gl = canvas.getContext("webgl2", { alpha: false, depth: false, stencil: false, antialias: false,
    powerPreference: "high-performance" });
  parallel = gl?.getExtension("KHR_parallel_shader_compile");
  programs = new Map();
  textures = {};
  return gl !== null;
}
