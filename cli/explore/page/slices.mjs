// How each metric changes with each number while the others stay: small plots through the design that is
// looked at, with how far the map may be off, and gaps where it has no values.

import { drawn, element } from "../../../common/pages/modules/elements.mjs";
import { digits, quantity, shownUnit, spoken } from "./number_format.mjs";

const POINTS = 41;
const WIDTH = 160, HEIGHT = 72;

// What the map says along one number: {places: shares of its range, answers: as MapTree.evaluate}.
export function sliceAlong(tree, place, direction, points = POINTS) {
  const at = [...place];
  const places = Array.from({ length: points }, (_, i) => i / (points - 1));
  return { places, answers: places.map((share) => {
    at[direction] = share;
    return tree.evaluate(at);
  }) };
}

// At which places along one number the map has values.
export function coverageAlong(tree, place, direction, points = POINTS) {
  const at = [...place];
  return Array.from({ length: points }, (_, i) => {
    at[direction] = i / (points - 1);
    return !tree.isCutOff(tree.locate(at));
  });
}

// One plot: follows the pointer with choose(share of the range).
function makePlot(label, choose) {
  const band = drawn("path", { class: "band" });
  const line = drawn("path", { class: "line" });
  const gaps = drawn("path", { class: "gap" });
  const rule = drawn("line", { class: "rule", y1: 0, y2: HEIGHT });
  const dot = drawn("path", { class: "dot" });
  const root = drawn("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: "none", role: "img",
    "aria-label": label }, gaps, band, line, rule, dot);
  const follow = (event) => {
    const box = root.getBoundingClientRect();
    choose(Math.min(1, Math.max(0, (event.clientX - box.left) / box.width)));
  };
  root.addEventListener("pointerdown", (event) => {
    root.setPointerCapture(event.pointerId);
    follow(event);
  });
  root.addEventListener("pointermove", (event) => {
    if (event.buttons & 1) follow(event);
  });
  return { root, band, line, gaps, rule, dot };
}

// Paths of a metric along a slice; numbers are scaled by heightOf.
function draw(plot, slice, metric, heightOf) {
  let line = "", band = "", gaps = "";
  let run = [];
  const flush = () => {
    if (run.length === 0) return;
    const points = run.map(({ x, value }) => `${x.toFixed(1)},${heightOf(value).toFixed(1)}`);
    const above = run.map(({ x, value, error }) => `${x.toFixed(1)},${heightOf(value + error).toFixed(1)}`);
    const below = run.map(({ x, value, error }) => `${x.toFixed(1)},${heightOf(value - error).toFixed(1)}`);
    line += `M${points.join("L")}`;
    band += `M${above.join("L")}L${below.reverse().join("L")}Z`;
    run = [];
  };
  const step = WIDTH / (slice.places.length - 1);
  slice.places.forEach((share, i) => {
    const answer = slice.answers[i];
    if (answer !== null) {
      run.push({ x: share * WIDTH, value: answer.values[metric], error: answer.errors[metric] });
      return;
    }
    flush();
    gaps += `M${share * WIDTH - step / 2},0h${step}v${HEIGHT}h${-step}Z`;
  });
  flush();
  plot.line.setAttribute("d", line);
  plot.band.setAttribute("d", band);
  plot.gaps.setAttribute("d", gaps);
}

// The table of all plots: show(place, answer, slices) draws them, `slices` one of each number.
export function makeSlices(space, metrics, root, change) {
  const head = element("div", { class: "slice-row slice-head" }, element("span"),
    ...space.numbers.map((i) => element("span", { text: spoken(space.parameters[i].name) })));
  const rows = metrics.map((metric) => {
    const largest = Math.max(Math.abs(metric.minimum), Math.abs(metric.maximum));
    const shown = shownUnit(metric.unit, largest);
    const plots = space.numbers.map((i) => {
      const parameter = space.parameters[i];
      return makePlot(`${spoken(metric.name)} over ${spoken(parameter.name)}`, (share) =>
        change(i, parameter.minimum + share * (parameter.maximum - parameter.minimum)));
    });
    const top = element("span", { text: quantity(metric.maximum, shown, 3) });
    const bottom = element("span", { text: digits(metric.minimum * shown.factor, 3) });
    const row = element("div", { class: "slice-row" },
      element("div", { class: "slice-name" }, element("strong", { text: spoken(metric.name) }), top, bottom),
      ...plots.map((plot) => plot.root));
    return { metric, plots, row };
  });
  const foot = element("div", { class: "slice-row slice-foot" }, element("span"),
    ...space.numbers.map((i) => {
      const { minimum, maximum, unit } = space.parameters[i];
      const shown = shownUnit(unit);
      return element("span", {}, element("span", { text: digits(minimum * shown.factor) }),
        element("span", { text: quantity(maximum, shown) }));
    }));
  root.style.setProperty("--plots", space.numbers.length);
  root.style.setProperty("--rows", Math.max(1, metrics.length));
  root.append(head, ...rows.map(({ row }) => row), foot);
  return {
    show(place, answer, slices) {
      rows.forEach(({ metric, plots }, m) => {
        const range = metric.maximum - metric.minimum || Math.abs(metric.maximum) || 1;
        const heightOf = (value) => {
          const share = (value - metric.minimum) / range;
          return HEIGHT - 6 - (HEIGHT - 12) * Math.min(1.08, Math.max(-0.08, share));
        };
        plots.forEach((plot, k) => {
          draw(plot, slices[k], m, heightOf);
          for (const end of ["x1", "x2"]) plot.rule.setAttribute(end, place[k] * WIDTH);
          plot.dot.setAttribute("visibility", answer ? "visible" : "hidden");
          if (!answer) return;
          // A line without length has round ends, whatever the plot is stretched to.
          plot.dot.setAttribute("d", `M${place[k] * WIDTH},${heightOf(answer.values[m])}h0`);
        });
      });
    },
  };
}
