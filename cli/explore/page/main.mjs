// Reads the map that the page carries, and keeps its parts together: a change anywhere sets the design,
// and the design sets all that is shown.

import { DesignSpace, readHash, writeHash } from "./design_state.mjs";
import { makeControls, makeMetrics } from "./design_panel.mjs";
import { copy, designAsCsv, designAsJson, download } from "./downloads.mjs";
import { byId, element } from "../../../common/pages/modules/elements.mjs";
import { MapTree } from "./map_tree.mjs";
import { causesOf, notesOnShapes, reasonsOf, whyNoShape, whyNoValues } from "./missing_values.mjs";
import { digits, quantity, shownUnit, spoken } from "./number_format.mjs";
import { readPack } from "../../../common/pages/modules/packed_numbers.mjs";
import { holdTime, isSelfTest, runSelfTest } from "./self_test.mjs";
import { ShapePanel } from "./shape_panel.mjs";
import { coverageAlong, makeSlices, sliceAlong } from "./slices.mjs";
import { roundingOf, SurfaceShapes } from "./surface_shapes.mjs";

const faults = [];
window.addEventListener("error", (event) => fail(event.message));
window.addEventListener("unhandledrejection", (event) => fail(String(event.reason)));

function fail(what) {
  faults.push(what);
  byId("fault").textContent = `This page met a fault: ${what}`;
  byId("fault").hidden = false;
}

async function readStructure(map, structure) {
  const lists = await readPack(byId(structure.pack).textContent, structure.lists);
  const tree = new MapTree(lists, { dimension: structure.dimension, cubic: map.basis === "cubic",
    metrics: map.metrics.length });
  let shapes = null;
  if (structure.shapes) {
    const packed = byId(structure.shapes.pack);
    shapes = new SurfaceShapes(structure.shapes, await readPack(packed.textContent, structure.shapes.lists));
    packed.textContent = "";
  }
  return { values: structure.values, tree, shapes };
}

class Page {
  constructor(map, structures) {
    this.map = map;
    this.space = new DesignSpace(map.parameters, structures);
    this.controls = makeControls(this.space, (parameter, value) => this.change(parameter, value));
    byId("parameters").append(...this.controls.map(({ root }) => root));
    this.metrics = makeMetrics(map.metrics, byId("metrics"));
    this.slices = makeSlices(this.space, map.metrics, byId("slices"), (p, value) => this.change(p, value));
    this.panel = structures.some(({ shapes }) => shapes)
      ? new ShapePanel(map.fields, () => this.remember()) : null;
    const { values, view } = readHash(this.space, location.hash);
    this.values = values;
    this.panel?.restore(view);
    this.setTab(this.panel && view.tab !== "slices" ? "shape" : "slices");
    this.listen();
    this.update();
  }

  listen() {
    byId("tabs").hidden = this.panel === null;
    for (const tab of ["shape", "slices"]) {
      byId(`${tab}-tab`).addEventListener("click", () => {
        this.setTab(tab);
        this.update();
        this.remember();
      });
    }
    byId("copy-link").addEventListener("click", () => 
      this.copied("copy-link", location.href.split("#")[0] + this.hash()));
    byId("copy-json").addEventListener("click", () => this.copied("copy-json", this.asText(designAsJson)));
    byId("save-json").addEventListener("click", () =>
      download("design.json", "application/json", this.asText(designAsJson)));
    byId("save-csv").addEventListener("click", () =>
      download("design.csv", "text/csv", this.asText(designAsCsv)));
    byId("reset-design").addEventListener("click", () => {
      this.values = this.space.middle();
      this.update();
      this.remember();
    });
    window.addEventListener("hashchange", () => {
      if (isSelfTest(location.hash)) return;
      const { values, view } = readHash(this.space, location.hash);
      this.values = values;
      this.panel?.restore(view);
      this.update();
    });
  }

  asText(write) {
    return write(this.map, this.space, this.values, this.answer);
  }

  async copied(button, text) {
    await copy(text);
    const label = byId(button).textContent;
    byId(button).textContent = "copied";
    setTimeout(() => { byId(button).textContent = label; }, 1200);
  }

  setTab(tab) {
    this.tab = tab;
    for (const each of ["shape", "slices"]) {
      byId(`${each}-tab`).setAttribute("aria-selected", String(each === tab));
      byId(`${each}-view`).hidden = each !== tab;
    }
  }

  change(parameter, value) {
    this.values[parameter] = this.space.nearest(parameter, value);
    this.schedule();
  }

  // Moves of a slider that come at once make one.
  schedule() {
    this.waiting ??= setTimeout(() => {
      this.waiting = null;
      this.update();
      this.remember();
    });
  }

