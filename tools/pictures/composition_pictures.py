#!/usr/bin/env python3
"""Makes the pictures of docs/composer.md, of the compositions that ship.

composition_pictures.py [MORTISE] [SHEET]: with a house running on ./.mortise, or where MORTISE_GATEWAY
says; the two programs are those of build/release/bin unless others are named. Models that are there
already are composed anew; templates are not saved."""
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCRIPTS = ROOT / "collection" / "compositions"
PICTURES = ROOT / "docs" / "pictures"
BINARIES = ROOT / "build" / "release" / "bin"
MORTISE = sys.argv[1] if len(sys.argv) > 1 else str(BINARIES / "mortise")
SHEET = sys.argv[2] if len(sys.argv) > 2 else str(BINARIES / "picture_sheet")


def mortise(*words):
    """Runs a command; its document."""
    done = subprocess.run([MORTISE, "--json", "compose", *words], check=True, capture_output=True)
    return json.loads(done.stdout)


def sheet(name, columns, pictures):
    """Puts pictures, by their captions, into one."""
    texts = [f"{caption}={picture}" for caption, picture in pictures]
    subprocess.run([SHEET, str(PICTURES / name), "--columns", str(columns), *texts], check=True)


def title_of(script):
    first = next(line for line in script.read_text().splitlines() if line.startswith("new "))
    return first.split('"')[1]


def draw_all(steps):
    """All compositions side by side, as Figure 5-7."""
    pictures = []
    for script in sorted(SCRIPTS.glob("*.txt")):
        folder = steps / script.stem
        made = mortise("run", str(script), "--anew", "--unsaved", "--pictures", str(folder))
        last = sorted(folder.glob("*.png"))[-1]
        caption = f"{title_of(script)}: {made['components']} pieces, {made['parts']} parts"
        print(caption, made["digest"], f"{len(made['warnings'])} warnings")
        pictures.append((caption, last))
    sheet("compositions.png", 3, pictures)


def draw_steps(steps):
    """Pieces as they were dropped, as they snapped, and connected, as Figures 5-4 to 5-6."""
    pictures = []
    for name, piece in (("garden_sofa", "middle"), ("bookcase_with_doors", "right-door")):
        for command, caption in (("add", "dropped"), ("snap", "snapped"), ("connect", "connected")):
            line = line_of(SCRIPTS / f"{name}.txt", command, piece)
            pictures.append((caption, steps / name / f"{line:03d}-{command}.png"))
    sheet("composing_steps.png", 3, pictures)


def line_of(script, command, piece):
    words = f"--id {piece}" if command == "add" else piece
    for number, line in enumerate(script.read_text().splitlines(), 1):
        if line.startswith(command + " ") and words in line:
            return number
    raise SystemExit(f"{script} has no {command} of {piece}")


def draw_drags(steps):
    """One composed model, dragged three ways, as Figure 5-8."""
    pictures = []
    model = "media-sideboard-dragged"
    run = ["run", str(SCRIPTS / "media_sideboard.txt"), "--anew", "--unsaved", "--model", model]
    mortise(*run)
    for number, (caption, drags) in enumerate((
            ("as composed", ()),
            ("lower", (("height", "0.55m"),)),
            ("narrow and high", (("width", "1m"), ("height", "1m"))),
            ("deep, with high drawers",
             (("depth", "0.6m"), ("height", "0.25m", "left drawer front"))))):
        for control, value, *node in drags:
            where = ["--node", node[0]] if node else []
            mortise("drag", model, "--control", control, "--to", value, *where)
        picture = steps / f"dragged-{number}.png"
        mortise("show", model, "--picture", str(picture))
        pictures.append((caption, picture))
        for _ in drags:
            mortise("undo", model)
    sheet("composed_dragged.png", 2, pictures)


def main():
    with tempfile.TemporaryDirectory() as folder:
        steps = pathlib.Path(folder)
        draw_all(steps)
        draw_steps(steps)
        draw_drags(steps)


if __name__ == "__main__":
    main()
