// Reading of drawings, and the few that are remembered.
#include "services/catalog/service/drawing_source.h"

#include <string_view>
#include <utility>
#include <vector>

#include "common/assembly/memory_use.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/cad/step/step_isolation.h"
#include "services/catalog/exchange/assembly_import.h"
#include "services/catalog/exchange/shape_turn.h"
#include "services/catalog/records/drawing_records.h"
#include "services/catalog/records/shape_records.h"

namespace mortise::catalog {
namespace {

constexpr std::size_t kRememberedBytes = std::size_t{128} << 20;
constexpr std::size_t kPart = sizeof(cad::StepPart) + sizeof(cad::StepProduct) + 256;  // with names
constexpr std::string_view kOfStep = "step: ";

using DrawingCache = SingleFlightCache<Drawing>;

std::size_t MemoryUse(const cad::StepAssembly& drawing) {
  std::size_t bytes =
      (drawing.parts.size() + drawing.groups.size() + drawing.leaves.size()) * kPart;
  for (const mesh::DrawnShape& shape : drawing.shapes) bytes += parametric::MemoryUse(shape);
  return bytes;
}

}  // namespace

DrawingSource::DrawingSource(store::Store* store, store::BlobFolder* blobs)
    : store_(store), blobs_(blobs), read_(kRememberedBytes, Oversize::kAlone) {}

absl::StatusOr<Drawing> DrawingSource::Read(const std::string& step, const std::string& drawing) {
  if (!step.empty() && !drawing.empty()) {
    return InvalidField("drawing", "give either this or 'step'");
  }
  std::string uploaded;
  if (!drawing.empty()) {
    MORTISE_ASSIGN_OR_RETURN(uploaded, GetDrawing(store_, blobs_, drawing));
  }
  const std::string& file = drawing.empty() ? step : uploaded;
  const std::string key = Sha256Hex(file);
  return read_.Get(key, [&file]() -> absl::StatusOr<DrawingCache::Made> {
    MORTISE_ASSIGN_OR_RETURN(const std::string bytes, UnpackStep(file));
    MORTISE_ASSIGN_OR_RETURN(cad::StepAssembly read, cad::ReadStepInChild(bytes));
    for (mesh::DrawnShape& shape : read.shapes) shape.name = NamedShape(shape).name();
    const std::vector<int> first = FirstAlike(read.shapes);
    for (cad::StepPart& part : read.parts) {
      if (part.shape >= 0) part.shape = first[static_cast<std::size_t>(part.shape)];
    }
    const std::size_t taken = MemoryUse(read);
    return DrawingCache::Made{std::make_shared<const cad::StepAssembly>(std::move(read)), taken};
  });
}

absl::Status OfUpload(const absl::Status& status) {
  if (absl::IsResourceExhausted(status)) {
    return WithDetail(status, {DetailOf(status).reason, "drawing"});
  }
  std::vector<FieldViolation> violations = ViolationsOf(status);
  if (violations.empty()) {
    const ErrorDetail detail = DetailOf(status);
    if (detail.field != "step") return status;
    std::string message(status.message());
    if (message.starts_with(kOfStep)) message.erase(0, kOfStep.size());
    return InvalidField("drawing", message);
  }
  for (FieldViolation& violation : violations) {
    if (violation.field == "step") violation.field = "drawing";
  }
  return InvalidFields(violations);
}

}  // namespace mortise::catalog
