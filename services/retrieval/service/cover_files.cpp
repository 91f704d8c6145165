#include "services/retrieval/service/cover_files.h"

#include <filesystem>
#include <set>

#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/store/blob_folder.h"
#include "services/retrieval/index/index_file.h"

namespace mortise::retrieval {

absl::StatusOr<std::string> StoreCoverFile(store::BlobFolder& blobs, std::string_view bytes) {
  const std::string digest = Sha256Hex(bytes);
  const absl::Status present = blobs.Get(digest).status();
  if (absl::IsDataLoss(present)) MORTISE_RETURN_IF_ERROR(blobs.Remove(digest));
  return blobs.Put(bytes);
}

absl::StatusOr<FamilyCover> ReadCover(store::BlobFolder& blobs, const std::string& sha256,
                                      const Descriptor& descriptor) {
  MORTISE_ASSIGN_OR_RETURN(const std::filesystem::path path, blobs.PathOf(sha256));
  MORTISE_ASSIGN_OR_RETURN(const StoredIndex alone, ReadIndex(path, FormatOf(descriptor)));
  const bool is_cover = alone.index.families() == 1 && alone.index.arrays().families[0] == 0 &&
                        alone.index.dimension() == descriptor.properties().dimension;
  if (!is_cover) return absl::DataLossError("the file is not a cover of one family");
  FamilyCover cover;
  cover.primitives.resize(static_cast<std::size_t>(alone.index.primitives()));
  for (int i = 0; i < alone.index.primitives(); ++i) {
    // The index has them in an order of its own.
    const auto number = static_cast<std::size_t>(
        alone.index.arrays().primitives[static_cast<std::size_t>(i)].number);
    if (number >= cover.primitives.size()) {
      return absl::DataLossError("a cover has other primitives than it says");
    }
    IndexMatch match;
    match.entry = i;
    cover.primitives[number] = alone.index.PrimitiveOf(match);
  }
  return cover;
}

void CountPrimitives(const FamilyCover& cover, v1::ShapeIndex::Family* family) {
  std::set<int> structures;
  int points = 0;
  for (const Primitive& primitive : cover.primitives) {
    structures.insert(primitive.structure);
    if (primitive.axes.cols() == 0) ++points;
  }
  family->set_structures(static_cast<int>(structures.size()));
  family->set_points(points);
  family->set_tangents(static_cast<int>(cover.primitives.size()) - points);
}

}  // namespace mortise::retrieval
