// Shapes of a structure's samples, and the shape of any design in between: P(x) = Σ ψ_k(x) p_k, node by
// node of their canonical mesh. Shapes are kept in steps of 16 bits, of the box of all shapes of a mesh
// and of the range of each field.

import { unfoldSteps } from "../../../common/pages/modules/packed_numbers.mjs";

// How far steps move a node at most, m: half the diagonal of one, in the mesh with the largest box.
// descriptions: what the page says of the shapes of each structure.
export function roundingOf(descriptions) {
  const meshes = descriptions.flatMap((description) => description.meshes);
  return Math.max(0, ...meshes.map(({ step }) => Math.hypot(...step) / 2));
}

export class SurfaceShapes {
  // description: what the page says of a structure's shapes; lists: of its pack.
  constructor(description, lists) {
    this.fields = description.fields;
    this.meshes = description.meshes.map((mesh) => ({
      ...mesh,
      triangles: lists[`triangles${mesh.number}`],
      samples: new Map(),
    }));
    for (const sample of description.samples) {
      const mesh = this.meshes[sample.mesh];
      // All samples of a mesh are kept as differences from its first.
      const [base] = mesh.samples.values();
      const read = (first, components, from) => first < 0 ? null :
        unfoldSteps(lists.steps, first, components * mesh.nodes, from ?? null, components);
      mesh.samples.set(sample.sample, {
        positions: read(sample.positions, 3, base?.positions),
        fields: this.fields.map((field, f) =>
          read(sample.fields[f], field.components, base?.fields[f])),
      });
    }
  }

  // Whether the map has a shape at a place of its tree: there may be metrics alone.
  has(tree, place) {
    return tree.arrays.meshes[tree.locate(place)] >= 0;
  }

  // The shape at a place of the map's tree that has one: {mesh, parts: [[sample's steps, weight]]}. Each
  // sample around has a shape in the mesh of the element.
  at(tree, place) {
    const number = tree.arrays.meshes[tree.locate(place)];
    const mesh = this.meshes.find((one) => one.number === number);
    const parts = tree.weightsAt(place).map(([sample, weight]) => [mesh?.samples.get(sample), weight]);
    if (parts.some(([sample]) => !sample)) throw new Error("the page lacks a shape around this design");
    return { mesh, parts };
  }

  // x, y, z of each node, m.
  positions(shape) {
    const out = new Float32Array(3 * shape.mesh.nodes);
    blend(shape.parts.map(([sample, weight]) => [sample.positions, weight]), shape.mesh.low,
      shape.mesh.step, out);
    return out;
  }

  // Components of each node of a field, SI unit; null where a sample around has it not.
  field(shape, number) {
    const { components, low, step } = this.fields[number];
    const steps = shape.parts.map(([sample, weight]) => [sample.fields[number], weight]);
    if (steps.some(([sample]) => !sample)) return null;
    const out = new Float32Array(components * shape.mesh.nodes);
    blend(steps, new Array(components).fill(low), new Array(components).fill(step), out);
    return out;
  }
}

// low + step · Σ weight · steps, of each component.
function blend(parts, low, step, out) {
  for (const [steps, weight] of parts) {
    for (let i = 0; i < out.length; ++i) out[i] += weight * steps[i];
  }
  const sum = parts.reduce((total, [, weight]) => total + weight, 0);
  const components = low.length;
  for (let i = 0; i < out.length; ++i) {
    const c = i % components;
    out[i] = low[c] * sum + step[c] * out[i];
  }
}

// The unit normal of each node: those of its triangles by their areas. Where two sides meet in a sharp
// edge it lies between them.
export function smoothNormals(positions, triangles) {
  const normals = new Float32Array(positions.length);
  for (let t = 0; t < triangles.length; t += 3) {
    const a = 3 * triangles[t], b = 3 * triangles[t + 1], c = 3 * triangles[t + 2];
    const ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1];
    const uz = positions[b + 2] - positions[a + 2];
    const vx = positions[c] - positions[a], vy = positions[c + 1] - positions[a + 1];
    const vz = positions[c + 2] - positions[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    for (const n of [a, b, c]) {
      normals[n] += x;
      normals[n + 1] += y;
      normals[n + 2] += z;
    }
  }
  for (let n = 0; n < normals.length; n += 3) {
    const length = Math.hypot(normals[n], normals[n + 1], normals[n + 2]) || 1;
    for (let c = 0; c < 3; ++c) normals[n + c] /= length;
  }
  return normals;
}

// Each edge of the triangles once: two nodes each.
export function edgesOf(triangles, nodes) {
  const seen = new Set();
  const edges = [];
  for (let t = 0; t < triangles.length; t += 3) {
    for (let k = 0; k < 3; ++k) {
      const a = triangles[t + k], b = triangles[t + (k + 1) % 3];
      const key = Math.min(a, b) * nodes + Math.max(a, b);
      if (seen.has(key)) continue;
      seen.add(key);
      edges.push(a, b);
    }
  }
  return new Uint32Array(edges);
}

// What of a field can be shown as colours, by the number of its components.
export function showable(components) {
  if (components === 1) return [];
  if (components === 3) return ["magnitude", "x", "y", "z"];
  if (components === 6) return ["von Mises", "xx", "yy", "zz", "xy", "yz", "xz"];
  return Array.from({ length: components }, (_, c) => String(c + 1));
}

// One number of each node: `which` of showable(components).
export function scalarsOf(values, components, which) {
  if (components === 1) return values;
  const out = new Float32Array(values.length / components);
  const place = showable(components).indexOf(which);
  if (place > 0 || (components !== 3 && components !== 6)) {
    const c = components === 3 || components === 6 ? place - 1 : Math.max(place, 0);
    for (let n = 0; n < out.length; ++n) out[n] = values[n * components + c];
    return out;
  }
  for (let n = 0; n < out.length; ++n) {
    const v = values.subarray(n * components, (n + 1) * components);
    out[n] = components === 3 ? Math.hypot(v[0], v[1], v[2]) : vonMises(v);
  }
  return out;
}

// Of stresses xx, yy, zz, xy, yz, xz.
function vonMises([xx, yy, zz, xy, yz, xz]) {
  const normal = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2;
  return Math.sqrt(normal / 2 + 3 * (xy ** 2 + yz ** 2 + xz ** 2));
}

export function extremes(numbers) {
  let low = Infinity, high = -Infinity;
  for (const number of numbers) {
    if (number < low) low = number;
    if (number > high) high = number;
  }
  return [low, high];
}

// Between what 99 of 100 numbers lie: peaks of stress in sharp corners leave the rest in one colour.
export function mostOf(numbers) {
  const sorted = Float32Array.from(numbers).sort();
  const at = (share) => sorted[Math.round(share * (sorted.length - 1))];
  return [at(0.005), at(0.995)];
}

// The box of positions: [low, high], of three numbers each.
export function boxOf(positions) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < positions.length; ++i) {
    const c = i % 3;
    if (positions[i] < low[c]) low[c] = positions[i];
    if (positions[i] > high[c]) high[c] = positions[i];
  }
  return [low, high];
}
