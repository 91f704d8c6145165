#include "services/catalog/exchange/shape_file.h"

#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/cad/step/step_isolation.h"
#include "common/mesh/shapes/drawn_shape.h"
#include "services/catalog/exchange/assembly_import.h"
#include "services/catalog/exchange/shape_import.h"
#include "services/catalog/records/shape_records.h"

namespace mortise::catalog {
namespace {

// What is wrong with the shape, said of the file.
absl::Status OfFile(const absl::Status& status) {
  if (absl::IsResourceExhausted(status)) {
    return TooLarge("file", "64 MiB unpacked, or 50,000 triangles");
  }
  if (!absl::IsInvalidArgument(status)) return status;
  std::vector<FieldViolation> violations = AllViolationsOf(status);
  for (FieldViolation& violation : violations) violation.field = "file";
  return InvalidFields(violations);
}

}  // namespace

absl::StatusOr<v1::Shape> ReadShape(const v1::ImportShapeRequest& asked) {
  const absl::StatusOr<std::string> bytes = UnpackStep(asked.file());
  if (!bytes.ok()) return OfFile(bytes.status());
  if (asked.format() == v1::ImportShapeRequest::STEP) {
    const absl::StatusOr<cad::StepAssembly> drawing = cad::ReadStepInChild(*bytes);
    if (!drawing.ok()) return OfFile(drawing.status());
    MORTISE_ASSIGN_OR_RETURN(const mesh::DrawnShape drawn, ShapeOfStep(*drawing));
    v1::Shape shape = NamedShape(drawn);
    shape.mutable_notes()->Assign(drawing->notes.begin(), drawing->notes.end());
    return shape;
  }
  if (asked.format() == v1::ImportShapeRequest::STL) {
    const absl::StatusOr<ImportedShape> imported = ShapeOfStl(*bytes);
    if (!imported.ok()) return OfFile(imported.status());
    v1::Shape shape = NamedShape(imported->shape);
    shape.mutable_notes()->Assign(imported->notes.begin(), imported->notes.end());
    return shape;
  }
  return InvalidField("format", "must be STEP or STL");
}

}  // namespace mortise::catalog
