// What the modules of the page of a map do without a browser. The rest of it is in
// tests/integration/cli/explore_page_test.cpp.
import assert from "node:assert/strict";
import { test } from "node:test";

import { rangeOf, colourRow } from "../../../../cli/explore/page/colour_scale.mjs";
import { Camera } from "../../../../common/pages/modules/camera.mjs";
import { DesignSpace, readHash, writeHash } from "../../../../cli/explore/page/design_state.mjs";
import { designAsCsv, designAsJson } from "../../../../cli/explore/page/downloads.mjs";
import { causesOf, notesOnShapes, reasonsOf, whyNoShape, whyNoValues } from "../../../../cli/explore/page/missing_values.mjs";
import { MapTree } from "../../../../cli/explore/page/map_tree.mjs";
import { digits, digitsWithin, quantity, shownUnit, spoken } from "../../../../cli/explore/page/number_format.mjs";
import { unfoldSteps } from "../../../../common/pages/modules/packed_numbers.mjs";
import { edgesOf, mostOf, roundingOf, scalarsOf, smoothNormals } from "../../../../cli/explore/page/surface_shapes.mjs";

const PARAMETERS = [
  { name: "material", unit: "", minimum: 0, maximum: 2, whole: true, choices: ["oak", "ash", "a&b=c"] },
  { name: "length", unit: "m", minimum: 1, maximum: 3, whole: false, choices: [] },
];

function exampleSpace() {
  return new DesignSpace(PARAMETERS, [{ values: [0] }, { values: [2] }]);
}

// Two elements of one number, split in the middle: the value is 0 at the ends and 1 there.
function exampleTree() {
  return new MapTree({
    directions: [0, -1, -1], children: [1, 0, 1], coarsestLevels: [1, 1], finestLevels: [1, 1],
    cutOff: [0, 1], errors: Float64Array.of(0.25, 9), levels: [1, 1, 1], centres: [0, 1, 2], sampleCounts: [1, 1, 1],
    samples: [0, 2, 1], weights: [1, 1, 1], values: [0, 0, 1],
  }, { dimension: 1, cubic: false, metrics: 1 });
}

test("numbers are written as people write them", () => {
  assert.equal(digits(0.123456), "0.1235");
  assert.equal(digits(1250), "1250");
  assert.equal(digits(-0.5), "−0.5");
  assert.equal(digits(1.5e9), "1.5e9");
  assert.equal(digits(2e-7, 2), "2e−7");
  assert.equal(digits(0), "0");
  assert.equal(digits(NaN), "–");
  assert.equal(digitsWithin(1e-9, 2), "0");
  assert.equal(quantity(1.2, shownUnit("m")), "1200 mm");
  assert.equal(quantity(2.5e7, shownUnit("Pa")), "25 MPa");
  assert.equal(quantity(25, shownUnit("Pa", 30)), "25 Pa");
  assert.equal(quantity(2, shownUnit("kg/m3")), "2 kg/m³");
  assert.equal(spoken("max_von_mises"), "max von Mises");
});

test("an address leads back to its design", () => {
  const space = exampleSpace();
  const values = [2, 1.2345678901234567];
  const hash = writeHash(space, values, { field: "von_mises", edges: "" });
  assert.deepEqual(readHash(space, hash), { values, view: { field: "von_mises" } });
});

test("what an address says wrongly is taken to what there is", () => {
  const space = exampleSpace();
  assert.deepEqual(readHash(space, "").values, [0, 2]);
  assert.deepEqual(readHash(space, "#length=99&material=ash&%ZZ&width=1").values, [0, 3]);
  assert.deepEqual(readHash(space, "#length=oops&length&material=").values, [0, 2]);
});

test("a design belongs to the structure of its whole numbers", () => {
  const space = exampleSpace();
  assert.equal(space.structureOf([2, 1]), space.structures[1]);
  assert.equal(space.structureOf([1, 1]), undefined);
  assert.deepEqual(space.placeOf([2, 1.5]), [0.25]);
});

test("a tree is interpolated, and has no values where it is cut off", () => {
  const tree = exampleTree();
  const answer = tree.evaluate([0.25]);
  assert.equal(answer.values[0], 0.5);
  assert.equal(answer.errors[0], 0.25);
  assert.deepEqual(tree.weightsAt([0.25]), [[0, 0.5], [2, 0.5]]);
  assert.equal(tree.evaluate([0.5]), null);
  assert.equal(tree.evaluate([1]), null);
});

test("why there are no values is told of evaluations and of shapes", () => {
  const failures = [{ count: 4, message: "the neck closes" }];
  const unmappedFailures = [{ count: 2, message: "has a hole more" }];
  const failed = { failures, unmapped: 0, shapeless: 0, unmappedFailures: [] };
  assert.equal(causesOf(failed), "evaluations failed");
  assert.equal(whyNoValues(failed), "Around this design evaluations failed, as: the neck closes");
  // As earlier versions built maps.
  const unmapped = { failures: [], unmapped: 3, shapeless: 0, unmappedFailures };
  assert.equal(causesOf(unmapped), "shapes could not be brought into one mesh");
  assert.deepEqual(reasonsOf(unmapped), unmappedFailures);
  assert.match(whyNoValues(unmapped), /^Around this design shapes .*, as: has a hole more$/);
  const both = { failures, unmapped: 3, shapeless: 0, unmappedFailures: [] };
  assert.equal(causesOf(both), "evaluations failed or shapes could not be brought into one mesh");
  assert.deepEqual(reasonsOf(both).map(({ count }) => count), [4, 3]);
});

