const solidVertex = `#version 300 es
uniform mat4 view;
uniform vec3 light, up;
uniform float ground;
uniform bool shadow;
layout(location = 0) in vec3 corner;
layout(location = 1) in vec3 facing;
layout(location = 2) in vec3 place;
layout(location = 3) in vec4 turn;
layout(location = 4) in vec3 size;
layout(location = 5) in vec4 color;
out vec3 normal, inside;
out float height;
flat out vec4 paint;
vec3 turned(vec3 v) {
  vec3 t = 2.0 * cross(turn.yzw, v);
  return v + turn.x * t + cross(turn.yzw, t);
}
void main() {
  vec3 world = place + turned(size * corner);
  height = dot(world, up) - ground;
  if (shadow) world -= light * (height / dot(light, up));
  normal = turned(facing / size);
  inside = corner;
  paint = color;
  gl_Position = view * vec4(world, 1.0);
}`;

const solidFragment = `#version 300 es
precision highp float;
uniform vec3 light, up;
uniform float darkness;
uniform bool shadow;
in vec3 normal, inside;
in float height;
flat in vec4 paint;
out vec4 shown;
void main() {
  if (shadow) {
    if (height < 0.0) discard;
    shown = vec4(0.0, 0.0, 0.0, darkness);
    return;
  }
  // Faces of meshes are seen from behind too.
  vec3 n = normalize(gl_FrontFacing ? normal : -normal);
  float lit = 0.68 + 0.14 * dot(n, up) + 0.34 * max(dot(n, light), 0.0);
  // Octants of two tones show how a round body turns.
  if (paint.a > 0.5 && inside.x * inside.y * inside.z < 0.0) lit *= 0.8;
  shown = vec4(paint.rgb * lit, 1.0);
}`;

const lineVertex = `#version 300 es
uniform mat4 view;
uniform vec2 pixels;
uniform float width, count, near;
uniform bool ageing;
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
out vec3 world;
out float age;
void main() {
  vec4 a = view * vec4(from, 1.0), b = view * vec4(to, 1.0);
  if (a.w < near) a = mix(a, b, clamp((near - a.w) / (b.w - a.w), 0.0, 1.0));
  if (b.w < near) b = mix(b, a, clamp((near - b.w) / (a.w - b.w), 0.0, 1.0));
  vec2 along = (b.xy / b.w - a.xy / a.w) * pixels;
  along /= max(length(along), 1e-6);
  bool end = gl_VertexID >= 2;
  float side = gl_VertexID % 2 == 0 ? 1.0 : -1.0;
  vec4 place = end ? b : a;
  place.xy += side * width * vec2(-along.y, along.x) / pixels * place.w;
  world = end ? to : from;
  age = ageing ? (float(gl_InstanceID) + float(end)) / count : 1.0;
  gl_Position = place;
}`;

const lineFragment = `#version 300 es
precision highp float;
uniform vec4 color;
uniform vec3 centre;
uniform float reach;
in vec3 world;
in float age;
out vec4 shown;
void main() {
  float far = reach > 0.0 ? 1.0 - smoothstep(0.35, 1.0, distance(world, centre) / reach) : 1.0;
  shown = vec4(color.rgb, color.a * far * mix(0.08, 1.0, age));
}`;

/** Draws solids and lines with WebGL 2. */
class Painter {
  constructor(canvas) {
    // Where the processor draws, smooth edges and many corners would cost most of the time.
    const software = Painter.isSoftware();
    const gl = canvas.getContext("webgl2", { antialias: !software, stencil: true, alpha: false });
    if (!gl) throw new Error("this browser gives no WebGL 2");
    this.canvas = canvas;
    this.gl = gl;
    this.solids = this.program(solidVertex, solidFragment);
    this.lines = this.program(lineVertex, lineFragment);
    this.meshes = new Map();
    this.around = software ? { few: 32, many: 16, shadow: 8 } : { few: 40, many: 40, shadow: 24 };
    this.scratch = gl.createBuffer();
    this.lineArrays = gl.createVertexArray();
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  }

  /** Whether no graphics card draws. */
  static isSoftware() {
    const gl = document.createElement("canvas").getContext("webgl2");
    const information = gl?.getExtension("WEBGL_debug_renderer_info");
    const name = information ? gl.getParameter(information.UNMASKED_RENDERER_WEBGL) : "";
    gl?.getExtension("WEBGL_lose_context")?.loseContext();
    return /swiftshader|llvmpipe|software|basic render/i.test(name);
  }

  program(...sources) {
    const gl = this.gl;
    const program = gl.createProgram();
    sources.forEach((source, index) => {
      const shader = gl.createShader(index ? gl.FRAGMENT_SHADER : gl.VERTEX_SHADER);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    });
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    const places = {};
    const count = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
    for (let k = 0; k < count; k++) {
      const { name } = gl.getActiveUniform(program, k);
      places[name] = gl.getUniformLocation(program, name);
    }
    return { program, places };
  }

