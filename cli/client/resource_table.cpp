#include "cli/client/resource_table.h"

#include <google/protobuf/timestamp.pb.h>
#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <iterator>

#include "absl/strings/ascii.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"

namespace mortise::cli {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

constexpr const char* kTitles[] = {"name",    "about",   "shapes",       "state",
                                   "created", "creator", "external ids", "labels"};

}  // namespace

std::string LabelsText(const Tags& tags) {
  return absl::StrJoin(tags.labels, ", ", absl::PairFormatter("="));
}

std::string CreateTimeText(const Message& resource, absl::TimeZone zone) {
  const FieldDescriptor* const field = resource.GetDescriptor()->FindFieldByName("create_time");
  if (field == nullptr || !resource.GetReflection()->HasField(resource, field)) return "";
  google::protobuf::Timestamp time;
  time.CopyFrom(resource.GetReflection()->GetMessage(resource, field));
  const auto micros = google::protobuf::util::TimeUtil::TimestampToMicroseconds(time);
  return absl::FormatTime("%E4Y-%m-%d %H:%M", absl::FromUnixMicros(micros), zone);
}

void ResourceTable::Add(const ResourceKind& kind, const Message& resource) {
  const Tags tags = TagsOf(resource);
  const std::string state = absl::AsciiStrToLower(TextOfField(resource, "state"));
  rows_.push_back({TextOfField(resource, "name"), TextOfField(resource, kind.about),
                   absl::AsciiStrToLower(TextOfField(resource, kind.geometry)),
                   absl::StrReplaceAll(state, {{"_", "-"}}), CreateTimeText(resource, zone_),
                   TextOfField(resource, "creator"), absl::StrJoin(tags.external_ids, ", "),
                   LabelsText(tags)});
}

void ResourceTable::Print(const Output& output) const {
  std::vector<std::string> titles;
  std::vector<std::vector<std::string>> rows(rows_.size());
  for (std::size_t column = 0; column < std::size(kTitles); ++column) {
    const bool is_empty = std::all_of(rows_.begin(), rows_.end(),
                                      [&](const auto& row) { return row[column].empty(); });
    if (is_empty && column > 0) continue;
    titles.emplace_back(kTitles[column]);
    for (std::size_t row = 0; row < rows_.size(); ++row) rows[row].push_back(rows_[row][column]);
  }
  output.Table(titles, rows);
}

}  // namespace mortise::cli
