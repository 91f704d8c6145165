// What a STEP file says of a design besides its shapes: the numbers and revisions that other
// systems know it by.
#pragma once

#include <google/protobuf/repeated_field.h>
#include <google/protobuf/timestamp.pb.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/cad/step/step_assembly.h"
#include "common/design/evaluated_design.h"
#include "mortise/v1/item.pb.h"

namespace mortise::catalog {

// An item as the design's revision has it.
struct ItemIdentity {
  std::string external_id;  // the first; empty for none
  int64_t revision = 0;
};

struct DesignIdentity {
  cad::StepIdentity whole = {};  // external id and revision of the template or assembly
  std::string time_stamp = {};   // when that revision was made: "2026-11-26T20:25:30", UTC
  std::map<std::string, ItemIdentity> items = {};  // by name
};

// Returns the moment as a header of STEP has it; empty for 1970, which stands for none.
std::string StepTime(const google::protobuf::Timestamp& time);

// Returns the identity of a template or assembly that is made of these items.
template <class Resource>
DesignIdentity IdentityOf(const Resource& resource,
                          const google::protobuf::RepeatedPtrField<v1::Item>& items) {
  DesignIdentity identity;
  if (!resource.external_ids().empty()) identity.whole.id = resource.external_ids(0);
  identity.whole.revision = std::to_string(resource.revision());
  identity.time_stamp = StepTime(resource.create_time());
  for (const v1::Item& item : items) {
    identity.items[item.name()] = {item.external_ids().empty() ? "" : item.external_ids(0),
                                   item.revision()};
  }
  return identity;
}

// Returns that of a part's product: of what is bought as it is, the external id and revision of its
// item; of another, the revision of the design. The description names item, its revision and
// material: "items/pine-45x45, revision 2, materials/pine".
cad::StepIdentity ProductIdentity(const parametric::EvaluatedPart& part,
                                  const DesignIdentity& design);

// Takes the ids of products that have one in common, as those of an item whose pieces stand in the
// file one by one: whoever reads it would take them for one product that is drawn differently. They
// are called by their names, and their descriptions begin with the id.
void ShareNoIds(std::vector<cad::StepProduct>& products);

}  // namespace mortise::catalog
