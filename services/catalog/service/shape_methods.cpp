#include "services/catalog/service/shape_methods.h"

#include <string>
#include <utility>

#include "common/base/errors.h"
#include "common/host/call_author.h"
#include "common/host/chunk_stream.h"
#include "common/resources/collection.h"
#include "services/catalog/exchange/shape_file.h"
#include "services/catalog/records/shape_records.h"

namespace mortise::catalog::methods {
namespace {

absl::StatusOr<v1::Shape> FindShape(const Catalog& catalog, const std::string& name) {
  return resources::ReadFrom<v1::Shape>(*catalog.store, [&](store::ReadTransaction& transaction) {
    return catalog::GetShape(transaction, name);
  });
}

}  // namespace

absl::StatusOr<v1::Shape> PrepareShape(const rpc::Call&, const v1::ImportShapeRequest& asked) {
  return ReadShape(asked);
}

absl::StatusOr<v1::Shape> ImportShape(const rpc::Call& call, const v1::ImportShapeRequest&,
                                      v1::Shape& shape, store::Transaction& transaction) {
  return catalog::ImportShape(transaction, shape, rpc::AuthorOf(call));
}

absl::StatusOr<v1::Shape> GetShape(Catalog& catalog, const rpc::Call&,
                                   const v1::GetShapeRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(v1::Shape shape, FindShape(catalog, asked.name()));
  return ShownShape(std::move(shape));
}

absl::Status DownloadShape(Catalog& catalog, const rpc::Call&,
                           const v1::DownloadShapeRequest& asked,
                           const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer) {
  MORTISE_ASSIGN_OR_RETURN(const v1::Shape shape, FindShape(catalog, asked.name()));
  rpc::StreamBytes(shape.SerializeAsString(), {"shape.binpb", "application/x-protobuf"}, writer);
  return absl::OkStatus();
}

}  // namespace mortise::catalog::methods
