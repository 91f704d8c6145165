#!/usr/bin/env python3
"""Makes the pictures of docs/carpentry.md, after Figures 8-24 to 8-28 of the thesis.

carpentry_pictures.py [MORTISE] [SHEET]: with a house running on ./.mortise, or where MORTISE_GATEWAY says; the
two programs are those of build/release/bin unless others are named. Chairs and sheds are those of
tools/designs/table_8_2.py."""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PICTURES = ROOT / "docs" / "pictures"
BINARIES = ROOT / "build" / "release" / "bin"
MORTISE = sys.argv[1] if len(sys.argv) > 1 else str(BINARIES / "mortise")
SHEET = sys.argv[2] if len(sys.argv) > 2 else str(BINARIES / "picture_sheet")

sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "tools" / "designs"))
from table_8_2 import DESIGNS  # noqa: E402

# Designs that show what choices change, and their parameters.
CHOICES = (
    ("Work table, posts and slats", "work-table", ""),
    ("panels and a shelf", "work-table", "legs=panels lower=shelf"),
    ("Writing desk", "writing-desk", "back=panel"),
    ("compartments on the left", "writing-desk", "pedestal=left compartments=4"),
    ("Bed with a headboard of slats", "platform-bed", ""),
    ("narrow, without one", "platform-bed", "headboard=none width=0.9"),
    ("Shed with a window", "shed", "window=one"),
    ("doorway on the right, more slabs", "shed", "door=right slabs=23 width=1.4"),
)

# The ground below decks: a file beside the deck, the place in it that becomes the origin, and parameters.
DECKS = (
    ("a hillside", "hillside.asc", "451230,5411872", "width=2.98"),
    ("a hollow", "hollow.csv", "0,0", "infill=1"),
    ("a bank", "bank.obj", "0,0", "depth=2.36 infill=4"),
)


def mortise(*words):
    """Runs a command; its document."""
    done = subprocess.run([MORTISE, "--json", *words], capture_output=True, text=True)
    if done.returncode != 0:
        raise SystemExit(f"{' '.join(words)}: {done.stdout}{done.stderr}")
    return json.loads(done.stdout)


def settings(parameters):
    return [word for setting in parameters.split() for word in ("--set", setting)]


def sheet(name, columns, pictures):
    """Puts pictures, by their captions, into one."""
    texts = [f"{caption}={picture}" for caption, picture in pictures]
    subprocess.run([SHEET, str(PICTURES / name), "--columns", str(columns), *texts], check=True)


def metric(analysis, name, load_case=None):
    """A metric, or what it is under one load case."""
    told = analysis
    if load_case:
        told = next(case for case in analysis["cases"] if case["name"] == load_case)
    return next(value["value"] for value in told["metrics"] if value["name"] == name)


def analysed(folder, title, template, parameters, size, picture):
    """What an analysis tells, and its picture."""
    out = folder / title.replace(" ", "-")
    analysis = mortise("analyze", template, *settings(parameters), "--linear", "--element-size", size, "--out",
                       str(out))
    found = sorted(out.glob(picture))
    if not found:
        raise SystemExit(f"{title}: no {picture} among {sorted(each.name for each in out.iterdir())}")
    return analysis, found[0]


def draw_chairs(folder):
    """The stress in four chairs, as Figure 8-27, top."""
    pictures = []
    for title, template, parameters, _ in DESIGNS:
        if template != "armchair":
            continue
        analysis, picture = analysed(folder, title, template, parameters, "20mm", "stress.png")
        stress = metric(analysis, "max_von_mises") / 1e6
        sag = metric(analysis, "max_displacement") * 1e3
        pictures.append((f"{title}: {stress:.1f} MPa, {sag:.2f} mm", picture))
        print(pictures[-1][0], flush=True)
    sheet("chair_stress.png", 2, pictures)


def draw_sheds(folder):
    """Four sheds in the wind, as Figure 8-27, bottom."""
    pictures = []
    for title, template, parameters, _ in DESIGNS:
        if template != "shed":
            continue
        analysis, picture = analysed(folder, title, template, parameters, "150mm", "*wind.png")
        sag = metric(analysis, "max_displacement", "wind") * 1e3
        pictures.append((f"{title}: {sag:.1f} mm", picture))
        print(pictures[-1][0], flush=True)
    sheet("shed_deformation.png", 2, pictures)


def planned(folder, title, template, parameters):
    """The pictures of a plan's steps, in order."""
    out = folder / f"plan {title}"
    plan = mortise("plan", template, *settings(parameters), "--out", str(out))
    return [out / f"step-{step['number']}.png" for step in plan["steps"]]


def draw_steps(folder):
    """The assembly of the chair and of the largest shed, as Figure 8-26."""
    for name, title, columns in (("chair_steps.png", "Chair A", 5), ("shed_steps.png", "Shed C", 3)):
        _, template, parameters, _ = next(row for row in DESIGNS if row[0] == title)
        steps = planned(folder, title, template, parameters)
        sheet(name, columns, [(f"step {number}", step) for number, step in enumerate(steps, 1)])


def draw_boards(folder):
    """Where the chop saw cuts the chair's boards: what the machines of Figure 8-25 are told."""
    _, template, parameters, _ = DESIGNS[0]
    planned(folder, "boards", template, parameters)
    shutil.copy(folder / "plan boards" / "boards.svg", PICTURES / "chair_boards.svg")


def draw_decks(folder):
    """Decks on the terrains that ship, under people, as Figure 8-28."""
    pictures = []
    for title, file, origin, parameters in DECKS:
        ground = f"ground={ROOT / 'collection' / 'designs' / 'deck' / file}"
        placed = mortise("catalog", "place", "deck", "--height-field", ground, "--origin", origin, "--title", title)
        analysis, picture = analysed(folder, title, placed["name"], parameters, "150mm", "*people.png")
        sag = metric(analysis, "max_displacement", "people") * 1e3
        pictures.append((f"{title}: {sag:.1f} mm", picture))
        print(pictures[-1][0], flush=True)
    sheet("deck_variations.png", 3, pictures)


def draw_choices(folder):
    """The last step of designs of different choices."""
    sheet("carpentry_choices.png", 4,
          [(title, planned(folder, title, template, parameters)[-1]) for title, template, parameters in CHOICES])


def main():
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder)
        draw_choices(path)
        draw_steps(path)
        draw_boards(path)
        draw_chairs(path)
        draw_sheds(path)
        draw_decks(path)


if __name__ == "__main__":
    main()
