// Which resources a list has, by what every resource has: external ids, labels, creator and time.
#pragma once

#include <google/protobuf/timestamp.pb.h>

#include "absl/status/statusor.h"
#include "common/resources/resource_tags.h"
#include "mortise/v1/types.pb.h"

namespace mortise::resources {

class ResourceFilter {
 public:
  // INVALID_ARGUMENT naming "filter.labels", "filter.created_from" and so on: what no resource can
  // have, and times that are none or in the wrong order.
  static absl::StatusOr<ResourceFilter> Create(const v1::ResourceFilter& filter);

  // Returns the filter of a List method's request.
  template <typename Request>
  static absl::StatusOr<ResourceFilter> Of(const Request& request) {
    return Create(request.filter());
  }

  // Whether a resource meets every part of the filter. `Message` is that of any resource. A
  // resource without a time of creation meets no filter by time.
  template <typename Message>
  bool Matches(const Message& resource) const {
    return Matches(resource.external_ids(), resource.labels(), resource.creator(),
                   resource.has_create_time() ? &resource.create_time() : nullptr);
  }

 private:
  explicit ResourceFilter(const v1::ResourceFilter& filter) : filter_(filter) {}

  bool Matches(const ExternalIds& external_ids, const Labels& labels, const std::string& creator,
               const google::protobuf::Timestamp* created) const;
  bool TakesLabels(const Labels& labels) const;
  bool TakesTime(const google::protobuf::Timestamp* created) const;

  const v1::ResourceFilter filter_;
};

}  // namespace mortise::resources
