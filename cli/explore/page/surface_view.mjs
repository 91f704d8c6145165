// Draws a surface with WebGL 2: shaded from both sides, by facets or smoothly, with colours of a number
// of each node.

import { colourRow } from "./colour_scale.mjs";

const VERTICES = `#version 300 es
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in float scalar;
uniform mat4 view;
uniform mat4 projection;
out vec3 place;
out vec3 direction;
out float number;
void main() {
  vec4 seen = view * vec4(position, 1.0);
  place = seen.xyz;
  direction = mat3(view) * normal;
  number = scalar;
  gl_Position = projection * seen;
}`;

const FRAGMENTS = `#version 300 es
precision highp float;
in vec3 place;
in vec3 direction;
in float number;
uniform sampler2D colours;
uniform vec2 range;
uniform vec3 plain;
uniform bool coloured;
uniform bool smoothly;
uniform bool lines;
out vec4 colour;
void main() {
  if (lines) {
    colour = vec4(plain * 0.4, 0.4);  // premultiplied
    return;
  }
  vec3 facet = normalize(cross(dFdx(place), dFdy(place)));
  vec3 normal = smoothly && length(direction) > 0.5 ? normalize(direction) : facet;
  vec3 eye = normalize(-place);
  if (dot(normal, eye) < 0.0) normal = -normal;
  float share = clamp((number - range.x) / (range.y - range.x), 0.0, 1.0);
  vec3 base = coloured ? texture(colours, vec2(share * 255.0 / 256.0 + 0.5 / 256.0, 0.5)).rgb : plain;
  vec3 key = normalize(vec3(0.35, 0.6, 0.75));
  // Never dark, so that colours stay those of the legend.
  float light = 0.6 + 0.08 * normal.y + 0.28 * max(dot(normal, key), 0.0) + 0.16 * dot(normal, eye);
  float shine = coloured ? 0.06 : 0.16;
  vec3 half_way = normalize(key + eye);
  colour = vec4(base * light + shine * pow(max(dot(normal, half_way), 0.0), 40.0), 1.0);
}`;

function compile(gl) {
  const program = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, VERTICES], [gl.FRAGMENT_SHADER, FRAGMENTS]]) {
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

export class SurfaceView {
  // Null where the browser has no WebGL 2.
  static create(canvas) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: true, preserveDrawingBuffer: true });
    return gl ? new SurfaceView(canvas, gl) : null;
  }

  constructor(canvas, gl) {
    this.canvas = canvas;
    this.gl = gl;
    this.prepare();
    // A browser may take the graphics card away, and give it back.
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => {
      this.prepare();
      const { mesh, shape, scalars } = this;
      this.mesh = null;
      if (mesh) this.setMesh(mesh);
      if (shape) this.setShape(shape.positions, shape.normals);
      this.setScalars(scalars, this.range, this.signed);
      this.draw(this.last.camera, this.last.style);
    });
  }

  prepare() {
    const gl = this.gl;
    this.program = compile(gl);
    this.uniforms = {};
    for (const name of ["view", "projection", "range", "plain", "coloured", "smoothly", "lines"]) {
      this.uniforms[name] = gl.getUniformLocation(this.program, name);
    }
    this.buffers = {};
    for (const name of ["position", "normal", "scalar", "triangles", "edges"]) {
      this.buffers[name] = gl.createBuffer();
    }
    this.rows = [false, true].map((signed) => {
      const texture = gl.createTexture();
      gl.bindTexture(gl.TEXTURE_2D, texture);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA, 256, 1, 0, gl.RGBA, gl.UNSIGNED_BYTE, colourRow(signed));
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.LINEAR);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
      return texture;
    });
    gl.enable(gl.DEPTH_TEST);
    gl.depthFunc(gl.LEQUAL);
  }

  // What all shapes of a mesh share: {triangles, edges}.
  setMesh(mesh) {
    if (this.mesh === mesh) return;
    const gl = this.gl;
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.buffers.triangles);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, mesh.triangles, gl.STATIC_DRAW);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.buffers.edges);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, mesh.edges, gl.STATIC_DRAW);
    this.mesh = mesh;
  }

  setShape(positions, normals) {
    this.shape = { positions, normals };
    this.fill("position", positions);
    this.fill("normal", normals);
  }

  // A number of each node, and which numbers have the colours' ends; null for the plain surface.
  setScalars(scalars, range, signed) {
    Object.assign(this, { scalars, range, signed });
    if (scalars) this.fill("scalar", scalars);
  }

  fill(name, numbers) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[name]);
    gl.bufferData(gl.ARRAY_BUFFER, numbers, gl.DYNAMIC_DRAW);
  }

  clear() {
    this.resize();
    this.gl.clearColor(0, 0, 0, 0);
    this.gl.clear(this.gl.COLOR_BUFFER_BIT | this.gl.DEPTH_BUFFER_BIT);
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

  // style: {smoothly, edges, plain: colour of the surface without numbers, line: of edges}.
  draw(camera, style) {
    this.last = { camera, style };
    this.clear();
    const gl = this.gl;
    if (!this.shape || gl.isContextLost()) return;
    gl.useProgram(this.program);
    const { view, projection } = camera.matrices(this.canvas.width / this.canvas.height);
    gl.uniformMatrix4fv(this.uniforms.view, false, view);
    gl.uniformMatrix4fv(this.uniforms.projection, false, projection);
    this.attribute(0, "position", 3);
    this.attribute(1, "normal", 3);
    if (this.scalars) this.attribute(2, "scalar", 1); else gl.disableVertexAttribArray(2);
    gl.bindTexture(gl.TEXTURE_2D, this.rows[this.signed ? 1 : 0]);
    gl.uniform2fv(this.uniforms.range, this.range ?? [0, 1]);
    gl.uniform1i(this.uniforms.coloured, this.scalars ? 1 : 0);
    gl.uniform1i(this.uniforms.smoothly, style.smoothly ? 1 : 0);
    gl.uniform1i(this.uniforms.lines, 0);
    gl.uniform3fv(this.uniforms.plain, style.plain);
    if (style.edges) {
      gl.enable(gl.POLYGON_OFFSET_FILL);
      gl.polygonOffset(1, 1);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.buffers.triangles);
    gl.drawElements(gl.TRIANGLES, this.mesh.triangles.length, gl.UNSIGNED_INT, 0);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    if (!style.edges) return;
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    gl.uniform1i(this.uniforms.lines, 1);
    gl.uniform3fv(this.uniforms.plain, style.line);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.buffers.edges);
    gl.drawElements(gl.LINES, this.mesh.edges.length, gl.UNSIGNED_INT, 0);
    gl.disable(gl.BLEND);
  }

  attribute(place, name, components) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[name]);
    gl.enableVertexAttribArray(place);
    gl.vertexAttribPointer(place, components, gl.FLOAT, false, 0, 0);
  }

  // How many colours are in the picture, for tests.
  coloursDrawn() {
    const { gl, canvas } = this;
    const pixels = new Uint8Array(4 * canvas.width * canvas.height);
    gl.readPixels(0, 0, canvas.width, canvas.height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    return new Set(new Uint32Array(pixels.buffer)).size;
  }
}
