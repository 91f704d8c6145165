#include "common/resources/resource_filter.h"

#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"

namespace mortise::resources {
namespace {

using google::protobuf::Timestamp;
using google::protobuf::util::TimeUtil;

constexpr int kMaxCreatorBytes = 200;

bool IsTime(const Timestamp& time) {
  return time.seconds() >= TimeUtil::kTimestampMinSeconds &&
         time.seconds() <= TimeUtil::kTimestampMaxSeconds && time.nanos() >= 0 &&
         time.nanos() < 1'000'000'000;
}

void CheckTimes(const v1::ResourceFilter& filter, std::vector<FieldViolation>& violations) {
  const bool from_is_time = !filter.has_created_from() || IsTime(filter.created_from());
  const bool before_is_time = !filter.has_created_before() || IsTime(filter.created_before());
  if (!from_is_time) violations.push_back({"created_from", "is no time of the years 1 to 9999"});
  if (!before_is_time) {
    violations.push_back({"created_before", "is no time of the years 1 to 9999"});
  }
  if (filter.has_created_from() && filter.has_created_before() && from_is_time && before_is_time &&
      filter.created_before() <= filter.created_from()) {
    violations.push_back({"created_before", "must be after created_from"});
  }
}

}  // namespace

absl::StatusOr<ResourceFilter> ResourceFilter::Create(const v1::ResourceFilter& filter) {
  ExternalIds wanted;
  if (!filter.external_id().empty()) *wanted.Add() = filter.external_id();
  std::vector<FieldViolation> violations;
  for (FieldViolation& violation : CheckTags(wanted, filter.labels())) {
    if (violation.field == "external_ids[0]") violation.field = "external_id";
    violations.push_back(std::move(violation));
  }
  if (filter.creator().size() > kMaxCreatorBytes) {
    violations.push_back({"creator", absl::StrCat("has more than ", kMaxCreatorBytes, " bytes")});
  }
  CheckTimes(filter, violations);
  if (!violations.empty()) return UnderField("filter", InvalidFields(violations));
  return ResourceFilter(filter);
}

bool ResourceFilter::Matches(const ExternalIds& external_ids, const Labels& labels,
                             const std::string& creator, const Timestamp* created) const {
  const std::string& id = filter_.external_id();
  return (id.empty() ||
          std::find(external_ids.begin(), external_ids.end(), id) != external_ids.end()) &&
         (filter_.creator().empty() || filter_.creator() == creator) && TakesLabels(labels) &&
         TakesTime(created);
}

bool ResourceFilter::TakesLabels(const Labels& labels) const {
  const Labels& wanted = filter_.labels();
  return std::all_of(wanted.begin(), wanted.end(), [&labels](const auto& label) {
    const auto found = labels.find(label.first);
    return found != labels.end() && (label.second.empty() || label.second == found->second);
  });
}

bool ResourceFilter::TakesTime(const Timestamp* created) const {
  if (!filter_.has_created_from() && !filter_.has_created_before()) return true;
  if (created == nullptr) return false;
  return (!filter_.has_created_from() || *created >= filter_.created_from()) &&
         (!filter_.has_created_before() || *created < filter_.created_before());
}

}  // namespace mortise::resources
