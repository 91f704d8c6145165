// Says in the page what it computes, for tests that compare it with the service: asked for by an address
// that ends in "#test=POINT;POINT;…", each the values of all parameters, with commas between.

import { byId, element } from "../../../common/pages/modules/elements.mjs";

const PREFIX = "#test=";

export function isSelfTest(hash) {
  return hash.startsWith(PREFIX);
}

// Keeps a browser busy that goes through time as quickly as nothing is left to do, until what is returned
// is called: unpacking goes on beside the page, and is not waited for.
export function holdTime() {
  const timer = setInterval(() => {}, 1);
  return () => clearInterval(timer);
}

// Moves the page to each point as a link would, then the first slider to its end as a person would. `show`
// does the first, and returns what the map says there: {values, answer, shape}.
export async function runSelfTest(hash, faults, show, current, panel) {
  const points = hash.slice(PREFIX.length).split(";").filter(Boolean)
    .map((point) => point.split(",").map(Number));
  const answers = points.map((point) => {
    show(point);
    return told(current(), panel);
  });
  const slider = document.querySelector("#parameters input[type=range]");
  let moved = null;
  if (slider) {
    slider.value = slider.max;
    slider.dispatchEvent(new Event("input"));
    // The page shows a move soon after it.
    await new Promise((resolve) => { setTimeout(resolve, 100); });
    moved = { design: current().values, ...told(current(), panel) };
  }
  document.body.append(element("script", { type: "application/json", id: "self-test",
    text: JSON.stringify({ answers, moved, faults,
      webgl: panel?.view ? panel.view.gl.getParameter(panel.view.gl.VERSION) : null }) }));
}

function told({ answer, shape }, panel) {
  return {
    values: answer && [...answer.values],
    errors: answer && [...answer.errors],
    shown: [...document.querySelectorAll("#metrics .value")].map((cell) => cell.textContent),
    saysNoValues: !byId("no-values").hidden,
    saysNoShape: !byId("no-shape").hidden,
    positions: shape ? [...shape.slice(0, 30)] : null,
    colours: panel?.view ? panel.view.coloursDrawn() : 0,
  };
}
