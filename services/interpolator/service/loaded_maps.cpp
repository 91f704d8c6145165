#include "services/interpolator/service/loaded_maps.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/interpolator/service/map_records.h"

namespace mortise::interpolator {
namespace {

absl::Status Damaged(const v1::DesignMap& map, const std::string& why) {
  return WithDetail(
      absl::DataLossError(absl::StrCat("the file of ", map.name(), " cannot be used (", why,
                                       "); building the map again mends it")),
      {"MAP_DAMAGED", map.name()});
}

ServedShapes ReadyShapes(StoredShapes stored, const maps::RefinementTree& tree) {
  ServedShapes shapes{std::move(stored), maps::PackedWeights(tree), {}};
  const std::vector<int> elements = tree.Elements();
  shapes.order.assign(static_cast<std::size_t>(elements.back()) + 1, -1);
  for (std::size_t i = 0; i < elements.size(); ++i) {
    shapes.order[static_cast<std::size_t>(elements[i])] = static_cast<int>(i);
  }
  return shapes;
}

// What a structure takes in memory beside its metrics, about.
std::size_t BytesOf(const ServedShapes& shapes) {
  constexpr std::size_t kOfShape = 200;    // a digest in a map
  constexpr std::size_t kOfElement = 500;  // weights of its samples
  std::size_t files = 0;
  for (const StoredMesh& mesh : shapes.stored.meshes) files += mesh.shapes.size();
  return kOfShape * files + kOfElement * shapes.stored.element_meshes.size();
}

}  // namespace

LoadedMaps::LoadedMaps(store::Store* store, store::BlobFolder* blobs, std::size_t capacity)
    : store_(store), blobs_(blobs), kept_(capacity, Oversize::kAlone) {}

absl::StatusOr<std::shared_ptr<const LoadedMap>> LoadedMaps::Get(const std::string& name) {
  MORTISE_ASSIGN_OR_RETURN(v1::DesignMap record, kMaps.Get(*store_, name));
  return kept_.Get(name, [&] { return Load(std::move(record)); });
}

absl::StatusOr<LoadedMaps::Kept::Made> LoadedMaps::Load(v1::DesignMap record) const {
  const absl::StatusOr<std::string> bytes = blobs_->Get(record.sha256());
  if (absl::IsNotFound(bytes.status()) || absl::IsDataLoss(bytes.status())) {
    return Damaged(record, std::string(bytes.status().message()));
  }
  MORTISE_RETURN_IF_ERROR(bytes.status());
  auto structures = ParseMap(*bytes);
  if (!structures.ok()) return Damaged(record, std::string(structures.status().message()));
  if (static_cast<int>(structures->size()) != record.structures_size()) {
    return Damaged(record, "it is of another map");
  }
  auto loaded = std::make_shared<LoadedMap>();
  loaded->record = std::move(record);
  std::size_t kept = bytes->size();
  for (StoredStructure& structure : *structures) {
    kept += structure.map.packed_bytes();
    loaded->structures.push_back(std::move(structure.map));
  }
  // The weights refer to the trees, which stay where they are from now on.
  for (std::size_t s = 0; s < structures->size() && loaded->record.has_shapes(); ++s) {
    StoredShapes& stored = (*structures)[s].shapes;
    if (stored.element_meshes.empty()) return Damaged(loaded->record, "it has no shapes");
    loaded->shapes.push_back(ReadyShapes(std::move(stored), loaded->structures[s].tree()));
    kept += BytesOf(loaded->shapes.back());
  }
  return Kept::Made{std::move(loaded), kept};
}

}  // namespace mortise::interpolator
