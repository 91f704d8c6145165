// Prints the field `surface` of collection/cage_templates/boat.textproto.
#include <iostream>
#include <string>

#include "absl/strings/str_cat.h"
#include "tools/boat/boat_surface.h"

namespace mortise::parametric {
namespace {

std::string SurfaceText(const CageSurface& surface) {
  std::string text = "surface {\n  vertices: [";
  for (Eigen::Index v = 0; v < surface.vertices.cols(); ++v) {
    absl::StrAppend(&text, v == 0 ? "" : ",", v % 4 == 0 ? "\n    " : "  ");
    for (int axis = 0; axis < 3; ++axis) {
      absl::StrAppend(&text, axis == 0 ? "" : ", ", surface.vertices(axis, v));
    }
  }
  absl::StrAppend(&text, "\n  ]\n");
  for (const CageFace& face : surface.faces) {
    absl::StrAppend(&text, "  faces {\n    name: \"", face.name, "\"\n    triangles: [");
    for (Eigen::Index t = 0; t < face.triangles.cols(); ++t) {
      absl::StrAppend(&text, t == 0 ? "" : ",", t % 6 == 0 ? "\n      " : "  ",
                      face.triangles(0, t), ", ", face.triangles(1, t), ", ", face.triangles(2, t));
    }
    absl::StrAppend(&text, "\n    ]\n  }\n");
  }
  return text + "}\n";
}

}  // namespace
}  // namespace mortise::parametric

int main() {
  std::cout << mortise::parametric::SurfaceText(mortise::parametric::DrawBoat());
  return 0;
}
