// Colours of numbers: one scale for what grows from one end (viridis: even to the eye, readable without
// red and green), one for what lies on both sides of zero.

const GROWING = ["#440154", "#482878", "#3e4a89", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6ece58",
  "#b5de2b", "#fde725"];
const SIGNED = ["#2c3fb0", "#5977e3", "#8db0fe", "#b9d0f9", "#dddddd", "#f5c4ac", "#f4987a", "#dd5f4b",
  "#b40426"];

function channels(colour) {
  return [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
}

// `count` colours in a row, 4 bytes each, as a texture has them.
export function colourRow(signed, count = 256) {
  const stops = (signed ? SIGNED : GROWING).map(channels);
  const row = new Uint8Array(4 * count);
  for (let i = 0; i < count; ++i) {
    const at = i / (count - 1) * (stops.length - 1);
    const stop = Math.min(Math.floor(at), stops.length - 2);
    for (let c = 0; c < 3; ++c) {
      row[4 * i + c] = Math.round(stops[stop][c] + (at - stop) * (stops[stop + 1][c] - stops[stop][c]));
    }
    row[4 * i + 3] = 255;
  }
  return row;
}

export function cssGradient(signed) {
  return `linear-gradient(to right, ${(signed ? SIGNED : GROWING).join(", ")})`;
}

// The range of colours for numbers from `low` to `high`: even around zero where they lie on both sides.
export function rangeOf(low, high, signed) {
  if (signed) {
    const end = Math.max(Math.abs(low), Math.abs(high)) || 1;
    return [-end, end];
  }
  return high > low ? [low, high] : [low, low + (Math.abs(low) || 1)];
}
