// What is looked at: a value for each parameter of the map, and how it is shown. The page's address has
// all of it behind the #, so that a link leads back.

// The parameters of a map, its structures, and the way from values to them.
export class DesignSpace {
  // parameters: MapParameter; structures: those of the page, each with `values` of the whole ones.
  constructor(parameters, structures) {
    this.parameters = parameters;
    this.structures = structures;
    this.wholes = parameters.map((p, i) => i).filter((i) => parameters[i].whole);
    this.numbers = parameters.map((p, i) => i).filter((i) => !parameters[i].whole);
  }

  // The values that a whole parameter has among the structures of the page, ascending.
  valuesOf(parameter) {
    const place = this.wholes.indexOf(parameter);
    return [...new Set(this.structures.map((s) => s.values[place]))].sort((a, b) => a - b);
  }

  // The design in the middle of the first structure.
  middle() {
    return this.parameters.map((p, i) =>
      p.whole ? this.structures[0].values[this.wholes.indexOf(i)] : (p.minimum + p.maximum) / 2);
  }

  // The structure with a design's whole numbers and choices; undefined where the page has none.
  structureOf(values) {
    return this.structures.find((s) => this.wholes.every((i, k) => s.values[k] === values[i]));
  }

  // The numbers of a design as a place in the unit box.
  placeOf(values) {
    return this.numbers.map((i) => {
      const { minimum, maximum } = this.parameters[i];
      return Math.min(1, Math.max(0, (values[i] - minimum) / (maximum - minimum)));
    });
  }

  // A value that the parameter may have, next to the one given.
  nearest(parameter, value) {
    const p = this.parameters[parameter];
    if (!p.whole) return Math.min(p.maximum, Math.max(p.minimum, value));
    return this.valuesOf(parameter).reduce((best, v) =>
      Math.abs(v - value) < Math.abs(best - value) ? v : best);
  }
}

// "#length=1.2&material=oak&view.field=stress" of a design and of how it is shown.
export function writeHash(space, values, view) {
  const pairs = space.parameters.map((p, i) =>
    [p.name, p.choices.length > 0 ? p.choices[values[i]] : String(values[i])]);
  for (const [name, value] of Object.entries(view)) {
    if (value !== "" && value !== null) pairs.push([`view.${name}`, String(value)]);
  }
  return "#" + pairs.map((pair) => pair.map(encodeURIComponent).join("=")).join("&");
}

// Reads what writeHash wrote. What it does not understand it passes over, and what is out of range it
// takes to the nearest that is not.
export function readHash(space, hash) {
  const values = space.middle();
  const view = {};
  for (const pair of hash.replace(/^#/, "").split("&")) {
    const [name, value] = pair.split("=").map(decodeOrKeep);
    if (value === undefined) continue;
    if (name.startsWith("view.")) {
      view[name.slice(5)] = value;
      continue;
    }
    const i = space.parameters.findIndex((p) => p.name === name);
    if (i < 0) continue;
    const choice = space.parameters[i].choices.indexOf(value);
    const number = choice >= 0 ? choice : value === "" ? NaN : Number(value);
    if (Number.isFinite(number)) values[i] = space.nearest(i, number);
  }
  return { values, view };
}

function decodeOrKeep(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}
