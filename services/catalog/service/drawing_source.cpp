// Reading of drawings, and the few that are remembered.
#include "services/catalog/service/drawing_source.h"

#include <filesystem>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/assembly/memory_use.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/mesh/scenes/scene_reader.h"
#include "services/catalog/exchange/assembly_import.h"
#include "services/catalog/exchange/shape_turn.h"
#include "services/catalog/records/drawing_records.h"
#include "services/catalog/records/shape_records.h"

namespace mortise::catalog {
namespace {

constexpr std::size_t kRememberedBytes = std::size_t{128} << 20;
constexpr std::size_t kPart = sizeof(cad::StepPart) + sizeof(cad::StepProduct) + 256;  // with names

using DrawingCache = SingleFlightCache<Drawing>;

std::size_t MemoryUse(const cad::StepAssembly& drawing) {
  std::size_t bytes =
      (drawing.parts.size() + drawing.groups.size() + drawing.leaves.size()) * kPart;
  for (const mesh::DrawnShape& shape : drawing.shapes) bytes += parametric::MemoryUse(shape);
  return bytes;
}

DrawingCache::Made Kept(cad::StepAssembly drawing) {
  const std::size_t taken = MemoryUse(drawing);
  return {std::make_shared<const cad::StepAssembly>(std::move(drawing)), taken};
}

}  // namespace

DrawingSource::DrawingSource(store::Store* store, store::BlobFolder* blobs)
    : store_(store), blobs_(blobs), read_(kRememberedBytes, Oversize::kAlone) {}

absl::StatusOr<std::string> DrawingSource::BytesOf(const std::string& sent,
                                                   const std::string& drawing, const char* field) {
  if (drawing.empty()) return sent;
  if (!sent.empty()) {
    return InvalidField("drawing", absl::StrCat("give either this or '", field, "'"));
  }
  return GetDrawing(store_, blobs_, drawing);
}

absl::StatusOr<Drawing> DrawingSource::Read(const std::string& step, const std::string& drawing,
                                            const cad::StepChildOptions& options) {
  MORTISE_ASSIGN_OR_RETURN(const std::string file, BytesOf(step, drawing, "step"));
  return read_.Get(Sha256Hex(file), [&]() -> absl::StatusOr<DrawingCache::Made> {
    MORTISE_ASSIGN_OR_RETURN(const std::string bytes, UnpackStep(file));
    MORTISE_ASSIGN_OR_RETURN(cad::StepAssembly read, cad::ReadStepInChild(bytes, options));
    for (mesh::DrawnShape& shape : read.shapes) shape.name = NamedShape(shape).name();
    const std::vector<int> first = FirstAlike(read.shapes);
    for (cad::StepPart& part : read.parts) {
      if (part.shape >= 0) part.shape = first[static_cast<std::size_t>(part.shape)];
    }
    return Kept(std::move(read));
  });
}

absl::StatusOr<Drawing> DrawingSource::ReadMesh(const std::string& file, const std::string& drawing,
                                                const std::string& file_name,
                                                const MeshDrawingOptions& options) {
  MORTISE_ASSIGN_OR_RETURN(const std::string sent, BytesOf(file, drawing, "file"));
  const std::string key =
      absl::StrCat(Sha256Hex(sent), " ", options.unit.value_or(0), " ",
                   static_cast<int>(options.up), " ", options.most_parts, " ", file_name);
  return read_.Get(key, [&]() -> absl::StatusOr<DrawingCache::Made> {
    const absl::StatusOr<std::string> bytes = UnpackStep(sent);
    if (absl::IsResourceExhausted(bytes.status())) return TooLarge("file", "64 MiB unpacked");
    if (!bytes.ok()) return RenameField(bytes.status(), "step", "file");
    MORTISE_ASSIGN_OR_RETURN(mesh::Scene scene, mesh::ReadScene(*bytes, file_name));
    const std::string title = std::filesystem::path(file_name).stem().string();
    MORTISE_ASSIGN_OR_RETURN(cad::StepAssembly read,
                             DrawingOfScene(std::move(scene), title, options));
    return Kept(std::move(read));
  });
}

absl::Status RenameField(const absl::Status& status, const std::string& from,
                         const std::string& to) {
  if (absl::IsResourceExhausted(status)) {
    return WithDetail(status, {DetailOf(status).reason, to});
  }
  std::vector<FieldViolation> violations = ViolationsOf(status);
  if (violations.empty()) {
    const ErrorDetail detail = DetailOf(status);
    if (detail.field != from) return status;
    std::string message(status.message());
    const std::string said = from + ": ";
    if (message.starts_with(said)) message.erase(0, said.size());
    return InvalidField(to, message);
  }
  for (FieldViolation& violation : violations) {
    if (violation.field == from) violation.field = to;
  }
  return InvalidFields(violations);
}

}  // namespace mortise::catalog
