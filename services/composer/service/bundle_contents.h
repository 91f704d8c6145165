// The items and materials of a drawing as structs, by which designs are weighed and priced.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "common/design/template_definition.h"
#include "mortise/v1/assembly.pb.h"

namespace mortise::composer {

struct BundleContents {
  std::vector<parametric::Item> items;
  std::vector<parametric::Material> materials;
};

// Fails as parametric::FromProto of what is damaged.
absl::StatusOr<BundleContents> ContentsOf(const v1::AssemblyBundle& bundle);

}  // namespace mortise::composer
