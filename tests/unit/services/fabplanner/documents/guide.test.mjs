// What the modules of the guide's page do without a browser. The rest of it is in
// tests/integration/services/fabplanner/guide_page_test.cpp.
import assert from "node:assert/strict";
import { test } from "node:test";

import { ADDED, GuideScene, sharpEdges, STANDING } from "../../../../../services/fabplanner/documents/guide/guide_scene.mjs";

// A cube: eight corners, two triangles a side.
const CUBE = Float32Array.from([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1]);
const SIDES = Uint32Array.from([0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, 1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6,
  3, 0, 4, 3, 4, 7]);

test("a cube has twelve edges, however its sides share corners", () => {
  assert.equal(sharpEdges(CUBE, SIDES).length, 2 * 12);
  const apart = Float32Array.from([...SIDES].flatMap((n) => [...CUBE.subarray(3 * n, 3 * n + 3)]));
  assert.equal(sharpEdges(apart, Uint32Array.from(SIDES, (_, i) => i)).length, 2 * 12);
});

test("borders are edges, and triangles without area have none", () => {
  assert.equal(sharpEdges(CUBE, SIDES.subarray(0, 6)).length, 2 * 4);
  assert.equal(sharpEdges(CUBE, Uint32Array.from([0, 0, 1])).length, 0);
});

// One shape of a single triangle with sides of 3 and 4 steps, twice in a step.
function exampleScene() {
  const fold = (steps) => steps.map((step) => step << 1);
  // Differences from the corner before: (0,0,0), (3,0,0), (3,4,0) − (3,0,0).
  const low = fold([0, 0, 0, 3, 0, 0, 0, 4, 0]);
  return new GuideScene({
    quantum: 0.5,
    shapes: [{ corners: 0, nodes: 3, first: 0, indices: 3 }],
    steps: [{ number: 1, view: [1, 0, 0], firstInstance: 0, instances: 2, firstGroup: 0, firstArrow: 0, arrows: 0,
      firstGoal: 0, goals: 1 }],
  }, {
    corners: Uint8Array.from([...low, ...low.map(() => 0)]),
    triangles: Uint32Array.of(0, 1, 2), thingShapes: Uint32Array.of(0, 0),
    thingPlaces: Float32Array.of(0, 0, 0, 10, 0, 0), instances: Uint32Array.of(0, 1),
    instanceGroups: Uint32Array.of(0, 1), groupOffsets: Float32Array.of(0, 0, 0, 0, 0, 5),
    groupRoles: Uint8Array.of(STANDING, ADDED), arrows: new Float32Array(0), goals: new Float32Array(9),
  });
}

test("shapes come in metres, with their places and roles", () => {
  const scene = exampleScene();
  assert.deepEqual([...scene.shapes[0].positions], [0, 0, 0, 1.5, 0, 0, 1.5, 2, 0]);
  const [first, second] = scene.instancesOf(scene.steps[0]);
  assert.equal(first.role, STANDING);
  assert.equal(second.role, ADDED);
  assert.deepEqual([...second.place], [10, 0, 0]);
  assert.equal(scene.goalsOf(scene.steps[0]).length, 9);
  assert.equal(scene.arrowsOf(scene.steps[0]).length, 0);
});

test("the box of a step holds its parts in their places and pulled apart", () => {
  const scene = exampleScene();
  assert.deepEqual(scene.boxOf(scene.steps[0]), [[0, 0, 0], [11.5, 2, 5]]);
});
