#include "services/interpolator/service/loaded_maps.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/interpolator/records/stored_map.h"
#include "services/interpolator/service/map_records.h"

namespace mortise::interpolator {
namespace {

absl::Status Damaged(const v1::DesignMap& map, const std::string& why) {
  return WithDetail(
      absl::DataLossError(absl::StrCat("the file of ", map.name(), " cannot be used (", why,
                                       "); building the map again mends it")),
      {"MAP_DAMAGED", map.name()});
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
  loaded->structures = *std::move(structures);
  std::size_t kept = bytes->size();
  for (const maps::InterpolationMap& structure : loaded->structures) {
    kept += structure.packed_bytes();
  }
  return Kept::Made{std::move(loaded), kept};
}

}  // namespace mortise::interpolator
