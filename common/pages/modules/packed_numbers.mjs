// Numbers as a page carries them: a pack is a text of base64, of bytes packed by gzip, which hold
// several lists one after another. common/pages/number_pack.h writes them.

const TYPES = { f64: Float64Array, f32: Float32Array, i32: Int32Array, u32: Uint32Array, u16: Uint16Array,
  u8: Uint8Array };

async function unpackBytes(text) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < bytes.length; ++i) bytes[i] = letters.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

// Returns the lists of a pack by their names. `lists`: {name: {type, offset, length}}.
export async function readPack(text, lists) {
  const bytes = await unpackBytes(text);
  const read = {};
  for (const [name, { type, offset, length }] of Object.entries(lists)) {
    read[name] = new TYPES[type](bytes, offset, length);
  }
  return read;
}

// Undoes what number_pack.h does to steps of 16 bits before they are packed: low bytes stand before
// high ones, of differences from `base` (or, without one, from the number `stride` before), of which
// the sign is in the lowest bit.
export function unfoldSteps(bytes, first, count, base, stride) {
  const steps = new Uint16Array(count);
  for (let i = 0; i < count; ++i) {
    const folded = bytes[first + i] | (bytes[first + count + i] << 8);
    const difference = (folded >>> 1) ^ -(folded & 1);
    const from = base !== null ? base[i] : i >= stride ? steps[i - stride] : 0;
    steps[i] = from + difference;
  }
  return steps;
}