  // The page's address as it leads back to what is shown.
  hash() {
    const view = { ...this.panel?.state(), tab: this.panel && this.tab === "slices" ? "slices" : "" };
    return writeHash(this.space, this.values, view);
  }

  // Puts it into the address, once things rest: browsers take so many changes in a time, and no more.
  remember() {
    clearTimeout(this.remembering);
    this.remembering = setTimeout(() => history.replaceState(null, "", this.hash()), 300);
  }

  // Shows the design that `values` say.
  update() {
    const structure = this.space.structureOf(this.values);
    const place = this.space.placeOf(this.values);
    this.answer = structure ? structure.tree.evaluate(place) : null;
    this.controls.forEach((control, i) => control.show(this.values[i]));
    this.metrics.show(this.answer);
    byId("no-values").hidden = this.answer !== null;
    byId("stage").classList.toggle("uncovered", this.answer === null);
    this.space.numbers.forEach((i, d) =>
      this.controls[i].showGaps(structure ? coverageAlong(structure.tree, place, d) : []));
    if (structure && this.tab === "slices") {
      this.slices.show(place, this.answer, place.map((_, d) => sliceAlong(structure.tree, place, d)));
    }
    const isShapeWanted = this.panel !== null && this.tab === "shape";
    const hasShape = this.answer !== null && structure.shapes !== null && structure.shapes.has(structure.tree, place);
    byId("no-shape").hidden = !isShapeWanted || this.answer === null || hasShape;
    if (isShapeWanted) this.panel.show(structure, hasShape ? place : null);
  }
}

// What the map is of, and how far it may be trusted.
function describe(map) {
  document.title = `${map.title} – design map`;
  byId("title").textContent = map.title;
  byId("subtitle").textContent = [map.name, `revision ${map.revision}`, `${map.basis} basis`,
    `${map.evaluations} designs evaluated`, map.created].filter(Boolean).join(" · ");
  const notes = byId("notes");
  const note = (text, kind) => notes.append(element("li", { text, class: kind }));
  if (map.stale) note("The template has changed since: this map is of an earlier revision.", "warning");
  if (map.fixed.length > 0) {
    note("Fixed, in SI units: " +
      map.fixed.map(({ name, value }) => `${spoken(name)} ${digits(value)}`).join(", "));
  }
  note("± is how far a value may be off: what the map was off nearby, an estimate and no bound.");
  if (map.verification) {
    const { points, differences } = map.verification;
    note(`Held against ${points} designs that it had not seen, it was off at most ` +
      differences.map(({ metric, unit, largest }) =>
        `${quantity(largest, shownUnit(unit), 2)} of ${spoken(metric)}`).join(", "));
  }
  if (map.cutOff > 0) {
    note(`No values in ${map.cutOff} of ${map.elements} parts of the space (shaded), where ${causesOf(map)}:`);
    for (const { count, message } of reasonsOf(map)) note(`${count} × ${message}`, "failure");
  }
  if (map.shapes) {
    notesOnShapes(map).forEach((text, i) => note(text, i > 0 ? "failure" : undefined));
    const described = map.structures.map(({ shapes }) => shapes).filter(Boolean);
    const rounding = map.shapes.rounding + roundingOf(described);
    note(`Shapes were off at most ${quantity(map.shapes.largestError, shownUnit("m"), 2)} at the map's probes; ` +
      `positions are rounded by ${quantity(rounding, shownUnit("m"), 2)} at most` +
      `${map.shapes.designs ? ` (${digits(map.shapes.designs)} shapes)` : ""}.`);
  }
  byId("no-values-why").textContent = whyNoValues(map);
  if (map.shapeless > 0) byId("no-shape-why").textContent = whyNoShape(map);
}

async function start() {
  if (typeof DecompressionStream === "undefined") {
    fail("this browser is too old to unpack the map (it lacks DecompressionStream)");
    return;
  }
  const map = JSON.parse(byId("map").textContent);
  describe(map);
  const structures = await Promise.all(map.structures.map((structure) => readStructure(map, structure)));
  const page = new Page(map, structures);
  byId("waiting").hidden = true;
  if (!isSelfTest(location.hash)) return;
  await runSelfTest(location.hash, faults, (values) => {
    page.values = [...values];
    page.update();
  }, () => {
    const shape = page.panel?.shape;
    return { values: page.values, answer: page.answer,
      shape: shape ? page.panel.structure.shapes.positions(shape) : null };
  }, page.panel);
}

const release = isSelfTest(location.hash) ? holdTime() : () => {};
start().catch((reason) => fail(String(reason?.message ?? reason))).finally(release);