  /** The mesh of that key, made on first use. */
  mesh(key, make) {
    if (!this.meshes.has(key)) {
      const gl = this.gl;
      const { corners, triangles, open = false } = make();
      const array = gl.createVertexArray();
      gl.bindVertexArray(array);
      this.buffer(corners);
      for (const place of [0, 1]) this.attribute(place, 3, 24, 12 * place);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, triangles, gl.STATIC_DRAW);
      const copies = this.buffer(new Float32Array(0));
      Painter.parts.forEach(([place, size, offset]) => {
        this.attribute(place, size, 4 * Painter.stride, 4 * offset);
        gl.vertexAttribDivisor(place, 1);
      });
      const type = triangles instanceof Uint32Array ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT;
      this.meshes.set(key, { array, corners: triangles.length, type, open, copies });
    }
    return this.meshes.get(key);
  }

  /** Numbers of one copy of a mesh: attribute, how many, and where they begin. */
  static parts = [[2, 3, 0], [3, 4, 3], [4, 3, 7], [5, 4, 10]];
  static stride = 14;

  attribute(place, size, stride, offset) {
    this.gl.enableVertexAttribArray(place);
    this.gl.vertexAttribPointer(place, size, this.gl.FLOAT, false, stride, offset);
  }

  /** Numbers that stay as they are. */
  buffer(numbers) {
    const gl = this.gl;
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
    return buffer;
  }

  /** Begins a picture. */
  begin(camera, background, up) {
    const gl = this.gl;
    const { width, height } = this.canvas;
    gl.viewport(0, 0, width, height);
    gl.clearColor(...background, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    this.view = camera.matrix(width / height);
    this.near = camera.near();
    this.up = up;
    this.light = camera.light();
  }

  /** Draws solids, { mesh, pose, size, color, octants }, all copies of a mesh at once; or with `shadow`, { ground, darkness }, their
      shadow on the ground at that height. */
  drawSolids(solids, shadow = null) {
    const gl = this.gl;
    const groups = new Map();
    for (const { mesh, pose, size, color, octants } of solids) {
      if (!groups.has(mesh)) groups.set(mesh, []);
      groups.get(mesh).push(...pose.p, ...pose.q, ...size, ...color, octants ? 1 : 0);
    }
    const { program, places } = this.solids;
    gl.useProgram(program);
    gl.uniformMatrix4fv(places.view, false, this.view);
    gl.uniform3fv(places.light, this.light);
    gl.uniform3fv(places.up, this.up);
    gl.uniform1i(places.shadow, shadow ? 1 : 0);
    if (shadow) {
      gl.uniform1f(places.ground, shadow.ground);
      gl.uniform1f(places.darkness, shadow.darkness);
      // Each pixel is darkened once.
      gl.enable(gl.STENCIL_TEST);
      gl.stencilFunc(gl.EQUAL, 0, 255);
      gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
      gl.depthMask(false);
    }
    for (const [mesh, numbers] of groups) {
      // Meshes from files may have holes and faces turned over.
      if (mesh.open) gl.disable(gl.CULL_FACE);
      else gl.enable(gl.CULL_FACE);
      gl.bindVertexArray(mesh.array);
      gl.bindBuffer(gl.ARRAY_BUFFER, mesh.copies);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.STREAM_DRAW);
      gl.drawElementsInstanced(gl.TRIANGLES, mesh.corners, mesh.type, 0, numbers.length / Painter.stride);
    }
    gl.disable(gl.CULL_FACE);
    gl.disable(gl.STENCIL_TEST);
    gl.depthMask(true);
  }

  /** Draws segments between points, three numbers each; pairs of points, or with `strip` each point with the next; `above` even what hides
      them. */
  drawLines(points, { color, alpha = 1, width = 1.5, strip = false, from = 0, count, ageing = false, above = false, centre = [0, 0, 0], reach = 0 }) {
    const gl = this.gl;
    const { program, places } = this.lines;
    gl.useProgram(program);
    gl.bindVertexArray(this.lineArrays);
    if (points instanceof WebGLBuffer) gl.bindBuffer(gl.ARRAY_BUFFER, points);
    else {
      gl.bindBuffer(gl.ARRAY_BUFFER, this.scratch);
      gl.bufferData(gl.ARRAY_BUFFER, points, gl.STREAM_DRAW);
      count ??= strip ? points.length / 3 - 1 : points.length / 6;
    }
    if (count <= 0) return;
    for (const place of [0, 1]) {
      this.attribute(place, 3, strip ? 12 : 24, 12 * (from + place));
      gl.vertexAttribDivisor(place, 1);
    }
    gl.uniformMatrix4fv(places.view, false, this.view);
    gl.uniform2f(places.pixels, this.canvas.width, this.canvas.height);
    gl.uniform1f(places.near, this.near);
    gl.uniform1f(places.width, width);
    gl.uniform1f(places.count, count);
    gl.uniform1i(places.ageing, ageing ? 1 : 0);
    gl.uniform4f(places.color, ...color, alpha);
    gl.uniform3fv(places.centre, centre);
    gl.uniform1f(places.reach, reach);
    gl.depthMask(false);
    if (above) gl.disable(gl.DEPTH_TEST);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
    gl.enable(gl.DEPTH_TEST);
    gl.depthMask(true);
  }
}
