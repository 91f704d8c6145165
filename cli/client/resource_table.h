// Resources of any kind as a table for people: what every resource has, a row each.
#pragma once

#include <string>
#include <vector>

#include "absl/time/time.h"
#include "cli/client/output.h"
#include "cli/client/resource_access.h"

namespace mortise::cli {

class ResourceTable {
 public:
  explicit ResourceTable(absl::TimeZone zone) : zone_(zone) {}

  void Add(const ResourceKind& kind, const google::protobuf::Message& resource);

  // Columns in which nothing stands are left out, but for the names.
  void Print(const Output& output) const;

 private:
  const absl::TimeZone zone_;  // that times are shown in
  std::vector<std::vector<std::string>> rows_;
};

// "customer=acme, order=17".
std::string LabelsText(const Tags& tags);

// When a resource was made, to the minute; empty where that is not known.
std::string CreateTimeText(const google::protobuf::Message& resource, absl::TimeZone zone);

}  // namespace mortise::cli
