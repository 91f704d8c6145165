// The templates of the catalog, as families that can be searched.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/base/single_flight_cache.h"
#include "common/bundles/bundle_source.h"
#include "common/bundles/shape_source.h"
#include "common/rpc/channel.h"
#include "common/templates/template.h"
#include "mortise/v1/catalog.pb.h"
#include "services/retrieval/families/parameter_domain.h"

namespace mortise::retrieval {

// A template revision ready for evaluation.
struct SearchedTemplate {
  std::string name;  // templates/{id}
  std::int64_t revision = 0;
  std::string digest;  // bundles::ContentDigest, with the group
  std::string title;
  std::string group;  // of its assembly, whose sub-tree it is; empty for the whole
  std::shared_ptr<const templates::Template> design_template;
  std::shared_ptr<const KeptDomain> domain;  // of its parameters
};

// Returns the groups of the template's assembly that are things by themselves (DistinctSubTrees):
// each can be got as a template. None for other kinds of templates, and for a sub-tree. It takes up
// to seconds for assemblies of hundreds of parts.
std::vector<std::string> GroupsOf(const SearchedTemplate& whole);

using bundles::IsPassingFailure;

// Thread safe.
class TemplateSource {
 public:
  // `capacity`: bytes of compiled revisions that are kept, the least recently used forgotten first.
  explicit TemplateSource(std::shared_ptr<grpc::Channel> catalog,
                          std::size_t capacity = std::size_t{256} << 20);

  // Returns the latest revisions that meet the filter, by name, without what they are made of.
  // UNAVAILABLE; INVALID_ARGUMENT as the catalog tells it.
  absl::StatusOr<std::vector<v1::Template>> List(const v1::ResourceFilter& filter,
                                                 const rpc::Origin& origin,
                                                 const rpc::RetryOptions& retry = {}) const;

  // Return all materials/{id} and items/{id} that there are. Fail as List.
  absl::StatusOr<std::vector<std::string>> MaterialNames(const rpc::Origin& origin) const;
  absl::StatusOr<std::vector<std::string>> ItemNames(const rpc::Origin& origin) const;

  // Returns the revision, or the latest for 0; the catalog is asked for what is not kept.
  // NOT_FOUND; INVALID_ARGUMENT naming "template", "template_revision" or "group"; as
  // IsPassingFailure; as templates::Compile.
  //
  // With a `group` of an assembly template the sub-tree below it, as a template by itself: its
  // parameters are sizes of its own that can be chosen independently, and it has no conditions,
  // which speak of the whole.
  absl::StatusOr<std::shared_ptr<const SearchedTemplate>> Get(const std::string& name,
                                                              std::int64_t revision,
                                                              const rpc::Origin& origin,
                                                              const std::string& group = "");

 private:
  using Kept = SingleFlightCache<std::shared_ptr<const SearchedTemplate>>;

  const std::shared_ptr<grpc::Channel> catalog_;
  bundles::ShapeSource shapes_;
  Kept kept_;  // by name, revision and group
};

}  // namespace mortise::retrieval
