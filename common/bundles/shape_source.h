// Exact surfaces of shapes from the catalog, kept by their content.
#pragma once

#include <cstddef>
#include <memory>
#include <set>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/base/single_flight_cache.h"
#include "common/rpc/channel.h"

namespace google::protobuf {
template <typename Element>
class RepeatedPtrField;
}
namespace mortise::v1 {
class Shape;
class TemplateBundle;
}  // namespace mortise::v1

namespace mortise::bundles {

// Thread safe.
class ShapeSource {
 public:
  // Keeps up to `capacity` bytes of surfaces, the least recently used forgotten first; what is
  // asked for by several at the same time is fetched once.
  ShapeSource(std::shared_ptr<grpc::Channel> catalog, std::size_t capacity,
              std::size_t largest = std::size_t{256} << 20);

  // Gives a shape that has exact surfaces, but not here, its own. What arrives is checked against
  // the shape's name, the digest of its content. NOT_FOUND naming a shape that the catalog does not
  // have; RESOURCE_EXHAUSTED for one of more than `largest` bytes; DATA_LOSS for one that is
  // damaged; UNAVAILABLE.
  absl::Status AddExact(v1::Shape& shape, const rpc::Origin& origin);

  // The same for several.
  absl::Status AddExact(google::protobuf::RepeatedPtrField<v1::Shape>& shapes,
                        const rpc::Origin& origin);

  // Fetches the shapes that did not fit into the bundle's message: those named in `exact` with
  // their exact surfaces, the others without. Fails as AddExact does.
  absl::Status AddMore(v1::TemplateBundle& bundle, const std::set<std::string>& exact,
                       const rpc::Origin& origin);

 private:
  using Surfaces = SingleFlightCache<std::shared_ptr<const std::string>>;

  absl::StatusOr<v1::Shape> Download(const std::string& name, const rpc::Origin& origin);

  const std::shared_ptr<grpc::Channel> catalog_;
  const std::size_t largest_;  // bytes of one shape
  Surfaces surfaces_;          // by name
};

}  // namespace mortise::bundles
