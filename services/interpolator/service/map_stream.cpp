#include "services/interpolator/service/map_stream.h"

#include <string>

#include "common/base/errors.h"
#include "services/interpolator/service/map_export.h"
#include "services/interpolator/service/mesh_messages.h"

namespace mortise::interpolator {
namespace {

constexpr std::size_t kMostBytesOfPart = std::size_t{8} * kMostNumbersOfPart;

// Which canonical mesh each element has, and how far its shapes and the chosen fields may be off.
void AddShapes(const StoredShapes& stored, const std::vector<int>& fields, v1::MapTree& tree) {
  for (std::size_t e = 0; e < stored.element_meshes.size(); ++e) {
    const auto element = static_cast<Eigen::Index>(e);
    tree.add_meshes(stored.element_meshes[e]);
    tree.add_shape_errors(stored.shape_errors[element]);
    for (const int field : fields) tree.add_field_errors(stored.field_errors(field, element));
  }
}

}  // namespace

MapStream::MapStream(std::shared_ptr<const LoadedMap> map, LoadedShapes* shapes,
                     std::size_t structure, ShapeDemand demand)
    : map_(std::move(map)), shapes_(shapes), structure_(structure), demand_(std::move(demand)) {
  AddTree();
}

void MapStream::AddTree() {
  v1::MapTree tree = ExportTree(map_->structures[structure_], demand_.metrics);
  if (demand_.geometry != v1::GEOMETRY_KIND_UNSPECIFIED) {
    const StoredShapes& stored = map_->shapes[structure_].stored;
    AddShapes(stored, demand_.fields, tree);
    for (std::size_t m = 0; m < stored.meshes.size(); ++m) {
      for (const auto& [sample, file] : stored.meshes[m].shapes) {
        samples_.emplace_back(static_cast<int>(m), sample);
      }
    }
  }
  for (v1::MapTree& part : CutTree(tree)) *ready_.emplace_back().mutable_tree() = std::move(part);
}

absl::Status MapStream::AddMesh(int mesh) {
  const StoredMesh& stored = map_->shapes[structure_].stored.meshes[static_cast<std::size_t>(mesh)];
  MORTISE_ASSIGN_OR_RETURN(const auto canonical, shapes_->Mesh(stored.file));
  for (v1::MapMesh& part : MeshMessages(*canonical, static_cast<int>(structure_), mesh,
                                        demand_.geometry, kMostBytesOfPart)) {
    *ready_.emplace_back().mutable_mesh() = std::move(part);
  }
  return absl::OkStatus();
}

absl::Status MapStream::AddSample(int mesh, int sample) {
  const StoredMesh& stored = map_->shapes[structure_].stored.meshes[static_cast<std::size_t>(mesh)];
  MORTISE_ASSIGN_OR_RETURN(const auto canonical, shapes_->Mesh(stored.file));
  MORTISE_ASSIGN_OR_RETURN(const auto shape, shapes_->Shape(stored.file, stored.shapes.at(sample)));
  BlendedParts parts{demand_.geometry == v1::SURFACE, {}};
  for (const int f : demand_.fields) {
    const v1::MapShapes::Field& field = map_->record.shapes().fields(f);
    const int number = canonical->FindField(field.name(), field.load_case());
    // Structures may have different load cases.
    if (number >= 0) parts.fields.push_back(number);
  }
  const WeightedShape whole{shape.get(), 1};
  MORTISE_RETURN_IF_ERROR(Blend({&whole, 1}, *canonical, parts, scratch_));
  v1::MapShape message;
  SetShape(scratch_, *canonical, message);
  v1::MapExportPart::Sample exported;
  exported.set_sample(sample);
  exported.set_mesh(mesh);
  exported.mutable_positions()->swap(*message.mutable_positions());
  exported.mutable_fields()->Swap(message.mutable_fields());
  for (v1::MapExportPart::Sample& part : CutSample(exported)) {
    *ready_.emplace_back().mutable_sample() = std::move(part);
  }
  return absl::OkStatus();
}

absl::StatusOr<std::optional<v1::MapExportPart>> MapStream::Next() {
  const bool with_shapes = demand_.geometry != v1::GEOMETRY_KIND_UNSPECIFIED;
  while (ready_.empty()) {
    if (with_shapes &&
        next_mesh_ < static_cast<int>(map_->shapes[structure_].stored.meshes.size())) {
      MORTISE_RETURN_IF_ERROR(AddMesh(next_mesh_++));
    } else if (next_sample_ < samples_.size()) {
      const auto [mesh, sample] = samples_[next_sample_++];
      MORTISE_RETURN_IF_ERROR(AddSample(mesh, sample));
    } else {
      return std::nullopt;
    }
  }
  std::optional<v1::MapExportPart> part = std::move(ready_.front());
  ready_.pop_front();
  return part;
}

}  // namespace mortise::interpolator
