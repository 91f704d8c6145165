// Methods of CatalogService about shapes; catalog.proto says what each does.
#pragma once

#include <memory>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/stream_writer.h"
#include "common/store/store.h"
#include "mortise/v1/catalog.pb.h"
#include "services/catalog/service/catalog.h"

namespace mortise::catalog::methods {

// Reads the file, which takes a while, before the transaction of ImportShape.
absl::StatusOr<v1::Shape> PrepareShape(const rpc::Call& call, const v1::ImportShapeRequest& asked);
absl::StatusOr<v1::Shape> ImportShape(const rpc::Call& call, const v1::ImportShapeRequest& asked,
                                      v1::Shape& shape, store::Transaction& transaction);
absl::StatusOr<v1::Shape> GetShape(Catalog& catalog, const rpc::Call& call,
                                   const v1::GetShapeRequest& asked);
absl::Status DownloadShape(Catalog& catalog, const rpc::Call& call,
                           const v1::DownloadShapeRequest& asked,
                           const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer);

}  // namespace mortise::catalog::methods
