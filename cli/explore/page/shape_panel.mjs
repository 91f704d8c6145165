// The picture of the shape with its controls and its legend.

import { Camera, steer } from "../../../common/pages/modules/camera.mjs";
import { cssGradient, rangeOf } from "./colour_scale.mjs";
import { byId, element } from "../../../common/pages/modules/elements.mjs";
import { digits, digitsWithin, quantity, shownUnit, spoken } from "./number_format.mjs";
import { boxOf, edgesOf, extremes, mostOf, scalarsOf, showable, smoothNormals } from "./surface_shapes.mjs";
import { SurfaceView } from "./surface_view.mjs";

const TICKS = 5;
const MOST_DEFORMATION = 0.1;  // of the shape's size, of what is deformed by default

// Names of fields once each, in their order.
function namesOf(fields) {
  return [...new Set(fields.map((field) => field.name))];
}

function setOptions(list, options, wanted) {
  list.replaceChildren(...options.map(([value, text]) => element("option", { value, text })));
  list.value = options.some(([value]) => value === wanted) ? wanted : options[0]?.[0] ?? "";
}

export class ShapePanel {
  // fields: those of the page. changed() is called when a person has changed how the shape is shown.
  constructor(fields, changed) {
    this.fields = fields;
    this.changed = changed;
    this.view = SurfaceView.create(byId("canvas"));
    byId("no-webgl").hidden = this.view !== null;
    if (!this.view) return;
    this.camera = new Camera();
    const redraw = () => this.draw();
    const reset = () => {
      if (this.positions) this.camera.reset(boxOf(this.positions));
      redraw();
    };
    steer(byId("canvas"), this.camera, redraw, reset);
    byId("reset-view").addEventListener("click", reset);
    for (const id of ["field", "load-case", "component", "colour-range", "smooth", "edges"]) {
      byId(id).addEventListener("change", () => this.choose());
    }
    byId("deformation").addEventListener("input", () => this.choose());
    new ResizeObserver(redraw).observe(byId("canvas"));
    window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  }

  // Sets the controls as the page's address says.
  restore(wanted) {
    if (!this.view) return;
    const names = namesOf(this.fields);
    setOptions(byId("field"), [["", "shape alone"], ...names.map((name) => [name, spoken(name)])],
      wanted.field ?? names.find((name) => name.includes("von_mises")) ?? names[0]);
    byId("colour-range").value = ["map", "most"].includes(wanted.range) ? wanted.range : "design";
    byId("smooth").checked = wanted.smooth === "1";
    byId("edges").checked = wanted.edges === "1";
    byId("deformation").value = wanted.deformation ?? "0";
    this.offer(wanted.case, wanted.component);
  }

  // The load cases and components that the chosen field has.
  offer(loadCase = byId("load-case").value, component = byId("component").value) {
    const offered = this.fields.filter((field) => field.name === byId("field").value);
    setOptions(byId("load-case"), offered.map((f) => [f.loadCase, spoken(f.loadCase || "–")]), loadCase);
    const parts = offered.length > 0 ? showable(offered[0].components) : [];
    setOptions(byId("component"), parts.map((part) => [part, part]), component);
    byId("load-case").parentElement.hidden = offered.length < 2;
    byId("component").parentElement.hidden = parts.length === 0;
    byId("colour-range").parentElement.hidden = offered.length === 0;
    byId("deformation").parentElement.hidden = this.displacement() < 0;
  }

  // The place of the field that deforms what is shown: of the load case that is chosen, else of the first.
  displacement() {
    const name = byId("field").value === "mode_shape" ? "mode_shape" : "displacement";
    const all = this.fields.map((_, i) => i).filter((i) =>
      this.fields[i].name === name && this.fields[i].components === 3);
    return all.find((i) => this.fields[i].loadCase === byId("load-case").value) ?? all[0] ?? -1;
  }

  choose() {
    this.offer();
    this.update();
    this.changed();
  }

  // How the shape is shown, as the page's address has it.
  state() {
    if (!this.view) return {};
    return {
      field: byId("field").value, case: byId("load-case").value, component: byId("component").value,
      range: byId("colour-range").value, smooth: byId("smooth").checked ? "1" : "",
      edges: byId("edges").checked ? "1" : "",
      deformation: byId("deformation").value === "0" ? "" : byId("deformation").value,
    };
  }

  // Shows the shape at a place of a structure, {tree, shapes}; where `place` is null, nothing.
  show(structure, place) {
    if (!this.view) return;
    this.structure = structure;
    this.element = place === null ? -1 : structure.tree.locate(place);
    this.shape = place === null ? null : structure.shapes.at(structure.tree, place);
    this.update();
  }

  update() {
    byId("legend").hidden = true;
    byId("shape-error").textContent = "";
    this.view.shape = null;
    this.positions = null;
    if (this.shape) this.prepare();
    this.draw();
  }

