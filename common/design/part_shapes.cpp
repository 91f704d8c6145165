// Places each part's prism for the CAD kernel.
#include "common/design/part_shapes.h"

namespace mortise::parametric {

mesh::PartShape PartShapeOf(const EvaluatedPart& part) {
  mesh::PartShape shape;
  shape.name = part.name;
  shape.origin = FromPrismAxes(part.axis, 0, 0, part.from);
  shape.u = FromPrismAxes(part.axis, 1, 0, 0);
  shape.v = FromPrismAxes(part.axis, 0, 1, 0);
  shape.outline = part.outline;
  shape.height = part.to - part.from;
  shape.face_names = part.face_names;
  return shape;
}

std::vector<mesh::PartShape> PartShapes(const EvaluatedDesign& design) {
  std::vector<mesh::PartShape> shapes;
  for (const EvaluatedPart& part : design.parts) shapes.push_back(PartShapeOf(part));
  return shapes;
}

}  // namespace mortise::parametric
