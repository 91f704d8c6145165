#include "services/simulator/shape_source.h"

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/parametric/shape_codec.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::simulator {

ShapeSource::ShapeSource(std::shared_ptr<grpc::Channel> catalog, std::size_t capacity,
                         std::size_t largest)
    : catalog_(std::move(catalog)), capacity_(capacity), largest_(largest) {}

absl::Status ShapeSource::AddExact(v1::Shape& shape, const rpc::Origin& origin) {
  if (!shape.exact() || !shape.brep().empty()) return absl::OkStatus();
  std::shared_ptr<const std::string> brep = Find(shape.name());
  if (brep == nullptr) {
    MORTISE_ASSIGN_OR_RETURN(v1::Shape downloaded, Download(shape.name(), origin));
    brep = std::make_shared<const std::string>(std::move(*downloaded.mutable_brep()));
    Keep({shape.name(), brep});
  }
  shape.set_brep(*brep);
  return absl::OkStatus();
}

absl::Status ShapeSource::AddExact(google::protobuf::RepeatedPtrField<v1::Shape>& shapes,
                                   const rpc::Origin& origin) {
  for (v1::Shape& shape : shapes) MORTISE_RETURN_IF_ERROR(AddExact(shape, origin));
  return absl::OkStatus();
}

absl::Status ShapeSource::AddMore(v1::TemplateBundle& bundle, const rpc::Origin& origin) {
  for (const std::string& name : bundle.more_shapes()) {
    MORTISE_ASSIGN_OR_RETURN(*bundle.add_shapes(), Download(name, origin));
  }
  bundle.clear_more_shapes();
  return absl::OkStatus();
}

std::shared_ptr<const std::string> ShapeSource::Find(const std::string& name) {
  const std::lock_guard lock(mutex_);
  const auto found =
      std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) { return kept.name == name; });
  if (found == kept_.end()) return nullptr;
  kept_.splice(kept_.begin(), kept_, found);
  return kept_.front().brep;
}

void ShapeSource::Keep(Kept kept) {
  const std::lock_guard lock(mutex_);
  kept_bytes_ += kept.brep->size();
  kept_.push_front(std::move(kept));
  while (kept_bytes_ > capacity_) {
    kept_bytes_ -= kept_.back().brep->size();
    kept_.pop_back();
  }
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

}  // namespace mortise::simulator
