#!/usr/bin/env python3
"""Makes the pictures of docs/interpolator.md of designs on maps, as Figures 6-17 to 6-19 of the thesis.

map_pictures.py [mapping|models|press]...: with a house running on ./.mortise, or where MORTISE_GATEWAY
says, whose workers may take some minutes; all three without an argument. What was found is printed. Maps are
deleted when they are drawn."""
import contextlib
import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PICTURES = ROOT / "docs" / "pictures"
BINARIES = ROOT / "build" / "release" / "bin"


def mortise(*words):
    """Runs a command; its document."""
    done = subprocess.run([BINARIES / "mortise", "--json", *words], check=True, capture_output=True)
    return json.loads(done.stdout)


@contextlib.contextmanager
def built_map(*words):
    """A map for as long as it is needed."""
    made = mortise("map", "build", *words)
    print(words[0], made["stop_reason"], f"{made.get('samples', 0)} samples, "
          f"{made.get('probes', 0)} probes")
    try:
        yield made["name"]
    finally:
        mortise("map", "delete", made["name"])


def design(values):
    return ",".join(f"{name}={value}" for name, value in values.items())


def shape_of(name, values, file):
    """Writes the design's shape; its metrics by the map."""
    written = mortise("map", "shape", name, "--at", design(values), "--surface", "--output", str(file))
    return written["metrics"]


def draw(name, pictures, *options):
    texts = [f"{caption}={picture}" for caption, picture in pictures]
    subprocess.run([BINARIES / "field_pictures", PICTURES / name, *options, *texts], check=True)


def draw_mapping(folder):
    """A source geometry, the mesh of another design, and that mesh in the source's geometry: Figure 6-17."""
    target = {"handle_length": 0.12, "head_thickness": 0.0095, "fillet_radius": 0.004}
    source = {"handle_length": 0.2, "head_thickness": 0.0095, "fillet_radius": 0.03}
    words = [word for name, value in source.items() for word in ("--set", f"{name}={value}")]
    mortise("analyze", "wrench", *words, "--element-size", "8mm", "--linear", "--out", str(folder / "own"))
    pictures = [("source, as it was meshed itself", folder / "own" / "analysis.vtu")]
    with built_map("wrench", "--vary", "handle_length=0.12:0.2", "--vary", "fillet_radius=0.004:0.03",
                   "--shape", "tetrahedra", "--samples", "12", "--element-size", "8mm", "--linear") as made:
        for caption, values in (("another design, with the map's mesh", target),
                                ("source, with the map's mesh", source)):
            values = {name: value for name, value in values.items() if name != "head_thickness"}
            pictures.append((caption, folder / f"{len(pictures)}.vtu"))
            shape_of(made, values, pictures[-1][1])
    draw("map_mapping.png", pictures, "--mesh", "--columns", "3", "--width", "420", "--height", "300",
         "--from", "0.4,-1,1.6")


# What is drawn of each model: what its map is built with, the field and how it is told, its designs.
MODELS = {
    "bike-rocker-arm": (["--vary", "hole_length=0.016:0.046", "--vary", "thickness=0.009:0.018", "--samples", "14",
                         "--element-size", "5mm"],
                        ["--field", "von_mises", "--unit", "MPa", "--over", "1e6", "--from", "0.3,-1,0.9"],
                        [{"hole_length": 0.018, "thickness": 0.016}, {"hole_length": 0.032, "thickness": 0.016},
                         {"hole_length": 0.045, "thickness": 0.01}]),
    "chair": (["--vary", "seat_width=0.38:0.55", "--vary", "back_height=0.3:0.6", "--samples", "14",
               "--element-size", "35mm", "--linear"],
              ["--field", "von_mises", "--unit", "MPa", "--over", "1e6"],
              [{"seat_width": 0.39, "back_height": 0.31}, {"seat_width": 0.46, "back_height": 0.45},
               {"seat_width": 0.54, "back_height": 0.59}]),
    "camera-mount": (["--vary", "wall_low=0.002:0.009", "--vary", "deck_far=0.002:0.009", "--samples", "14",
                      "--element-size", "5mm"],
                     ["--field", "von_mises", "--unit", "MPa", "--over", "1e6"],
                     [{"wall_low": 0.0025, "deck_far": 0.0025}, {"wall_low": 0.0085, "deck_far": 0.0025},
                      {"wall_low": 0.0085, "deck_far": 0.0085}]),
    "swing-castle": (["--vary", "door_width=0.3:0.62", "--vary", "swing_angle=-0.9:0.9", "--samples", "14",
                      "--element-size", "90mm"],
                     ["--field", "von_mises", "--unit", "MPa", "--over", "1e6"],
                     [{"door_width": 0.32, "swing_angle": -0.8}, {"door_width": 0.46, "swing_angle": 0},
                      {"door_width": 0.6, "swing_angle": 0.8}]),
    "plane": (["--vary", "wing_span=0.24:0.42", "--vary", "wing_sweep=0:0.08", "--samples", "12", "--air-cells", "8000",
               "--shape", "surface"],
              ["--field", "air_pressure", "--unit", "Pa", "--range", "-60:60", "--from", "1.2,-0.9,0.9"],
              [{"wing_span": 0.26, "wing_sweep": 0.005}, {"wing_span": 0.34, "wing_sweep": 0.04},
               {"wing_span": 0.41, "wing_sweep": 0.075}]),
    "drum-brake": (["--vary", "hole_angle=0.1:0.6", "--vary", "rim_thickness=0.008:0.02", "--samples", "14",
                    "--element-size", "10mm", "--field", "temperature", "--field", "displacement"],
                   [],
                   [{"hole_angle": 0.15, "rim_thickness": 0.009}, {"hole_angle": 0.4, "rim_thickness": 0.014},
                    {"hole_angle": 0.58, "rim_thickness": 0.019}]),
}
# The brake's three fields, as in the thesis.
BRAKE = {"temperature": ["--field", "temperature", "--unit", "K"],
         "displacement": ["--field", "displacement", "--unit", "mm", "--over", "1e-3"],
         "von_mises": ["--field", "von_mises", "--unit", "MPa", "--over", "1e6"]}


