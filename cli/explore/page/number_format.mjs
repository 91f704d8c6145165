// Numbers with units, for people: as the commands of `mortise` write them, lengths in millimetres and
// stresses in megapascals.

const SHOWN = {
  m: { unit: "mm", factor: 1e3 },
  "m/m": { unit: "", factor: 1 },
  Pa: { unit: "MPa", factor: 1e-6 },
  1: { unit: "", factor: 1 },
};
const SUPERSCRIPTS = { 2: "²", 3: "³", 4: "⁴" };

// How numbers of an SI unit are shown: their unit, and what they are multiplied by for it. Stresses that
// are small all over (`largest`) stay in Pa.
export function shownUnit(unit, largest = Infinity) {
  if (unit === "Pa" && Math.abs(largest) < 1e4) return { unit: "Pa", factor: 1 };
  return SHOWN[unit] ?? { unit: unit.replace(/([a-z])([234])/g, (_, u, n) => u + SUPERSCRIPTS[n]), factor: 1 };
}

// A number with as many significant digits: 0.1235, 12.35, 1.235e+9.
export function digits(value, count = 4) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const magnitude = Math.floor(Math.log10(Math.abs(value)));
  if (magnitude < -4 || magnitude > 6) {
    return value.toExponential(count - 1).replace(/\.?0+e/, "e").replace("e+", "e").replace("-", "−");
  }
  const decimals = Math.max(0, count - 1 - magnitude);
  return value.toFixed(decimals).replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, "").replace("-", "−");
}

// The same of a number of a range: what is nothing within it is 0.
export function digitsWithin(value, range, count = 3) {
  return digits(Math.abs(value) < 0.5 * range * 10 ** -count ? 0 : value, count);
}

export function quantity(value, shown, count = 4) {
  const text = digits(value * shown.factor, count);
  return shown.unit === "" ? text : `${text} ${shown.unit}`;
}

// "max_von_mises" as people write it: "max von Mises".
export function spoken(name) {
  return name.replaceAll("_", " ").replace(/\bvon mises\b/, "von Mises");
}
