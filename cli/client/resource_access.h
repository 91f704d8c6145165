// Resources of any kind as messages whose type is not known before: lists of them, one by its name,
// and its external ids and labels.
#pragma once

#include <google/protobuf/message.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "cli/client/field_sources.h"
#include "cli/client/gateway_client.h"
#include "cli/client/resource_kinds.h"
#include "mortise/v1/types.pb.h"

namespace mortise::cli {

using Resource = std::unique_ptr<google::protobuf::Message>;

// Which resources of a kind are wanted.
struct ResourceQuery {
  v1::ResourceFilter filter = {};
  std::string subject = {};              // only those of this resource; of any if empty
  std::vector<std::string> states = {};  // only in one of these, such as "running"; any if empty
  int limit = 50;                        // at most so many, above 0
};

struct ResourceList {
  std::vector<Resource> resources;  // in the order of their List method
  bool has_more = false;            // than the query's limit
};

// Returns the resources of a kind that meet the query. INVALID_ARGUMENT naming "subject" and
// "states" where the kind has none, or no such state.
absl::StatusOr<ResourceList> ListResources(const GatewayClient& client, const ResourceKind& kind,
                                           const ResourceQuery& query);

// Returns one resource, at its latest revision. NOT_FOUND.
absl::StatusOr<Resource> GetResource(const GatewayClient& client, const ResourceKind& kind,
                                     const std::string& name);

struct Tags {
  std::vector<std::string> external_ids = {};
  std::map<std::string, std::string> labels = {};

  bool operator==(const Tags&) const = default;
};

Tags TagsOf(const google::protobuf::Message& resource);

// Gives a resource, as GetResource has it, these tags in place of its own, and returns it as it
// then is. Of what has revisions it is the next one, with the same content, and ABORTED,
// STALE_REVISION, if somebody else made one meanwhile. INVALID_ARGUMENT naming "external_ids" and
// "labels", or "name" where nobody changes those of its kind.
absl::StatusOr<Resource> ChangeTags(const GatewayClient& client, const ResourceKind& kind,
                                    const google::protobuf::Message& present, const Tags& tags);

// Returns the text of a singular field, within others where `path` has dots: enum values by their
// names. Empty if there is no such field or it is not set.
std::string TextOfField(const google::protobuf::Message& message, std::string_view path);

}  // namespace mortise::cli
