// The files of covers and indexes, in the blob folder.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/descriptors/descriptor.h"
#include "services/retrieval/index/primitive_index.h"

namespace mortise::store {
class BlobFolder;
}

namespace mortise::retrieval {

// Stores a file; its digest. One that was damaged since it was stored is written again.
absl::StatusOr<std::string> StoreCoverFile(store::BlobFolder& blobs, std::string_view bytes);

// The primitives of a cover, as family 0. Fails as ReadIndex; DATA_LOSS where the file has others
// than it says, or is not of one family.
absl::StatusOr<FamilyCover> ReadCover(store::BlobFolder& blobs, const std::string& sha256,
                                      const Descriptor& descriptor);

// Says of a family what its primitives are: points, tangents, structures.
void CountPrimitives(const FamilyCover& cover, v1::ShapeIndex::Family* family);

}  // namespace mortise::retrieval