  prepare() {
    const { shapes } = this.structure;
    const { mesh } = this.shape;
    mesh.edges ??= edgesOf(mesh.triangles, mesh.nodes);
    this.positions = shapes.positions(this.shape);
    if (!this.framed) this.camera.frame(boxOf(this.positions));
    this.framed = true;
    this.deform();
    this.view.setMesh(mesh);
    this.view.setShape(this.positions, smoothNormals(this.positions, mesh.triangles));
    this.colour();
    this.tellErrors();
  }

  // Moves nodes by the displacement, as many times as the slider says: its middle moves the farthest node
  // by a part of the shape's size.
  deform() {
    const number = this.displacement();
    const share = Number(byId("deformation").value) / 100;
    const output = byId("deformation-scale");
    output.textContent = "off";
    if (number < 0 || share === 0) return;
    const moved = this.structure.shapes.field(this.shape, number);
    if (!moved) return;
    const field = this.fields[number];
    const largest = Math.max(Math.abs(field.minimum), Math.abs(field.maximum)) || 1;
    const scale = share * MOST_DEFORMATION * this.camera.size / largest;
    this.positions = this.positions.map((p, i) => p + scale * moved[i]);
    output.textContent = `× ${digits(scale, 3)}`;
  }

  colour() {
    const field = this.fields.findIndex((f) => f.name === byId("field").value &&
      f.loadCase === byId("load-case").value);
    const values = field < 0 ? null : this.structure.shapes.field(this.shape, field);
    if (!values) {
      this.view.setScalars(null, [0, 1], false);
      return;
    }
    const { components, minimum, maximum } = this.fields[field];
    const part = byId("component").value;
    const scalars = scalarsOf(values, components, part);
    const [low, high] = extremes(scalars);
    const ends = { map: () => mapEnds(this.fields[field], part), most: () => mostOf(scalars),
      design: () => [low, high] }[byId("colour-range").value]();
    const signed = ends[0] < 0 && ends[1] > 0 && (components > 1 || minimum < 0);
    const range = rangeOf(...ends, signed);
    this.view.setScalars(scalars, range, signed);
    this.tellColours(this.fields[field], part, range, signed, [low, high],
      Math.max(Math.abs(minimum), Math.abs(maximum)));
  }

  tellColours(field, part, range, signed, [low, high], largest) {
    const shown = shownUnit(field.unit, largest);
    byId("legend").hidden = false;
    byId("legend-title").textContent = [spoken(field.name), part].filter(Boolean).join(", ");
    byId("legend-case").textContent = field.loadCase && spoken(field.loadCase);
    byId("legend-bar").style.background = cssGradient(signed);
    const width = (range[1] - range[0]) * shown.factor;
    const text = (value) => digitsWithin(value * shown.factor, width);
    const unit = shown.unit && ` ${shown.unit}`;
    byId("legend-ticks").replaceChildren(...Array.from({ length: TICKS }, (_, i) => element("span",
      { text: text(range[0] + i / (TICKS - 1) * (range[1] - range[0])) + (i === TICKS - 1 ? unit : "") })));
    byId("legend-extremes").textContent = byId("colour-range").value === "design" && !signed ? ""
      : `this design: ${text(low)} to ${text(high)}${unit}`;
  }

  // How far the shape and the field may be off.
  tellErrors() {
    const { shapeErrors, fieldErrors, cutOff } = this.structure.tree.arrays;
    const elements = cutOff.length;
    const parts = [];
    const length = shownUnit("m");
    if (shapeErrors.length > 0) {
      parts.push(`shape ± ${quantity(shapeErrors[this.element], length, 2)}`);
    }
    this.fields.forEach((field, f) => {
      if (fieldErrors.length !== elements * this.fields.length || field.name !== byId("field").value ||
        field.loadCase !== byId("load-case").value) return;
      const shown = shownUnit(field.unit, Math.max(Math.abs(field.minimum), Math.abs(field.maximum)));
      const error = fieldErrors[this.element * this.fields.length + f];
      parts.push(`${spoken(field.name)} ± ${quantity(error, shown, 2)}`);
    });
    byId("shape-error").textContent = parts.join(", ");
  }

  draw() {
    const style = getComputedStyle(document.documentElement);
    const colourOf = (name) => [1, 3, 5].map((at) =>
      parseInt(style.getPropertyValue(name).trim().slice(at, at + 2), 16) / 255);
    this.view.draw(this.camera, { smoothly: byId("smooth").checked, edges: byId("edges").checked,
      plain: colourOf("--plain"), line: colourOf("--line") });
  }
}

// The ends of what is shown of a field over the whole map. Of the length of a vector and of the stress of
// a tensor the components' largest tells no more than an end.
function mapEnds(field, part) {
  if (field.components === 1) return [field.minimum, field.maximum];
  const largest = Math.max(Math.abs(field.minimum), Math.abs(field.maximum));
  return part === "magnitude" || part === "von Mises" ? [0, largest] : [-largest, largest];
}
