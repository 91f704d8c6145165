// Draws a step with WebGL 2: each shape once for all of its places. What is added and fasteners are solid;
// what stands may be seen through.

import { ADDED, FASTENER, STANDING } from "./guide_scene.mjs";

const COLOURS = [[0.86, 0.86, 0.85], [0.95, 0.66, 0.28], [0.6, 0.3, 0.1]];
const ARROW = [0.05, 0.35, 0.75], GOAL = [0.75, 0.1, 0.1];
const NUMBERS = 7;  // of an instance: its place, its offset, its role

const VERTICES = `#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 place;
layout(location = 2) in vec3 offset;
layout(location = 3) in float role;
uniform mat4 view;
uniform mat4 projection;
uniform float apart;
uniform vec3 colours[3];
out vec3 seen;
out vec3 plain;
void main() {
  vec4 there = view * vec4(position + place + apart * offset, 1.0);
  seen = there.xyz;
  plain = colours[int(role + 0.5)];
  gl_Position = projection * there;
}`;

const FRAGMENTS = `#version 300 es
precision highp float;
in vec3 seen;
in vec3 plain;
uniform bool lines;
uniform float opacity;
out vec4 colour;
void main() {
  vec3 shaded = plain * 0.25;
  if (!lines) {
    vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
    vec3 eye = normalize(-seen);
    if (dot(normal, eye) < 0.0) normal = -normal;
    vec3 key = normalize(vec3(0.35, 0.6, 0.75));
    float light = 0.66 + 0.12 * normal.y + 0.24 * max(dot(normal, key), 0.0) + 0.16 * dot(normal, eye);
    shaded = plain * light;
  }
  colour = vec4(shaded * opacity, opacity);  // premultiplied
}`;

// Of ways: corners of an arrow or a spot, in pixels along it and beside it from one of its ends.
const WAY_VERTICES = `#version 300 es
layout(location = 0) in vec3 corner;  // which end, along, beside
layout(location = 1) in vec3 place;
layout(location = 2) in vec3 from;
layout(location = 3) in vec3 to;
uniform mat4 view;
uniform mat4 projection;
uniform float apart;
uniform vec2 size;  // of the picture, pixels
uniform float width;  // by which all is wider than its corners say
void main() {
  mat4 all = projection * view;
  vec4 a = all * vec4(place + apart * from, 1.0), b = all * vec4(place + apart * to, 1.0);
  vec2 way = (b.xy / b.w - a.xy / a.w) * size / 2.0;
  vec2 along = length(way) > 1.0 ? normalize(way) : vec2(0.0, 1.0);
  vec2 beside = vec2(-along.y, along.x);
  vec4 end = corner.x < 0.5 ? a : b;
  gl_Position = end;
  gl_Position.xy += (along * corner.y + beside * corner.z) * width * 2.0 / size * end.w;
}`;

const WAY_FRAGMENTS = `#version 300 es
precision highp float;
uniform vec4 plain;
out vec4 colour;
void main() { colour = vec4(plain.rgb * plain.a, plain.a); }`;

function compile(gl, vertices, fragments) {
  const program = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, vertices], [gl.FRAGMENT_SHADER, fragments]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) {
    throw new Error(`the program of the graphics card: ${gl.getProgramInfoLog(program)}`);
  }
  return program;
}

// Triangles of an arrow and of a spot, as WAY_VERTICES takes them.
function arrowCorners(half, headLength, headHalf) {
  return [0, 0, -half, 1, -headLength, -half, 1, -headLength, half, 0, 0, -half, 1, -headLength, half, 0, 0, half,
    1, -headLength, -headHalf, 1, 0, 0, 1, -headLength, headHalf];
}

function spotCorners(half, radius) {
  const corners = [0, 0, -half, 1, 0, -half, 1, 0, half, 0, 0, -half, 1, 0, half, 0, 0, half];
  const around = (i) => [1, radius * Math.cos(i * Math.PI / 6), radius * Math.sin(i * Math.PI / 6)];
  for (let i = 0; i < 12; ++i) corners.push(1, 0, 0, ...around(i), ...around(i + 1));
  return corners;
}

