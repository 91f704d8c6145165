// An index that is being built.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/store/store.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/descriptors/descriptor.h"

namespace mortise::retrieval {

struct IndexTarget {
  v1::ShapeDescriptor kind = v1::D2;
  std::string id;
  std::shared_ptr<const Descriptor> descriptor;
  double delta = 0;
  // Templates that are covered; all without.
  std::optional<std::set<std::string>> wanted = {};

  bool Wants(const std::string& template_name) const {
    return !wanted || wanted->contains(template_name);
  }
};

// The descriptors that a request names, or all, each once.
std::vector<v1::ShapeDescriptor> DescriptorsOf(const v1::BuildIndexRequest& request);

// What a request asks for. δ is the request's, or what the index has, or a default.
absl::StatusOr<std::vector<IndexTarget>> TargetsOf(const v1::BuildIndexRequest& request,
                                                   store::Store& store);

}  // namespace mortise::retrieval