def draw_models(folder):
    """Designs of six maps, each coloured by its field on one scale: Figure 6-18."""
    rows = []
    for subject, (words, options, designs) in MODELS.items():
        field = "air_pressure" if subject == "plane" else "von_mises"
        with built_map(subject, *words, "--field", field) as made:
            pictures = []
            for number, values in enumerate(designs):
                pictures.append((design(values), folder / f"{subject}-{number}.vtu"))
                shape_of(made, values, pictures[-1][1])
        for suffix, options in BRAKE.items() if subject == "drum-brake" else [("", options)]:
            rows.append((pictures, options))
    for number, (pictures, options) in enumerate(rows):
        draw(f"../../build/map_models_{number}.png", pictures, "--columns", "3", "--width", "360", "--height", "240",
             *options)
    sheet = BINARIES / "picture_sheet"
    subprocess.run([sheet, PICTURES / "map_models.png", "--columns", "1", "--shrink", "1",
                    *(f"={ROOT}/build/map_models_{number}.png" for number in range(len(rows)))], check=True)


def draw_press(folder):
    """The arbor press before and after its stress was made small, tall and short: Figure 6-19."""
    start = {"fillet_radius": 0.02, "side_thickness": 0.016, "hole_size": 0.011}
    pictures = []
    with built_map("arbor-press", "--metric", "von_mises_integral", "--metric", "mean_von_mises", "--metric",
                   "von_mises_p99", "--metric", "max_von_mises", "--metric", "mass", "--field", "von_mises", "--shape",
                   "surface", "--samples", "90", "--element-size", "12mm") as made:
        for caption, size in (("tall", {"height": 0.3, "width": 0.1}), ("short", {"height": 0.17, "width": 0.15})):
            fixed = [word for name, value in size.items() for word in ("--fix", f"{name}={value}")]
            found = mortise("map", "optimize", made, "--minimize", "von_mises_integral", *fixed)
            print(caption, json.dumps(found))
            before = mortise("analyze", "arbor-press", "--element-size", "12mm",
                             *(word for name, value in {**size, **start}.items() for word in ("--set", f"{name}={value}")),
                             *(word for metric in found["metrics"] for word in ("--metric", metric)))
            print(caption, "before", json.dumps(before))
            for what, values in (("before", {**size, **start}), ("after", found["parameters"])):
                pictures.append((f"{caption}, {what}", folder / f"{caption}-{what}.vtu"))
                print(caption, what, shape_of(made, values, pictures[-1][1]))
    draw("map_arbor_press.png", pictures, "--field", "von_mises", "--unit", "MPa", "--over", "1e6", "--alike",
         "--columns", "4", "--width", "330", "--height", "420", "--from", "0.7,-1.35,0.55")


def main():
    draws = {"mapping": draw_mapping, "models": draw_models, "press": draw_press}
    with tempfile.TemporaryDirectory() as folder:
        for name in sys.argv[1:] or draws:
            draws[name](pathlib.Path(folder))


if __name__ == "__main__":
    main()
