#include "gateway/contract/query_message.h"

#include <google/protobuf/descriptor.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/messages/message_words.h"

namespace mortise::gateway {
namespace {

namespace pb = google::protobuf;
using QueryJson = nlohmann::json;

constexpr char kWholeMessage[] = "message";
constexpr char kTwice[] = "is given twice, or as a part of what is given whole";
constexpr std::size_t kDeepest = 16;       // steps of a path
constexpr std::size_t kLongestName = 128;  // of a parameter that is told back

// "parameters[0]": a field, and what stands in brackets behind it.
struct Step {
  std::string field;
  std::optional<std::string> key;
};

// Nothing for a path of another form.
std::optional<std::vector<Step>> ReadPath(std::string_view path) {
  std::vector<Step> steps;
  while (steps.size() < kDeepest) {
    const auto end = std::min(path.find_first_of(".["), path.size());
    Step step{std::string(path.substr(0, end)), std::nullopt};
    if (step.field.empty()) return std::nullopt;
    path.remove_prefix(end);
    if (path.starts_with('[')) {
      const auto close = path.find(']');
      if (close == std::string_view::npos) return std::nullopt;
      std::string_view key = path.substr(1, close - 1);
      if (key.size() >= 2 && key.front() == '"' && key.back() == '"') {
        key = key.substr(1, key.size() - 2);
      }
      step.key = std::string(key);
      path.remove_prefix(close + 1);
    }
    steps.push_back(std::move(step));
    if (path.empty()) return steps;
    if (!path.starts_with('.')) return std::nullopt;
    path.remove_prefix(1);
  }
  return std::nullopt;
}

const pb::FieldDescriptor* FindField(const pb::Descriptor& type, const std::string& name) {
  const pb::FieldDescriptor* field = type.FindFieldByName(name);
  if (field != nullptr) return field;
  field = type.FindFieldByCamelcaseName(name);
  return field != nullptr && field->json_name() == name ? field : nullptr;
}

QueryJson ValueOf(const pb::FieldDescriptor& field, const std::string& text) {
  const bool truth = field.cpp_type() == pb::FieldDescriptor::CPPTYPE_BOOL;
  if (truth && (text == "true" || text == "false")) return text == "true";
  return text;
}

// The element of `list` at `index`, which may be the one behind the last; null if it is further on.
QueryJson* ElementOf(QueryJson& list, const std::string& index) {
  uint32_t number = 0;
  const bool digits = !index.empty() && std::all_of(index.begin(), index.end(), [](char c) {
    return absl::ascii_isdigit(static_cast<unsigned char>(c));
  });
  if (!digits || !absl::SimpleAtoi(index, &number)) return nullptr;
  if (list.is_null()) list = QueryJson::array();
  if (number > list.size()) return nullptr;
  if (number == list.size()) list.push_back(nullptr);
  return &list[number];
}

// Builds the message, one parameter after another.
class Builder {
 public:
  explicit Builder(const pb::Descriptor& type) : type_(type) {}

  absl::Status Add(const std::string& name, const std::string& text) {
    const std::string shown = name.substr(0, kLongestName);
    const auto steps = ReadPath(name);
    if (!steps) return InvalidField(shown, "is not the path of a field, such as filter.creator");
    const pb::Descriptor* type = &type_;
    QueryJson* place = &message_;
    const pb::FieldDescriptor* field = nullptr;
    for (const Step& step : *steps) {
      field = type == nullptr ? nullptr : FindField(*type, step.field);
      if (field == nullptr) {
        return InvalidField(shown,
                            absl::StrCat("there is no such field",
                                         type == nullptr ? "" : FieldsOffered(step.field, *type)));
      }
      if (step.key.has_value() != field->is_repeated()) {
        return InvalidField(shown, field->is_repeated() ? "is a list or a map: give [0] or [KEY]"
                                                        : "is no list and no map");
      }
      if (!place->is_null() && !place->is_object()) return InvalidField(shown, kTwice);
      // One spelling of a field, so that two parameters do not give it twice.
      place = &(*place)[field->json_name()];
      if (field->is_map()) {
        place = &(*place)[*step.key];
        field = field->message_type()->map_value();
      } else if (step.key) {
        place = ElementOf(*place, *step.key);
        if (place == nullptr) return InvalidField(shown, "lists are counted from 0, without gaps");
      }
      type = field->message_type();
    }
    if (!place->is_null()) return InvalidField(shown, kTwice);
    *place = ValueOf(*field, text);
    return absl::OkStatus();
  }

  std::string Json() const {
    return message_.dump(-1, ' ', false, QueryJson::error_handler_t::replace);
  }

 private:
  const pb::Descriptor& type_;
  QueryJson message_ = QueryJson::object();
};

// "list[2]" before "list[10]", so that elements come in their order.
bool ComesBefore(const std::string& a, const std::string& b) {
  std::size_t i = 0;
  while (i < a.size() && i < b.size() && a[i] == b[i]) ++i;
  const auto digits = [i](const std::string& text) {
    std::size_t end = i;
    while (end < text.size() && absl::ascii_isdigit(static_cast<unsigned char>(text[end]))) ++end;
    return end - i;
  };
  const std::size_t in_a = digits(a);
  const std::size_t in_b = digits(b);
  return in_a == in_b ? a < b : in_a < in_b;
}

}  // namespace

absl::StatusOr<std::string> JsonOfQuery(const pb::Descriptor& type,
                                        const std::map<std::string, std::string>& parameters) {
  if (const auto whole = parameters.find(kWholeMessage);
      whole != parameters.end() && type.FindFieldByName(kWholeMessage) == nullptr) {
    if (parameters.size() == 1) return whole->second;
    return InvalidField(kWholeMessage, "is the whole request: give no other parameter beside it");
  }
  std::vector<std::string> names;
  for (const auto& [name, value] : parameters) names.push_back(name);
  std::sort(names.begin(), names.end(), ComesBefore);
  Builder builder(type);
  for (const std::string& name : names) {
    MORTISE_RETURN_IF_ERROR(builder.Add(name, parameters.at(name)));
  }
  return builder.Json();
}

}  // namespace mortise::gateway
