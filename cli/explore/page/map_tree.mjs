// Interpolates on the map of one structure, as common/maps does: P(x) = Σ q φ(x) over the active
// B-splines of the K-d tree (docs/maps.md). Numbers are those of MapTree in interpolator.proto.

const MOST_EXACT = Number.MAX_SAFE_INTEGER;

// A B-spline along one direction at `offset` distances from its centre.
function linearSpline(offset) {
  const distance = Math.abs(offset);
  return distance < 1 ? 1 - distance : 0;
}

function cubicSpline(offset) {
  const distance = Math.abs(offset);
  if (distance >= 2) return 0;
  if (distance >= 1) return (2 - distance) ** 3 / 6;
  return 2 / 3 - distance * distance * (1 - distance / 2);
}

// Which active B-spline has a centre. Centres of a level are numbers as long as those are exact, else
// texts.
class CentreIndex {
  constructor(dimension) {
    this.dimension = dimension;
    this.levels = new Map();
  }

  add(level, centres, first, spline) {
    if (!this.levels.has(level)) this.levels.set(level, new Map());
    this.levels.get(level).set(this.key(level, centres, first), spline);
  }

  find(level, centre) {
    return this.levels.get(level)?.get(this.key(level, centre, 0));
  }

  key(level, centres, first) {
    // Centres of a cubic B-spline may lie one distance outside of the box.
    const base = 2 ** level + 3;
    if (base ** this.dimension > MOST_EXACT) {
      return Array.from(centres.slice(first, first + this.dimension)).join(" ");
    }
    let key = 0;
    for (let d = 0; d < this.dimension; ++d) key = key * base + centres[first + d] + 1;
    return key;
  }
}

export class MapTree {
  // arrays: the lists of a MapTree as typed arrays, by name. `metrics`: how many there are of them.
  constructor(arrays, { dimension, cubic, metrics }) {
    this.arrays = arrays;
    this.dimension = dimension;
    this.metrics = metrics;
    this.reach = cubic ? 2 : 1;
    this.spline = cubic ? cubicSpline : linearSpline;
    this.index = new CentreIndex(dimension);
    this.firstParts = new Int32Array(arrays.levels.length + 1);
    for (let s = 0; s < arrays.levels.length; ++s) {
      this.firstParts[s + 1] = this.firstParts[s] + arrays.sampleCounts[s];
      this.index.add(arrays.levels[s], arrays.centres, s * dimension, s);
    }
    this.coefficients = cubic ? arrays.coefficients : this.linearCoefficients();
  }

  linearCoefficients() {
    const { values, samples, weights } = this.arrays;
    const splines = this.arrays.levels.length;
    const coefficients = new Float64Array(splines * this.metrics);
    for (let s = 0; s < splines; ++s) {
      for (let part = this.firstParts[s]; part < this.firstParts[s + 1]; ++part) {
        for (let m = 0; m < this.metrics; ++m) {
          coefficients[s * this.metrics + m] +=
            weights[part] * values[samples[part] * this.metrics + m];
        }
      }
    }
    return coefficients;
  }

  // The number of the element that a place in the unit box lies in. Of two that share it, the upper.
  locate(place) {
    const low = new Float64Array(this.dimension);
    const high = new Float64Array(this.dimension).fill(1);
    let node = 0;
    for (;;) {
      const d = this.arrays.directions[node];
      if (d < 0) return this.arrays.children[node];
      const middle = (low[d] + high[d]) / 2;
      if (place[d] >= middle) {
        low[d] = middle;
        node = this.arrays.children[node] + 1;
      } else {
        high[d] = middle;
        node = this.arrays.children[node];
      }
    }
  }

  isCutOff(element) {
    return this.arrays.cutOff[element] !== 0;
  }

  // Calls visit(B-spline, its value) for all that are active at the place, which lies in the element.
  forEachActive(element, place, visit) {
    const K = this.dimension;
    const width = 2 * this.reach;
    const factors = new Float64Array(K * width);
    const first = new Int32Array(K);
    const centre = new Int32Array(K);
    const { coarsestLevels, finestLevels } = this.arrays;
    for (let level = coarsestLevels[element]; level <= finestLevels[element]; ++level) {
      const cells = 2 ** level;
      for (let d = 0; d < K; ++d) {
        const scaled = place[d] * cells;
        first[d] = Math.min(Math.floor(scaled), cells - 1) - this.reach + 1;
        for (let n = 0; n < width; ++n) {
          factors[d * width + n] = this.spline(scaled - (first[d] + n));
        }
      }
      const descend = (d, factor) => {
        if (factor === 0) return;
        if (d === K) {
          const spline = this.index.find(level, centre);
          if (spline !== undefined) visit(spline, factor);
          return;
        }
        for (let n = 0; n < width; ++n) {
          centre[d] = first[d] + n;
          descend(d + 1, factor * factors[d * width + n]);
        }
      };
      descend(0, 1);
    }
  }

  // Metrics at a place in the unit box, and how far each may be off there (of the element, an estimate);
  // null where the map has no values.
  evaluate(place) {
    const element = this.locate(place);
    if (this.isCutOff(element)) return null;
    const values = new Float64Array(this.metrics);
    this.forEachActive(element, place, (spline, factor) => {
      for (let m = 0; m < this.metrics; ++m) {
        values[m] += factor * this.coefficients[spline * this.metrics + m];
      }
    });
    const first = element * this.metrics;
    return { element, values, errors: this.arrays.errors.subarray(first, first + this.metrics) };
  }

  // The samples that act at a place and how much of each (ψ_k): [sample, weight] pairs. Of linear maps.
  weightsAt(place) {
    const { samples, weights } = this.arrays;
    const sums = new Map();
    this.forEachActive(this.locate(place), place, (spline, factor) => {
      for (let part = this.firstParts[spline]; part < this.firstParts[spline + 1]; ++part) {
        const sample = samples[part];
        sums.set(sample, (sums.get(sample) ?? 0) + factor * weights[part]);
      }
    });
    return [...sums].filter(([, weight]) => weight !== 0);
  }
}
