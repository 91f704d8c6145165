// The controls of the parameters, and the table of the metrics.

import { element } from "../../../common/pages/modules/elements.mjs";
import { digits, quantity, shownUnit, spoken } from "./number_format.mjs";

const STEPS = 1000;        // of a slider from end to end
const MOST_BUTTONS = 4;    // choices beside one another; more are a list

// A control of one parameter: `root` is its element, show(value) sets it, showGaps(shares) marks where
// the map has no values along it.
function numberControl(parameter, id, change) {
  const { minimum, maximum } = parameter;
  const shown = shownUnit(parameter.unit);
  const label = spoken(parameter.name);
  const step = (maximum - minimum) / STEPS;
  const slider = element("input", {
    type: "range", id, min: 0, max: STEPS, step: 1,
    oninput: () => change(slider.valueAsNumber === STEPS ? maximum : minimum + step * slider.valueAsNumber),
    onkeydown: (event) => {
      // A page of a slider is a tenth, as browsers differ.
      const pages = { PageUp: 1, PageDown: -1 }[event.key];
      if (!pages) return;
      event.preventDefault();
      slider.value = slider.valueAsNumber + pages * STEPS / 10;
      slider.dispatchEvent(new Event("input"));
    },
  });
  const field = element("input", {
    type: "number", step: "any", "aria-label": `${label} in ${shown.unit || "numbers"}`,
    onchange: () => {
      if (Number.isFinite(field.valueAsNumber)) change(field.valueAsNumber / shown.factor);
    },
  });
  const gaps = element("div", { class: "gaps", "aria-hidden": "true" });
  const root = element("div", { class: "parameter" },
    element("label", { for: id, text: label }),
    element("span", { class: "entry" }, field, element("span", { class: "unit", text: shown.unit })),
    element("div", { class: "track" }, gaps, slider),
    element("div", { class: "ends", "aria-hidden": "true" },
      element("span", { text: digits(minimum * shown.factor) }),
      element("span", { text: digits(maximum * shown.factor) })));
  return {
    root,
    show(value) {
      slider.value = Math.round((value - minimum) / step);
      slider.setAttribute("aria-valuetext", quantity(value, shown, 5));
      const text = Number((value * shown.factor).toPrecision(6));
      if (document.activeElement !== field || field.valueAsNumber !== text) field.value = text;
    },
    showGaps: (shares) => { gaps.style.background = stripes(shares); },
  };
}

// A gradient with a colour for each sample of a track: where `covered` is false there are no values.
function stripes(covered) {
  if (covered.every(Boolean)) return "";
  const width = 100 / covered.length;
  const stops = covered.map((has, i) =>
    `${has ? "transparent" : "var(--gap)"} ${i * width}% ${(i + 1) * width}%`);
  return `linear-gradient(to right, ${stops.join(", ")})`;
}

function choiceName(parameter, value) {
  return parameter.choices[value] !== undefined ? spoken(parameter.choices[value]) : String(value);
}

function wholeControl(parameter, values, id, change) {
  const label = spoken(parameter.name);
  if (values.length === 1) {
    const root = element("div", { class: "parameter" }, element("span", { text: label }),
      element("span", { class: "entry", text: choiceName(parameter, values[0]) }));
    return { root, show() {}, showGaps() {} };
  }
  if (values.length <= MOST_BUTTONS) {
    const buttons = values.map((value) => element("input", {
      type: "radio", name: id, id: `${id}-${value}`, onchange: () => change(value),
    }));
    const root = element("fieldset", { class: "parameter" }, element("legend", { text: label }),
      element("div", { class: "choices" }, ...values.flatMap((value, i) => [buttons[i],
        element("label", { for: `${id}-${value}`, text: choiceName(parameter, value) })])));
    const show = (value) => buttons.forEach((button, i) => { button.checked = values[i] === value; });
    return { root, show, showGaps() {} };
  }
  const list = element("select", { id, onchange: () => change(Number(list.value)) },
    ...values.map((value) => element("option", { value, text: choiceName(parameter, value) })));
  const root = element("div", { class: "parameter" },
    element("label", { for: id, text: label }), element("span", { class: "entry" }, list));
  return { root, show: (value) => { list.value = String(value); }, showGaps() {} };
}

// Controls of all parameters of a design space; change(parameter, value) is called as they are moved.
export function makeControls(space, change) {
  return space.parameters.map((parameter, i) => parameter.whole
    ? wholeControl(parameter, space.valuesOf(i), `parameter-${i}`, (value) => change(i, value))
    : numberControl(parameter, `parameter-${i}`, (value) => change(i, value)));
}

// The rows of the metrics: show(answer) with what MapTree.evaluate gives, null for no values.
export function makeMetrics(metrics, root) {
  const rows = metrics.map((metric) => {
    const shown = shownUnit(metric.unit, Math.max(Math.abs(metric.minimum), Math.abs(metric.maximum)));
    const value = element("td", { class: "value" });
    const error = element("td", { class: "error" });
    const mark = element("div", { class: "mark" });
    const doubt = element("div", { class: "doubt" });
    const title = `from ${quantity(metric.minimum, shown)} to ${quantity(metric.maximum, shown)} on the map`;
    root.append(
      element("tr", {}, element("th", { scope: "row", text: spoken(metric.name) }), value, error),
      element("tr", { class: "gauge-row", "aria-hidden": "true" },
        element("td", { colspan: 3 }, element("div", { class: "gauge", title }, doubt, mark))));
    return { metric, shown, value, error, mark, doubt };
  });
  return {
    show(answer) {
      rows.forEach(({ metric, shown, value, error, mark, doubt }, m) => {
        mark.hidden = doubt.hidden = answer === null;
        if (answer === null) {
          value.textContent = "no value";
          error.textContent = "";
          return;
        }
        value.textContent = quantity(answer.values[m], shown);
        const range = metric.maximum - metric.minimum || 1;
        // What is rounding alone is nothing to be off by.
        const off = answer.errors[m] < 1e-9 * range ? 0 : answer.errors[m];
        error.textContent = `± ${digits(off * shown.factor, 2)}`;
        const share = (number) => 100 * Math.min(1, Math.max(0, (number - metric.minimum) / range));
        mark.style.left = `${share(answer.values[m])}%`;
        const low = share(answer.values[m] - answer.errors[m]);
        doubt.style.left = `${low}%`;
        doubt.style.width = `${share(answer.values[m] + answer.errors[m]) - low}%`;
      });
    },
  };
}
