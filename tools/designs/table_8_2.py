#!/usr/bin/env python3
"""Prints Table 8.2 of the thesis, ours beside the thesis's: what plans of chairs, sheds and tables count.

table_8_2.py [MORTISE]: with a house running on ./.mortise, or where MORTISE_GATEWAY says; the program is the
one on the PATH, or else that of build/release/bin, unless another is named. A row is
  | design | jigsaw | chop saw | pegs | steps |
with the thesis's number in brackets. Ends with 1 where jigsaw parts, chop saw parts or steps are not the
thesis's, or pegs are of another order of magnitude."""
import json
import pathlib
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILT = ROOT / "build" / "release" / "bin" / "mortise"
MORTISE = sys.argv[1] if len(sys.argv) > 1 else shutil.which("mortise") or str(BUILT)

# What the designs are called, the template, its parameters, and what the thesis counts: jigsaw parts, chop
# saw parts, pegs, steps. Of the table it tells only the parts (§8.4.3).
DESIGNS = (
    ("Chair A", "armchair", "width=0.64 leg_width=0.08 rail_height=0.11", (4, 10, 86, 5)),
    ("Chair B", "armchair", "armrests=none width=0.64 rail_height=0.11", (4, 8, 62, 4)),
    ("Chair C", "armchair", "width=0.58 leg_width=0.06 rail_height=0.08", (4, 10, 66, 5)),
    ("Chair D", "armchair", "width=0.7 depth=0.6 leg_width=0.11 rail_height=0.12 back_height=0.65",
     (4, 10, 114, 5)),
    ("Shed A", "shed", "slabs=23 width=1.6 depth=1.4 height=1.55", (16, 37, 1050, 9)),
    ("Shed B", "shed", "width=1.2 depth=1 height=1.4", (16, 25, 563, 9)),
    ("Shed C", "shed", "width=1.98 depth=2.4 height=2.18 door_width=0.75", (16, 25, 1333, 9)),
    ("Shed D", "shed", "door=right width=1.3 depth=1.4 height=2", (16, 25, 1121, 9)),
    ("Table", "table", "", (1, 8, None, None)),
)


def plan_of(template, parameters):
    """What a plan counts: jigsaw parts, chop saw parts, pegs, steps."""
    settings = [word for setting in parameters.split() for word in ("--set", setting)]
    done = subprocess.run([MORTISE, "--json", "plan", template, *settings], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{template} {parameters}: {done.stdout}{done.stderr}")
    plan = json.loads(done.stdout)
    return (plan.get("jigsaw_parts", 0), plan.get("chop_saw_parts", 0), plan.get("pegs", 0),
            len(plan.get("steps", ())))


def is_as_told(ours, thesis):
    """Parts and steps are to be the same, pegs to be of the same order of magnitude."""
    same = all(thesis[i] in (None, ours[i]) for i in (0, 1, 3))
    return same and (thesis[2] is None or 1 / 3 < ours[2] / thesis[2] < 3)


def main():
    print("| design | jigsaw parts | chop saw parts | pegs | steps |")
    print("|---|---|---|---|---|")
    differing = []
    for title, template, parameters, thesis in DESIGNS:
        ours = plan_of(template, parameters)
        cells = [str(own) if told is None else f"{own} ({told})" for own, told in zip(ours, thesis)]
        print(f"| {title} | {' | '.join(cells)} |", flush=True)
        if not is_as_told(ours, thesis):
            differing.append(title)
    if differing:
        raise SystemExit(f"not as the thesis's: {', '.join(differing)}")


if __name__ == "__main__":
    main()
