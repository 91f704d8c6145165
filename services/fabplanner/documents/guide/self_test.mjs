// Says in the page what it shows, for tests: asked for by an address that ends in "#test".

import { byId, element } from "../../../../common/pages/modules/elements.mjs";

export function isSelfTest(hash) {
  return hash === "#test";
}

// Keeps a browser busy that goes through time as quickly as nothing is left to do, until what is returned
// is called: unpacking goes on beside the page, and is not waited for.
export function holdTime() {
  const timer = setInterval(() => {}, 1);
  return () => clearInterval(timer);
}

const press = (target, key) => target.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));

// Goes through the steps by keys, as a person would, turns each, puts it together, and goes back to its
// picture.
export async function runSelfTest({ steps, viewer, sections, faults }) {
  const answers = [];
  for (const section of sections) {
    press(document.body, "ArrowRight");
    const reached = location.hash;
    section.querySelector(".turn")?.click();
    answers.push({ reached, shown: steps.choice.selectedOptions[0].textContent, ...turned(viewer) });
  }
  press(byId("canvas") ?? document.body, "Escape");
  const isPicture = document.querySelectorAll(".viewing").length === 0;
  press(document.body, "ArrowLeft");
  document.body.append(element("script", { type: "application/json", id: "self-test",
    text: JSON.stringify({ answers, faults, isPicture, last: location.hash,
      saysNoWebgl: byId("no-webgl") ? !byId("no-webgl").hidden : false }) }));
}

function turned(viewer) {
  if (!viewer.view) return { view: null };
  const before = viewer.view.told();
  const start = [viewer.camera.yaw, viewer.camera.zoom];
  press(byId("canvas"), "ArrowLeft");
  press(byId("canvas"), "+");
  const moved = viewer.camera.yaw !== start[0] && viewer.camera.zoom > start[1];
  byId("see-through").checked = false;
  byId("apart").value = 0;
  viewer.draw();
  const together = viewer.view.told();
  byId("see-through").checked = true;
  byId("apart").value = 100;
  return { view: before, moved, coloursTogether: together.colours };
}
