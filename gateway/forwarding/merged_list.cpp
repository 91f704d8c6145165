#include "gateway/forwarding/merged_list.h"

#include <nlohmann/json.hpp>

#include "absl/strings/escaping.h"

namespace mortise::gateway {
namespace {

using Json = nlohmann::json;

}  // namespace

absl::StatusOr<MergePosition> ParseMergeToken(std::string_view text,
                                              const std::vector<std::string>& sources) {
  MergePosition position;
  if (text.empty()) {
    for (const std::string& source : sources) position[source];
    return position;
  }
  std::string decoded;
  if (!absl::WebSafeBase64Unescape(absl::string_view(text.data(), text.size()), &decoded)) {
    return resources::NotAPageToken();
  }
  const Json json = Json::parse(decoded, nullptr, false);
  if (!json.is_object()) return resources::NotAPageToken();
  for (const auto& [name, entry] : json.items()) {
    const bool known = std::find(sources.begin(), sources.end(), name) != sources.end();
    if (!known || !entry.is_array() || entry.size() != 3 || !entry[0].is_string() ||
        !entry[1].is_number_integer() || !entry[2].is_string()) {
      return resources::NotAPageToken();
    }
    const auto skip = entry[1].get<int64_t>();
    if (skip < 0 || skip >= resources::kMaxPageSize) return resources::NotAPageToken();
    position[name] = {entry[0].get<std::string>(), static_cast<int>(skip),
                      entry[2].get<std::string>()};
  }
  return position;
}

std::string FormatMergeToken(const MergePosition& position) {
  Json json = Json::object();
  for (const auto& [name, source] : position) json[name] = {source.token, source.skip, source.last};
  return absl::WebSafeBase64Escape(json.dump());
}

}  // namespace mortise::gateway
