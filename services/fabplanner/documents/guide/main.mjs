// Reads the scene that the page carries, and keeps its parts together.

import { byId } from "../../../../common/pages/modules/elements.mjs";
import { readPack } from "../../../../common/pages/modules/packed_numbers.mjs";
import { GuideScene } from "./guide_scene.mjs";
import { holdTime, isSelfTest, runSelfTest } from "./self_test.mjs";
import { StepList } from "./step_list.mjs";
import { Viewer } from "./viewer.mjs";

const faults = [];
window.addEventListener("error", (event) => fail(event.message));
window.addEventListener("unhandledrejection", (event) => fail(String(event.reason)));

function fail(what) {
  faults.push(what);
  byId("fault").textContent = `This page met a fault: ${what}. The pictures and lists are all there.`;
  byId("fault").hidden = false;
}

async function start() {
  const sections = [...document.querySelectorAll("section.step")];
  const description = JSON.parse(byId("scene").textContent);
  const byNumber = new Map(description.steps.map((step) => [String(step.number), step]));
  let scene = null;
  const viewer = new Viewer(() => scene);
  const open = (section) => viewer.open(section, byNumber.get(section.dataset.step));
  const steps = new StepList(sections, (section) => {
    if (viewer.isOpen) open(section);
  });
  if (typeof DecompressionStream === "undefined") return;  // the pictures are there; nothing is to be turned
  scene = new GuideScene(description, await readPack(byId("pack").textContent, description.lists));
  for (const section of sections) {
    const button = section.querySelector(".turn");
    button.hidden = false;
    button.addEventListener("click", () => {
      open(section);
      byId("canvas").focus({ preventScroll: true });
    });
  }
  // "#turn-3" leads to the third step, turned.
  const turned = sections.find((section) => location.hash === `#turn-${section.dataset.step}`);
  if (turned) {
    steps.go(sections.indexOf(turned));
    open(turned);
  }
  if (isSelfTest(location.hash)) await runSelfTest({ steps, viewer, sections, faults });
}

const release = isSelfTest(location.hash) ? holdTime() : () => {};
start().catch((reason) => fail(String(reason?.message ?? reason))).finally(release);