export class AssemblyView {
  // Null where the browser has no WebGL 2.
  static create(canvas, scene) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: true, preserveDrawingBuffer: true });
    return gl ? new AssemblyView(canvas, scene, gl) : null;
  }

  constructor(canvas, scene, gl) {
    Object.assign(this, { canvas, scene, gl });
    this.prepare();
    // A browser may take the graphics card away, and give it back.
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => {
      this.prepare();
      if (!this.step) return;
      this.show(this.step);
      this.draw(this.last.camera, this.last.style);
    });
  }

  prepare() {
    const gl = this.gl;
    this.program = compile(gl, VERTICES, FRAGMENTS);
    this.wayProgram = compile(gl, WAY_VERTICES, WAY_FRAGMENTS);
    this.meshes = [];
    this.instances = gl.createBuffer();
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    this.arrows = this.makeWays(arrowCorners(1.6 * ratio, 13 * ratio, 6 * ratio));
    this.goals = this.makeWays(spotCorners(0.7 * ratio, 3.4 * ratio));
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  makeWays(corners) {
    const gl = this.gl;
    const ways = { corners: corners.length / 3, count: 0 };
    ways.array = gl.createVertexArray();
    ways.list = gl.createBuffer();
    gl.bindVertexArray(ways.array);
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(corners), gl.STATIC_DRAW);
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, ways.list);
    for (let place = 1; place < 4; ++place) {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, 3, gl.FLOAT, false, 36, 12 * (place - 1));
      gl.vertexAttribDivisor(place, 1);
    }
    gl.bindVertexArray(null);
    return ways;
  }

  fillWays(ways, numbers) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, ways.list);
    gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
    ways.count = numbers.length / 9;
  }

  // Buffers of a shape, made when a step first has it.
  meshOf(number) {
    if (this.meshes[number]) return this.meshes[number];
    const gl = this.gl, shape = this.scene.shapes[number];
    const mesh = { indices: shape.triangles.length, edges: shape.edges.length };
    gl.bindVertexArray(null);
    mesh.positions = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, mesh.positions);
    gl.bufferData(gl.ARRAY_BUFFER, shape.positions, gl.STATIC_DRAW);
    for (const [name, list] of [["faces", shape.triangles], ["lines", shape.edges]]) {
      mesh[name] = gl.createVertexArray();
      gl.bindVertexArray(mesh[name]);
      gl.bindBuffer(gl.ARRAY_BUFFER, mesh.positions);
      gl.enableVertexAttribArray(0);
      gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, list, gl.STATIC_DRAW);
      gl.bindVertexArray(null);
    }
    return this.meshes[number] = mesh;
  }

  // Takes a step to draw. All instances of a shape and a role lie beside each other.
  show(step) {
    this.step = step;
    const gl = this.gl;
    const found = this.scene.instancesOf(step);
    found.sort((a, b) => a.role - b.role || a.shape - b.shape);
    const numbers = new Float32Array(NUMBERS * found.length);
    this.runs = [];
    found.forEach(({ shape, place, offset, role }, i) => {
      numbers.set([...place, ...offset, role], NUMBERS * i);
      const last = this.runs.at(-1);
      if (last && last.shape === shape && last.role === role) ++last.count;
      else this.runs.push({ shape, role, first: i, count: 1 });
    });
    gl.bindBuffer(gl.ARRAY_BUFFER, this.instances);
    gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.STATIC_DRAW);
    this.fillWays(this.arrows, this.scene.arrowsOf(step));
    this.fillWays(this.goals, this.scene.goalsOf(step));
  }

  resize() {
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    const width = Math.max(1, Math.round(this.canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(this.canvas.clientHeight * ratio));
    if (this.canvas.width !== width || this.canvas.height !== height) {
      Object.assign(this.canvas, { width, height });
    }
    this.gl.viewport(0, 0, width, height);
  }

  // style: {apart: 0 to 1, seeThrough}.
  draw(camera, style) {
    this.last = { camera, style };
    const { gl, canvas } = this;
    this.resize();
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    if (!this.step || gl.isContextLost()) return;
    const matrices = camera.matrices(canvas.width / canvas.height);
    this.use(this.program, matrices, style);
    gl.uniform3fv(gl.getUniformLocation(this.program, "colours"), COLOURS.flat());
    this.drawRuns((role) => role !== STANDING || !style.seeThrough, 1, 1);
    if (style.seeThrough) this.drawSeenThrough();
    this.drawWays(matrices, style);
    gl.bindVertexArray(null);
  }

  use(program, { view, projection }, { apart }) {
    const gl = this.gl;
    gl.useProgram(program);
    gl.uniformMatrix4fv(gl.getUniformLocation(program, "view"), false, view);
    gl.uniformMatrix4fv(gl.getUniformLocation(program, "projection"), false, projection);
    gl.uniform1f(gl.getUniformLocation(program, "apart"), apart);
  }

  // What stands, after all else: its nearest faces alone, so that layers do not add up.
  drawSeenThrough() {
    const gl = this.gl;
    const isStanding = (role) => role === STANDING;
    gl.colorMask(false, false, false, false);
    this.drawRuns(isStanding, 1, 0);
    gl.colorMask(true, true, true, true);
    gl.enable(gl.BLEND);
    this.drawRuns(isStanding, 0.35, 0.5);
    gl.disable(gl.BLEND);
  }

  drawRuns(wanted, opacity, edgeOpacity) {
    const gl = this.gl;
    const uniform = (name) => gl.getUniformLocation(this.program, name);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1, 1);
    gl.uniform1i(uniform("lines"), 0);
    gl.uniform1f(uniform("opacity"), opacity);
    for (const run of this.runs) if (wanted(run.role)) this.drawRun(run, "faces");
    gl.disable(gl.POLYGON_OFFSET_FILL);
    if (edgeOpacity === 0) return;
    gl.uniform1i(uniform("lines"), 1);
    gl.uniform1f(uniform("opacity"), edgeOpacity);
    for (const run of this.runs) if (wanted(run.role)) this.drawRun(run, "lines");
  }

  drawRun({ shape, first, count }, what) {
    const gl = this.gl, mesh = this.meshOf(shape);
    gl.bindVertexArray(mesh[what]);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.instances);
    [[1, 3, 0], [2, 3, 12], [3, 1, 24]].forEach(([place, components, offset]) => {
      gl.enableVertexAttribArray(place);
      gl.vertexAttribPointer(place, components, gl.FLOAT, false, 4 * NUMBERS, 4 * NUMBERS * first + offset);
      gl.vertexAttribDivisor(place, 1);
    });
    if (what === "faces") gl.drawElementsInstanced(gl.TRIANGLES, mesh.indices, gl.UNSIGNED_INT, 0, count);
    else gl.drawElementsInstanced(gl.LINES, mesh.edges, gl.UNSIGNED_INT, 0, count);
  }

  // Arrows over all; where fasteners go palely where something stands before it.
  drawWays(matrices, style) {
    const { gl, canvas } = this;
    this.use(this.wayProgram, matrices, style);
    gl.uniform2f(gl.getUniformLocation(this.wayProgram, "size"), canvas.width, canvas.height);
    gl.enable(gl.BLEND);
    // Hundreds of ways are told by thinner lines.
    const width = Math.max(0.35, Math.min(1, Math.sqrt(60 / (this.goals.count || 1))));
    gl.uniform1f(gl.getUniformLocation(this.wayProgram, "width"), width);
    this.drawWay(this.goals, [...GOAL, 0.9 * width]);
    gl.disable(gl.DEPTH_TEST);
    this.drawWay(this.goals, [...GOAL, 0.3 * width * width]);
    gl.uniform1f(gl.getUniformLocation(this.wayProgram, "width"), 1);
    if (style.apart > 0.02) this.drawWay(this.arrows, [...ARROW, 1]);
    gl.enable(gl.DEPTH_TEST);
    gl.disable(gl.BLEND);
  }

  drawWay(ways, colour) {
    if (ways.count === 0) return;
    const gl = this.gl;
    gl.uniform4fv(gl.getUniformLocation(this.wayProgram, "plain"), colour);
    gl.bindVertexArray(ways.array);
    gl.drawArraysInstanced(gl.TRIANGLES, 0, ways.corners, ways.count);
  }

  // How many instances of each role the step has, and how many colours are in the picture, for tests.
  told() {
    const { gl, canvas } = this;
    const pixels = new Uint8Array(4 * canvas.width * canvas.height);
    gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    const drawn = (role) => this.runs.reduce((sum, run) => sum + (run.role === role ? run.count : 0), 0);
    return { standing: drawn(STANDING), added: drawn(ADDED), fasteners: drawn(FASTENER),
      goals: this.goals.count, arrows: this.arrows.count, draws: this.runs.length,
      colours: new Set(new Uint32Array(pixels.buffer)).size };
  }
}
