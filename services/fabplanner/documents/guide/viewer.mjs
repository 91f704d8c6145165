// One view in three dimensions for the whole page, which goes to the step that it is asked for in: browsers
// lend few graphics contexts.

import { Camera, steer } from "../../../../common/pages/modules/camera.mjs";
import { byId } from "../../../../common/pages/modules/elements.mjs";
import { AssemblyView } from "./assembly_view.mjs";

export class Viewer {
  // scene(): the page's GuideScene, once it is unpacked.
  constructor(scene) {
    this.scene = scene;
    this.camera = new Camera();
    this.root = null;
    this.section = null;
  }

  get isOpen() {
    return this.section !== null;
  }

  make() {
    document.body.append(byId("viewer-source").content);
    this.root = byId("viewer");
    this.view = AssemblyView.create(byId("canvas"), this.scene());
    byId("no-webgl").hidden = this.view !== null;
    steer(byId("canvas"), this.camera, () => this.schedule(), () => this.reset());
    for (const id of ["apart", "see-through"]) byId(id).addEventListener("input", () => this.schedule());
    byId("reset-view").addEventListener("click", () => {
      this.reset();
      this.schedule();
    });
    byId("close-viewer").addEventListener("click", () => this.close());
    this.root.addEventListener("keydown", (event) => {
      if (event.key === "Escape") this.close();
    });
    window.addEventListener("resize", () => this.schedule());
  }

  // Shows a step in its section, in place of the picture.
  open(section, step) {
    if (!this.root) this.make();
    this.section?.querySelector("figure").classList.remove("viewing");
    this.section = section;
    this.step = step;
    const figure = section.querySelector("figure");
    figure.classList.add("viewing");
    figure.append(this.root);
    this.root.hidden = false;
    byId("canvas").setAttribute("aria-label", `${section.querySelector("h2").textContent} in three dimensions`);
    this.view?.show(step);
    this.reset();
    this.draw();
  }

  close() {
    if (!this.isOpen) return;
    const figure = this.section.querySelector("figure");
    figure.classList.remove("viewing");
    this.root.hidden = true;
    this.section = null;
    figure.querySelector(".turn").focus();
  }

  // Looks at the step from where its picture was taken.
  reset() {
    const [x, y, z] = this.step.view;
    this.camera.yaw = Math.atan2(y, x);
    this.camera.pitch = Math.atan2(z, Math.hypot(x, y));
    this.camera.frame(this.scene().boxOf(this.step));
  }

  // Moves that come at once make one picture.
  schedule() {
    this.waiting ??= setTimeout(() => {
      this.waiting = null;
      this.draw();
    });
  }

  draw() {
    if (!this.isOpen || !this.view) return;
    this.view.draw(this.camera, { apart: byId("apart").value / 100, seeThrough: byId("see-through").checked });
  }
}
