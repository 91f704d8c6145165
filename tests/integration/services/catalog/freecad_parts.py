# Run by freecadcmd: writes what FreeCAD finds in a STEP file, in metres, as JSON.
# STEP_FILE: what to read. PARTS_FILE: what to write.
import json
import os

import FreeCAD
import Import
import MeshPart

DEFLECTION = 0.01  # mm

# Groups rather than links: without a window this version ends in a crash over links.
FreeCAD.ParamGet("User parameter:BaseApp/Preferences/Mod/Import").SetBool("UseLinkGroup", False)
# What products are called, without a number where one occurs again.
FreeCAD.ParamGet("User parameter:BaseApp/Preferences/Document").SetBool("DuplicateLabels", True)
document = FreeCAD.newDocument("read")
Import.insert(os.environ["STEP_FILE"], document.Name)


def group_above(thing):
    groups = [parent.Label for parent in thing.InList if parent.TypeId == "App::Part"]
    return groups[0] if groups else ""


# FreeCAD's own volumes and centers within splines are up to a hundredth off.
def has_splines(shape):
    return any("BSpline" in type(face.Surface).__name__ for face in shape.Faces)


products = []


# Of products with splines, where they were drawn.
def triangles_of(shape):
    for product, triangles in products:
        if product.isPartner(shape):
            return triangles
    drawn = shape.copy(False)
    drawn.Placement = FreeCAD.Placement()
    products.append((shape, MeshPart.meshFromShape(Shape=drawn, LinearDeflection=DEFLECTION)))
    return products[-1][1]


def metres(vector):
    return [vector.x / 1000, vector.y / 1000, vector.z / 1000]


def measured(feature):
    shape = feature.Shape.copy(False)
    shape.Placement = feature.getGlobalPlacement()
    numbers = {
        "product": feature.Label,
        "group": group_above(feature),
        "solids": len(shape.Solids),
        "valid": shape.isValid(),
        "area": shape.Area * 1e-6,
    }
    if not has_splines(shape):
        numbers["volume"] = shape.Volume * 1e-9
        numbers["center"] = metres(shape.Solids[0].CenterOfMass)
        return numbers
    drawn = triangles_of(feature.Shape)
    triangles = drawn.copy()
    triangles.transform(shape.Placement.toMatrix())
    box = triangles.BoundBox
    numbers["volume"] = drawn.Volume * 1e-9
    numbers["deflection"] = DEFLECTION / 1000
    numbers["minimum"] = metres(FreeCAD.Vector(box.XMin, box.YMin, box.ZMin))
    numbers["maximum"] = metres(FreeCAD.Vector(box.XMax, box.YMax, box.ZMax))
    return numbers


features = [thing for thing in document.Objects if thing.TypeId == "Part::Feature"]
groups = [
    {"name": thing.Label, "parent": group_above(thing)}
    for thing in document.Objects
    if thing.TypeId == "App::Part"
]
with open(os.environ["PARTS_FILE"] + ".part", "w") as out:
    json.dump({"groups": groups, "parts": [measured(feature) for feature in features]}, out)
os.rename(os.environ["PARTS_FILE"] + ".part", os.environ["PARTS_FILE"])
