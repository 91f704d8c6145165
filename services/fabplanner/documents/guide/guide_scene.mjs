// The shapes of all steps, as the page carries them: guide_scene.h writes them. What is alike is there
// once, with where each of it stands.

import { unfoldSteps } from "../../../../common/pages/modules/packed_numbers.mjs";

export const STANDING = 0, ADDED = 1, FASTENER = 2;
const SHARP = Math.cos(Math.PI / 6);  // edges of faces that meet at more are drawn

export class GuideScene {
  // description: what the page says of the scene; lists: of its pack.
  constructor(description, lists) {
    this.description = description;
    this.lists = lists;
    this.shapes = description.shapes.map(({ corners, nodes, first, indices }) => {
      const steps = unfoldSteps(lists.corners, corners, 3 * nodes, null, 3);
      const positions = Float32Array.from(steps, (step) => step * description.quantum);
      const triangles = lists.triangles.subarray(first, first + indices);
      return { positions, triangles, edges: sharpEdges(positions, triangles) };
    });
    this.steps = description.steps;
  }

  // What stands in a step: of each instance its shape, place, offset and role.
  instancesOf(step) {
    const { instances, instanceGroups, groupOffsets, groupRoles, thingShapes, thingPlaces } = this.lists;
    const found = [];
    for (let i = step.firstInstance; i < step.firstInstance + step.instances; ++i) {
      const thing = instances[i], group = step.firstGroup + instanceGroups[i];
      found.push({
        shape: thingShapes[thing],
        place: thingPlaces.subarray(3 * thing, 3 * thing + 3),
        offset: groupOffsets.subarray(3 * group, 3 * group + 3),
        role: groupRoles[group],
      });
    }
    return found;
  }

  // Ways of what comes in: nine numbers each, a place and how far both ends are from it.
  arrowsOf(step) {
    return this.lists.arrows.subarray(9 * step.firstArrow, 9 * (step.firstArrow + step.arrows));
  }

  goalsOf(step) {
    return this.lists.goals.subarray(9 * step.firstGoal, 9 * (step.firstGoal + step.goals));
  }

  // The box of a step with its parts in their places and pulled apart: [low, high].
  boxOf(step) {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    const sizes = this.sizes ??= this.shapes.map(({ positions }) => sizeOf(positions));
    for (const { shape, place, offset } of this.instancesOf(step)) {
      for (let c = 0; c < 3; ++c) {
        low[c] = Math.min(low[c], place[c] + Math.min(0, offset[c]));
        high[c] = Math.max(high[c], place[c] + sizes[shape][c] + Math.max(0, offset[c]));
      }
    }
    return low[0] <= high[0] ? [low, high] : [[0, 0, 0], [1, 1, 1]];
  }
}

// Corners are counted from the lower corner of their box.
function sizeOf(positions) {
  const high = [0, 0, 0];
  for (let i = 0; i < positions.length; ++i) high[i % 3] = Math.max(high[i % 3], positions[i]);
  return high;
}

// Edges of one triangle, and those at which two meet sharply: two nodes each. Nodes at one place count
// as one, so that faces that were made apart join.
export function sharpEdges(positions, triangles) {
  const places = new Map();
  const merged = Uint32Array.from({ length: positions.length / 3 }, (_, n) => {
    const key = `${positions[3 * n]},${positions[3 * n + 1]},${positions[3 * n + 2]}`;
    if (!places.has(key)) places.set(key, n);
    return places.get(key);
  });
  const faces = new Map();  // of each edge, the normals of its faces
  for (let t = 0; t < triangles.length; t += 3) {
    const corners = [0, 1, 2].map((k) => merged[triangles[t + k]]);
    const normal = normalOf(positions, corners);
    if (!normal) continue;
    for (let k = 0; k < 3; ++k) {
      const a = corners[k], b = corners[(k + 1) % 3];
      const key = Math.min(a, b) * merged.length + Math.max(a, b);
      if (!faces.has(key)) faces.set(key, []);
      faces.get(key).push(normal);
    }
  }
  const edges = [];
  for (const [key, normals] of faces) {
    const [m, n] = normals;
    const isFlat = normals.length === 2 && m[0] * n[0] + m[1] * n[1] + m[2] * n[2] > SHARP;
    if (!isFlat) edges.push(Math.floor(key / merged.length), key % merged.length);
  }
  return new Uint32Array(edges);
}

// The unit normal of a triangle; null where it has no area.
function normalOf(positions, [a, b, c]) {
  const u = [0, 1, 2].map((k) => positions[3 * b + k] - positions[3 * a + k]);
  const v = [0, 1, 2].map((k) => positions[3 * c + k] - positions[3 * a + k]);
  const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
  const length = Math.hypot(...n);
  return length > 0 ? n.map((x) => x / length) : null;
}
