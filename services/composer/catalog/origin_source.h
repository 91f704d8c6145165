// The designs of the catalog that components come from.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "common/bundles/shape_source.h"
#include "common/rpc/channel.h"
#include "services/composer/records/drawing.h"

namespace mortise::composer {

// A revision of a template as it is composed of.
struct ComponentOrigin {
  std::string template_name;  // templates/{id}
  std::int64_t revision = 0;
  std::string group;  // node of its assembly that the template is of; empty for the whole
  std::shared_ptr<const Drawing> drawing;  // of its whole assembly
};

// Thread safe.
class OriginSource {
 public:
  explicit OriginSource(std::shared_ptr<grpc::Channel> catalog);

  // The revision of a template, or the latest for 0. NOT_FOUND; INVALID_ARGUMENT naming "template"
  // (also of one that is no assembly) or "template_revision"; UNAVAILABLE.
  absl::StatusOr<ComponentOrigin> Get(const std::string& name, std::int64_t revision,
                                      const rpc::Origin& caller);

 private:
  const std::shared_ptr<grpc::Channel> catalog_;
  bundles::ShapeSource shapes_;
};

}  // namespace mortise::composer
