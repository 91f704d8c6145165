// Template revisions from the catalog, each with all that it uses, for services that evaluate them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "common/rpc/channel.h"

namespace mortise::v1 {
class TemplateBundle;
}

namespace mortise::bundles {

// Returns a revision of a template, or the latest for 0, with its items, its materials and as many
// of its shapes as fit into a message; the names of the others are in `more_shapes`
// (ShapeSource::AddMore). NOT_FOUND; INVALID_ARGUMENT as the catalog tells it; UNAVAILABLE.
absl::StatusOr<v1::TemplateBundle> FetchBundle(const std::shared_ptr<grpc::Channel>& catalog,
                                               const std::string& name, std::int64_t revision,
                                               const rpc::Origin& origin);

// Whether a failure to get a template says nothing about it, but that the catalog could not answer
// now: it is gone, has too much to do or too little time.
bool IsPassingFailure(const absl::Status& status);

// Returns the SHA-256 of all that results depend on: the template's own digest does not see its
// items and materials change. By which external ids and labels they are found, and who created
// them, does not count.
std::string ContentDigest(const v1::TemplateBundle& bundle);

}  // namespace mortise::bundles
