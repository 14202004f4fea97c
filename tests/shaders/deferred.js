/* A small deferred renderer for the shaders of examples/shader: a shadow map, a G-buffer, lighting. It is what an
 * engine has already. `given`: the shaders, meshes, matrices and the height map, from test_glsl_deferred.py. Returns
 * the picture as base64, rows from below; alpha is how much of the light is seen. */
function deferred(given) {
  const canvas = Object.assign(document.createElement('canvas'), {width: given.width, height: given.height});
  const gl = canvas.getContext('webgl2');
  if (!gl || !gl.getExtension('EXT_color_buffer_float')) throw Error('no WebGL 2 with float targets');
  const mesh_vertex = `#version 300 es
    layout(location = 0) in vec3 place; layout(location = 1) in vec3 normal; layout(location = 2) in vec2 at;
    uniform mat4 world_to_clip; out vec3 Q, N; out vec2 uv;
    void main() { Q = place; N = normal; uv = at; gl_Position = world_to_clip * vec4(place, 1); }`;
  const picture_vertex = `#version 300 es
    out vec2 uv;
    void main() {
      uv = vec2(gl_VertexID == 1 ? 2 : 0, gl_VertexID == 2 ? 2 : 0);
      gl_Position = vec4(2.0 * uv - 1.0, 0, 1);
    }`;
  const depth_fragment = '#version 300 es\nvoid main() {}';

  const floats = (text) => new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  const program = (vertex, fragment) => {
    const p = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw Error(gl.getShaderInfoLog(shader));
      gl.attachShader(p, shader);
    }
    gl.linkProgram(p);
    if (!gl.getProgramParameter(p, gl.LINK_STATUS)) throw Error(gl.getProgramInfoLog(p));
    return p;
  };
  const texture = (format, width, height, base, type, data, filter, wrap) => {
    const t = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, t);
    gl.texImage2D(gl.TEXTURE_2D, 0, format, width, height, 0, base, type, data);
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, filter);
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, wrap);
    return t;
  };
  const target = (width, height, format, base, type) =>
      texture(format, width, height, base, type, null, gl.NEAREST, gl.CLAMP_TO_EDGE);
  const depth_of = (w, h) => target(w, h, gl.DEPTH_COMPONENT32F, gl.DEPTH_COMPONENT, gl.FLOAT);
  const framebuffer = (colors, depth) => {
    gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
    colors.forEach((t, i) => gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, gl.TEXTURE_2D, t, 0));
    if (depth) gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, depth, 0);
    gl.drawBuffers(colors.length ? colors.map((_, i) => gl.COLOR_ATTACHMENT0 + i) : [gl.NONE]);
    if (gl.checkFramebufferStatus(gl.FRAMEBUFFER) !== gl.FRAMEBUFFER_COMPLETE) throw Error('no such target');
  };
  const set = (p, uniforms) => {
    gl.useProgram(p);
    let unit = 0;
    for (const [name, value] of Object.entries(uniforms)) {
      const at = gl.getUniformLocation(p, name);
      if (value instanceof WebGLTexture) {
        gl.activeTexture(gl.TEXTURE0 + unit);
        gl.bindTexture(gl.TEXTURE_2D, value);
        gl.uniform1i(at, unit++);
      } else if (typeof value === 'number') gl.uniform1f(at, value);
      else if (value.length === 3) gl.uniform3fv(at, value);
      else gl.uniformMatrix4fv(at, false, value);
    }
  };
  const meshes = given.meshes.map((mesh) => {
    const vertices = gl.createVertexArray();
    gl.bindVertexArray(vertices);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    const numbers = floats(mesh.vertices);
    gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
    [[3, 0], [3, 12], [2, 24]].forEach(([size, offset], i) => {
      gl.enableVertexAttribArray(i);
      gl.vertexAttribPointer(i, size, gl.FLOAT, false, 32, offset);
    });
    return {...mesh, vertices, count: numbers.length / 8};
  });
  const draw_meshes = (p, uniforms, clip) => {
    gl.enable(gl.DEPTH_TEST);
    gl.clear(gl.DEPTH_BUFFER_BIT | gl.COLOR_BUFFER_BIT);
    for (const mesh of meshes) {
      set(p, {...uniforms, world_to_clip: clip, albedo: mesh.color, scale: mesh.scale});
      gl.bindVertexArray(mesh.vertices);
      gl.drawArrays(gl.TRIANGLES, 0, mesh.count);
    }
    gl.disable(gl.DEPTH_TEST);
  };

  const map = depth_of(given.map, given.map); // the shadow map
  framebuffer([], map);
  gl.viewport(0, 0, given.map, given.map);
  gl.enable(gl.POLYGON_OFFSET_FILL);
  gl.polygonOffset(4, 4);
  draw_meshes(program(mesh_vertex, depth_fragment), {}, given.world_to_map);
  gl.disable(gl.POLYGON_OFFSET_FILL);
  gl.bindTexture(gl.TEXTURE_2D, map);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_COMPARE_MODE, gl.COMPARE_REF_TO_TEXTURE);

  gl.viewport(0, 0, given.width, given.height); // the G-buffer: 8 bits of color, else 16
  const of_picture = (format, type) => target(given.width, given.height, format, gl.RGBA, type);
  const [color, rough, normal] = [of_picture(gl.RGBA8, gl.UNSIGNED_BYTE), of_picture(gl.RGBA16F, gl.HALF_FLOAT),
    of_picture(gl.RGBA16F, gl.HALF_FLOAT)];
  const depth = depth_of(given.width, given.height);
  const heights = texture(gl.R16F, given.map_size[0], given.map_size[1], gl.RED, gl.FLOAT,
      floats(given.heights), gl.LINEAR, gl.REPEAT);
  framebuffer([color, rough, normal], depth);
  draw_meshes(program(mesh_vertex, given.gbuffer), {eye: given.eye, heights, zero: given.zero}, given.world_to_picture);

  framebuffer([of_picture(gl.RGBA8, gl.UNSIGNED_BYTE)], null); // the picture
  set(program(picture_vertex, given.lighting), {
    color, rough, normal, depth, map, eye: given.eye, light: given.light, light_color: given.light_color,
    ambient: given.ambient, picture_to_world: given.picture_to_world, world_to_map: given.world_to_map});
  gl.bindVertexArray(null);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  const out = new Uint8Array(4 * given.width * given.height);
  gl.readPixels(0, 0, given.width, given.height, gl.RGBA, gl.UNSIGNED_BYTE, out);
  const error = gl.getError();
  if (error !== gl.NO_ERROR) throw Error(`WebGL error ${error}`);
  let text = '';
  for (let i = 0; i < out.length; i += 4096) text += String.fromCharCode(...out.subarray(i, i + 4096));
  return btoa(text);
}