test("why there are no shapes is told beside the metrics", () => {
  const map = { failures: [{ count: 4, message: "the neck closes" }], unmapped: 3, shapeless: 2, elements: 9,
    unmappedFailures: [{ count: 2, message: "has a hole more" }] };
  assert.equal(causesOf(map), "evaluations failed");
  assert.deepEqual(reasonsOf(map), map.failures);
  assert.match(whyNoShape(map), /one mesh, as: has a hole more\. The metrics are valid\.$/);
  assert.match(notesOnShapes(map)[0], /^No shape in 2 of 9 parts .* metrics are valid there:$/);
  assert.deepEqual(notesOnShapes(map).slice(1), ["2 × has a hole more"]);
  assert.deepEqual(notesOnShapes({ ...map, shapeless: 0 }), []);
});

test("steps unfold to what was folded", () => {
  // Differences 1, −1, 32767 and 3 of numbers 1 apart.
  const bytes = Uint8Array.from([2, 1, 254, 6, 0, 0, 255, 0]);
  assert.deepEqual([...unfoldSteps(bytes, 0, 4, null, 1)], [1, 0, 32767, 32770]);
  assert.deepEqual([...unfoldSteps(bytes, 0, 4, [10, 20, 30, 65535], 1)], [11, 19, 32797, 2]);
});

test("a design is told to other programs", () => {
  const space = exampleSpace();
  const map = { name: "maps/m", subject: "templates/t", revision: 3, fixed: [{ name: "depth", value: 2 }],
    metrics: [{ name: "mass", unit: "kg" }] };
  const answer = { values: [1.5], errors: [0.1] };
  assert.deepEqual(JSON.parse(designAsJson(map, space, [2, 1.5], answer)), {
    map: "maps/m", subject: "templates/t", revision: 3,
    design: { material: "a&b=c", length: 1.5, depth: 2 },
    metrics: { mass: { value: 1.5, error: 0.1, unit: "kg" } } });
  assert.deepEqual(JSON.parse(designAsJson(map, space, [2, 1.5], null)).metrics, { mass: null });
  assert.equal(designAsCsv(map, space, [0, 1.5], answer),
    "material,length,mass [kg],mass error [kg]\r\noak,1.5,1.5,0.1\r\n");
  assert.match(designAsCsv(map, space, [0, 1.5], null), /oak,1.5,,\r\n$/);
});

test("fields become one number of each node", () => {
  const vector = Float32Array.from([3, 0, 4, 0, -2, 0]);
  assert.deepEqual([...scalarsOf(vector, 3, "magnitude")], [5, 2]);
  assert.deepEqual([...scalarsOf(vector, 3, "y")], [0, -2]);
  // Pure tension, then pure shear.
  const stress = Float32Array.from([7, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0]);
  const mises = scalarsOf(stress, 6, "von Mises");
  assert.ok(Math.abs(mises[0] - 7) < 1e-6 && Math.abs(mises[1] - 2 * Math.sqrt(3)) < 1e-6);
  assert.deepEqual([...scalarsOf(stress, 6, "xy")], [0, 2]);
  assert.deepEqual(mostOf(Float32Array.from([-1e6, ...Array.from({ length: 399 }, (_, i) => i), 1e6])), [1, 397]);
});

test("positions are rounded by half a step of the coarsest mesh", () => {
  const of = (...steps) => ({ meshes: steps.map((step) => ({ step })) });
  assert.equal(roundingOf([of([2, 4, 4], [0, 0, 0]), of([0, 3, 4])]), 3);
  assert.equal(roundingOf([]), 0);
});

test("a surface has the normals and edges of its triangles", () => {
  const positions = Float32Array.from([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]);
  const triangles = Uint32Array.from([0, 1, 2, 0, 2, 3]);
  assert.deepEqual([...smoothNormals(positions, triangles)], [0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1]);
  assert.equal(edgesOf(triangles, 4).length, 2 * 5);
});

test("colours are even around zero where numbers lie on both sides", () => {
  assert.deepEqual(rangeOf(-1, 3, true), [-3, 3]);
  assert.deepEqual(rangeOf(2, 3, false), [2, 3]);
  const [low, high] = rangeOf(5, 5, false);
  assert.ok(low < high);
  assert.deepEqual([...colourRow(false).slice(0, 4)], [0x44, 0x01, 0x54, 255]);
});

test("the camera sees all of a box from all around", () => {
  const camera = new Camera();
  for (const [yaw, pitch, aspect] of [[0, 0, 1.6], [1, 0, 1.6], [4, 0, 0.5], [2.2, -0.2, 1]]) {
    camera.reset([[-1, 0, 2], [3, 1, 4]]);
    camera.orbit(yaw, pitch);
    const { view, projection } = camera.matrices(aspect);
    const times = (m, v) => [0, 1, 2, 3].map((r) => v.reduce((sum, x, c) => sum + m[4 * c + r] * x, 0));
    for (const x of [-1, 3]) for (const y of [0, 1]) for (const z of [2, 4]) {
      const [px, py, pz, w] = times(projection, times(view, [x, y, z, 1]));
      for (const p of [px, py, pz]) assert.ok(Math.abs(p) <= w, `${p} ${w}`);
    }
  }
});
