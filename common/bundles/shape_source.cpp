#include "common/bundles/shape_source.h"

#include <grpcpp/grpcpp.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/codec/shape_codec.h"
#include "common/base/errors.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::bundles {

ShapeSource::ShapeSource(std::shared_ptr<grpc::Channel> catalog, std::size_t capacity,
                         std::size_t largest)
    : catalog_(std::move(catalog)), largest_(largest), surfaces_(capacity) {}

absl::Status ShapeSource::AddExact(v1::Shape& shape, const rpc::Origin& origin) {
  if (!shape.exact() || !shape.brep().empty()) return absl::OkStatus();
  MORTISE_ASSIGN_OR_RETURN(
      const std::shared_ptr<const std::string> brep,
      surfaces_.Get(shape.name(), [&]() -> absl::StatusOr<Surfaces::Made> {
        MORTISE_ASSIGN_OR_RETURN(v1::Shape downloaded, Download(shape.name(), origin));
        const auto bytes = downloaded.brep().capacity();
        return Surfaces::Made{
            std::make_shared<const std::string>(std::move(*downloaded.mutable_brep())), bytes};
      }));
  shape.set_brep(*brep);
  return absl::OkStatus();
}

absl::Status ShapeSource::AddExact(google::protobuf::RepeatedPtrField<v1::Shape>& shapes,
                                   const rpc::Origin& origin) {
  for (v1::Shape& shape : shapes) MORTISE_RETURN_IF_ERROR(AddExact(shape, origin));
  return absl::OkStatus();
}

absl::Status ShapeSource::AddMore(v1::TemplateBundle& bundle, const std::set<std::string>& exact,
                                  const rpc::Origin& origin) {
  for (const std::string& name : bundle.more_shapes()) {
    MORTISE_ASSIGN_OR_RETURN(v1::Shape shape, Download(name, origin));
    if (!exact.contains(name)) shape.clear_brep();
    *bundle.add_shapes() = std::move(shape);
  }
  bundle.clear_more_shapes();
  return absl::OkStatus();
}

absl::StatusOr<v1::Shape> ShapeSource::Download(const std::string& name,
                                                const rpc::Origin& origin) {
  const auto stub = v1::CatalogService::NewStub(catalog_);
  v1::DownloadShapeRequest request;
  request.set_name(name);
  std::string bytes;
  bool is_too_large = false;
  const absl::Status arrived = rpc::CallWithRetry(origin, {}, [&](grpc::ClientContext* context) {
    bytes.clear();
    const auto reader = stub->DownloadShape(context, request);
    v1::Chunk chunk;
    while (!is_too_large && reader->Read(&chunk)) {
      is_too_large = bytes.size() + chunk.data().size() > largest_;
      bytes += chunk.data();
    }
    if (is_too_large) context->TryCancel();
    return reader->Finish();
  });
  if (is_too_large) {
    return TooLarge(absl::StrCat(name, " with its exact surfaces"),
                    absl::StrCat(largest_, " bytes"));
  }
  MORTISE_RETURN_IF_ERROR(arrived);
  v1::Shape shape;
  // The kernel may crash over damaged surfaces.
  if (!shape.ParseFromString(bytes) || parametric::NameOf(shape) != name) {
    return absl::DataLossError(absl::StrCat(name, " did not arrive as the catalog keeps it"));
  }
  shape.set_name(name);
  return shape;
}

}  // namespace mortise::bundles
