#include "common/files/json_message.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/util/json_util.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/messages/json_faults.h"
#include "common/messages/message_words.h"

namespace mortise::parametric {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::MessageFactory;
using Json = nlohmann::json;

constexpr std::size_t kMaxShown = 80;  // bytes
constexpr int kMaxNesting = 64;

// Takes what cannot be read out of a JSON object.
class Cleaner {
 public:
  Cleaner(std::vector<FieldViolation>& findings, UnreadFields& unread)
      : findings_(findings), unread_(unread) {}

  void CleanObject(Json& object, const Descriptor& type, const std::string& path) {
    for (auto entry = object.begin(); entry != object.end();) {
      const FieldDescriptor* const field = FieldOf(type, entry.key());
      const std::string place = absl::StrCat(path, path.empty() ? "" : ".",
                                             field == nullptr ? entry.key() : field->name());
      if (field == nullptr) {
        findings_.push_back({place, absl::StrCat("there is no field of this name",
                                                 FieldsOffered(entry.key(), type))});
        entry = object.erase(entry);
      } else if (!CleanField(entry.value(), *field, place)) {
        entry = object.erase(entry);
      } else {
        ++entry;
      }
    }
  }

 private:
  static const FieldDescriptor* FieldOf(const Descriptor& type, const std::string& key) {
    const FieldDescriptor* const field = type.FindFieldByName(key);
    if (field != nullptr) return field;
    for (int i = 0; i < type.field_count(); ++i) {
      if (type.field(i)->json_name() == key) return type.field(i);
    }
    return nullptr;
  }

  bool Fail(const std::string& place, std::string message) {
    findings_.push_back({place, std::move(message)});
    unread_.insert(place);
    return false;
  }

  // Whether there is anything left of it.
  bool CleanField(Json& value, const FieldDescriptor& field, const std::string& place) {
    if (value.is_null()) return true;
    if (field.is_map()) return CleanMap(value, field, place);
    if (!field.is_repeated()) return CleanValue(value, field, place);
    if (!value.is_array()) return Fail(place, "must be a list");
    for (std::size_t i = 0; i < value.size(); ++i) {
      // The others keep their places.
      if (CleanValue(value[i], field, absl::StrCat(place, "[", i, "]"))) continue;
      value[i] = field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE  ? Json::object()
                 : field.cpp_type() == FieldDescriptor::CPPTYPE_STRING ? Json("")
                 : field.cpp_type() == FieldDescriptor::CPPTYPE_BOOL   ? Json(false)
                                                                       : Json(0);
    }
    return true;
  }

  // Entries are named by their keys: labels["customer"].
  bool CleanMap(Json& map, const FieldDescriptor& field, const std::string& place) {
    if (!map.is_object()) return Fail(place, "must be an object");
    for (auto entry = map.begin(); entry != map.end();) {
      if (CanBeRead({{entry.key(), entry.value()}}, field)) {
        ++entry;
        continue;
      }
      Fail(absl::StrCat(place, "[\"", entry.key(), "\"]"),
           Refusal(entry.value(), *field.message_type()->map_value()));
      entry = map.erase(entry);
    }
    return true;
  }

  // What is said of a value that the field cannot have.
  static std::string Refusal(const Json& value, const FieldDescriptor& field) {
    const std::string shown = value.is_primitive() ? value.dump() + " " : "";
    return absl::StrCat(shown.size() > kMaxShown ? "" : shown, WantedValue(field));
  }

  bool CleanValue(Json& value, const FieldDescriptor& field, const std::string& place) {
    const bool is_message = field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
    const bool is_plain = is_message && !HasSpecialJson(*field.message_type());
    if (is_plain) {
      if (!value.is_object()) return Fail(place, "must be an object");
      CleanObject(value, *field.message_type(), place);
      return true;
    }
    if (CanBeRead(value, field)) return true;
    Fail(place, Refusal(value, field));
    if (field.cpp_type() != FieldDescriptor::CPPTYPE_DOUBLE) return false;
    value = "NaN";  // as unread numbers are
    return true;
  }

  static bool CanBeRead(const Json& value, const FieldDescriptor& field) {
    const std::unique_ptr<Message> scratch(
        MessageFactory::generated_factory()->GetPrototype(field.containing_type())->New());
    const Json whole = {
        {field.name(), field.is_repeated() && !field.is_map() ? Json::array({value}) : value}};
    return google::protobuf::util::JsonStringToMessage(whole.dump(), scratch.get()).ok();
  }

  std::vector<FieldViolation>& findings_;
  UnreadFields& unread_;
};

// Fields that are there twice, of which protobuf's reader takes the last.
std::vector<FieldViolation> RepeatedFields(std::string_view text, const Message& message) {
  std::vector<FieldViolation> findings;
  for (FieldViolation& fault :
       JsonFaults(text, *message.GetDescriptor(), google::protobuf::util::Status())) {
    findings.push_back({std::move(fault.field), std::move(fault.message)});
  }
  return findings;
}

}  // namespace

std::vector<FieldViolation> ReadJsonMessage(std::string_view text, Message& message,
                                            UnreadFields& unread) {
  using google::protobuf::StringPiece;
  using google::protobuf::util::JsonStringToMessage;
  const auto read = JsonStringToMessage(StringPiece(text.data(), text.size()), &message);
  std::vector<FieldViolation> repeated = RepeatedFields(text, message);
  if (read.ok()) return repeated;
  message.Clear();
  const auto is_shallow = [](int depth, Json::parse_event_t, const Json&) {
    return depth <= kMaxNesting;
  };
  Json object = Json::parse(text, is_shallow, /*allow_exceptions=*/false);
  if (!object.is_object()) return {{"", std::string(read.message())}};
  std::vector<FieldViolation> findings = std::move(repeated);
  Cleaner(findings, unread).CleanObject(object, *message.GetDescriptor(), "");
  const auto rest = JsonStringToMessage(object.dump(), &message);
  const auto& untold = rest.ok() ? read : rest;
  if (!rest.ok() || findings.empty()) findings.push_back({"", std::string(untold.message())});
  return findings;
}

}  // namespace mortise::parametric
