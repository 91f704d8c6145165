// Leads from step to step: by arrow keys, buttons and a list.

import { element } from "../../../../common/pages/modules/elements.mjs";

// How far below the top of the window a step may begin and be the one that is read, pixels.
const READING_LINE = 120;

export class StepList {
  // sections: those of all steps; reached(section): called once a person has gone to a step.
  constructor(sections, reached) {
    this.sections = sections;
    this.reached = reached;
    const button = (text, move) =>
      element("button", { type: "button", text, onclick: () => this.go(this.current() + move) });
    this.back = button("‹ Back", -1);
    this.next = button("Next ›", 1);
    const choose = () => this.go(this.choice.selectedIndex - 1);
    this.choice = element("select", { "aria-label": "Step", onchange: choose },
      element("option", { text: "Overview" }),
      ...sections.map((section) => element("option", { text: section.querySelector("h2").textContent })));
    this.root = element("nav", { id: "steps", "aria-label": "Steps" }, this.back, this.choice, this.next);
    document.querySelector("header").after(this.root);
    document.addEventListener("keydown", (event) => this.press(event));
    document.addEventListener("scroll", () => this.follow(), { passive: true });
    this.follow();
  }

  // The step that is read, −1 above the first.
  current() {
    let found = -1;
    this.sections.forEach((section, i) => {
      if (section.getBoundingClientRect().top <= READING_LINE) found = i;
    });
    // The last steps may be too short to come to the top.
    const isAtEnd = window.innerHeight + window.scrollY >= document.documentElement.scrollHeight - 2;
    if (isAtEnd && this.asked !== undefined && this.asked > found) return this.asked;
    return found;
  }

  follow() {
    const current = this.current();
    this.choice.selectedIndex = current + 1;
    this.back.disabled = current < 0;
    this.next.disabled = current >= this.sections.length - 1;
  }

  // Goes to a step, or with −1 to the overview.
  go(number) {
    this.asked = Math.min(this.sections.length - 1, Math.max(-1, number));
    const section = this.sections[this.asked];
    if (section) section.scrollIntoView(); else window.scrollTo(0, 0);
    history.replaceState(null, "", section ? `#${section.id}` : "#");
    this.follow();
    if (section) this.reached(section);
  }

  press(event) {
    const moves = { ArrowLeft: -1, ArrowRight: 1 };
    const isTaken = event.target.closest("input, select, textarea, canvas, summary") !== null;
    const isCombined = event.ctrlKey || event.metaKey || event.altKey || event.shiftKey;
    if (!moves[event.key] || isTaken || isCombined) return;
    event.preventDefault();
    this.go(this.current() + moves[event.key]);
  }
}
