// Walks through the text once, with the types of the message beside it.
#include "common/messages/json_faults.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "common/base/decimal_number.h"
#include "common/messages/message_words.h"

namespace mortise {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using Json = nlohmann::json;

constexpr std::size_t kMost = 40;         // violations, about as many as an answer holds
constexpr std::size_t kMaxNesting = 100;  // as protobuf's reader
constexpr std::size_t kMaxShown = 80;     // bytes

constexpr char kObject[] = "must be an object";

template <typename Integer>
bool IsInteger(const Json& value) {
  if (value.is_string()) {
    Integer parsed = 0;
    return absl::SimpleAtoi(value.get_ref<const std::string&>(), &parsed);
  }
  if (value.is_number_unsigned()) return std::in_range<Integer>(value.get<std::uint64_t>());
  if (value.is_number_integer()) return std::in_range<Integer>(value.get<std::int64_t>());
  if (!value.is_number_float()) return false;
  const double number = value.get<double>();
  // The largest is rounded up to a power of two if it is one of 64 bits.
  return number == std::trunc(number) &&
         number >= static_cast<double>(std::numeric_limits<Integer>::min()) &&
         number <= static_cast<double>(std::numeric_limits<Integer>::max());
}

bool IsNumber(const Json& value, double largest) {
  if (value.is_number()) return std::abs(value.get<double>()) <= largest;
  if (!value.is_string()) return false;
  const std::string& text = value.get_ref<const std::string&>();
  if (text == "NaN" || text == "Infinity" || text == "-Infinity") return true;
  const std::optional<double> parsed = DecimalNumber(text);
  return parsed && std::abs(*parsed) <= largest;
}

bool IsValueOf(const google::protobuf::EnumDescriptor& type, const Json& value) {
  if (!value.is_string()) return IsInteger<std::int32_t>(value);
  const std::string& text = value.get_ref<const std::string&>();
  return type.FindValueByName(text) != nullptr || IsInteger<std::int32_t>(value);
}

bool IsBase64(const Json& value) {
  std::string bytes;
  return value.is_string() &&
         (absl::Base64Unescape(value.get_ref<const std::string&>(), &bytes) ||
          absl::WebSafeBase64Unescape(value.get_ref<const std::string&>(), &bytes));
}

// Whether a message can be written as this one value. Of those that nobody sends, all are taken.
bool IsWellKnown(const Descriptor& type, const Json& value) {
  using google::protobuf::util::TimeUtil;
  if (!HasSpecialJson(type)) return false;
  if (type.full_name() == "google.protobuf.Timestamp") {
    google::protobuf::Timestamp time;
    return value.is_string() && TimeUtil::FromString(value.get_ref<const std::string&>(), &time);
  }
  if (type.full_name() == "google.protobuf.Duration") {
    google::protobuf::Duration duration;
    return value.is_string() &&
           TimeUtil::FromString(value.get_ref<const std::string&>(), &duration);
  }
  return type.full_name() != "google.protobuf.FieldMask" || value.is_string();
}

// Whether a value that is neither object nor list can be one of `field`.
bool CanBe(const FieldDescriptor& field, const Json& value) {
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
      return value.is_boolean() || value == "true" || value == "false";
    case FieldDescriptor::CPPTYPE_INT32:
      return IsInteger<std::int32_t>(value);
    case FieldDescriptor::CPPTYPE_UINT32:
      return IsInteger<std::uint32_t>(value);
    case FieldDescriptor::CPPTYPE_INT64:
      return IsInteger<std::int64_t>(value);
    case FieldDescriptor::CPPTYPE_UINT64:
      return IsInteger<std::uint64_t>(value);
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return IsNumber(value, std::numeric_limits<double>::max());
    case FieldDescriptor::CPPTYPE_FLOAT:
      return IsNumber(value, std::numeric_limits<float>::max());
    case FieldDescriptor::CPPTYPE_ENUM:
      return IsValueOf(*field.enum_type(), value);
    case FieldDescriptor::CPPTYPE_STRING:
      return field.type() == FieldDescriptor::TYPE_BYTES ? IsBase64(value) : value.is_string();
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return IsWellKnown(*field.message_type(), value);
  }
  return true;
}

const FieldDescriptor* FieldOf(const Descriptor& type, const std::string& key) {
  if (const FieldDescriptor* const field = type.FindFieldByName(key)) return field;
  for (int i = 0; i < type.field_count(); ++i) {
    if (type.field(i)->json_name() == key) return type.field(i);
  }
  return nullptr;
}

// The number that libraries write as a bare word and JSON has not, as protobuf writes it, where
// reading `text` failed in that word, after `end` bytes; nothing where it failed otherwise.
std::string_view UnwritableNumber(std::string_view text, std::size_t end) {
  const auto belongs = [&](std::size_t i) {
    return absl::ascii_isalnum(static_cast<unsigned char>(text[i])) ||
           std::string_view("+-._").find(text[i]) != std::string_view::npos;
  };
  std::size_t begin = std::min(end, text.size());
  while (begin > 0 && belongs(begin - 1)) --begin;
  std::size_t after = begin;
  while (after < text.size() && belongs(after)) ++after;
  const std::string word =
      absl::AsciiStrToLower(absl::string_view(text.data() + begin, after - begin));
  if (word == "nan" || word == "-nan") return "NaN";
  if (word == "infinity" || word == "inf") return "Infinity";
  if (word == "-infinity" || word == "-inf") return "-Infinity";
  return {};
}

// An object or a list that the walk is in.
struct Frame {
  enum class Kind { kMessage, kMap, kList, kUnknown };
  Kind kind;
  const Descriptor* type = nullptr;        // of a message
  const FieldDescriptor* field = nullptr;  // that values belong to; null if none is known
  std::string key = {};                    // of a message or a map: the present one
  std::size_t index = 0;                   // of a list
  std::set<std::string> keys = {};         // that were there
  std::set<const google::protobuf::OneofDescriptor*> chosen = {};
};

class Walk : public nlohmann::json_sax<Json> {
 public:
  enum class Extent { kRepeatedKeys, kAll };

  Walk(std::string_view text, const Descriptor& type, Extent extent)
      : text_(text), type_(type), is_all_(extent == Extent::kAll) {}

  std::vector<FieldViolation> TakeFaults() { return std::move(faults_); }

  bool null() override {
    if (frames_.empty()) return Scalar(nullptr);
    const Frame& frame = frames_.back();
    // Protobuf's reader takes it for an entry with an empty value.
    if (frame.kind == Frame::Kind::kMap) {
      Add(absl::StrCat("null ", WantedValue(*frame.field)), Weight::kAlways);
    }
    return Next();
  }
  bool boolean(bool value) override { return Scalar(value); }
  bool number_integer(number_integer_t value) override { return Scalar(value); }
  bool number_unsigned(number_unsigned_t value) override { return Scalar(value); }
  bool number_float(number_float_t value, const string_t&) override { return Scalar(value); }
  bool string(string_t& value) override {
    if (!is_all_) CheckQuotedNumber(value);
    return Scalar(value);
  }
  bool binary(binary_t&) override { return false; }

  bool start_object(std::size_t) override {
    Frame frame{Frame::Kind::kUnknown};
    if (frames_.empty()) {
      frame = {Frame::Kind::kMessage, &type_};
    } else if (const FieldDescriptor* const field = Wants()) {
      const bool is_message = field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
      if (IsWholeMap(*field)) {
        frame = {Frame::Kind::kMap, nullptr, field->message_type()->map_value()};
      } else if (is_message && !HasSpecialJson(*field->message_type())) {
        frame = {Frame::Kind::kMessage, field->message_type()};
      } else if (!is_message) {
        Add(WantedValue(*field));
      }
    }
    return Enter(std::move(frame));
  }

  bool key(string_t& text) override {
    Frame& frame = frames_.back();
    if (frame.kind != Frame::Kind::kMessage) {
      frame.key = text;
      if (!frame.keys.insert(text).second) Add("is there twice", Weight::kAlways);
      return Goes();
    }
    frame.field = FieldOf(*frame.type, text);
    frame.key = frame.field == nullptr ? text : frame.field->name();
    if (frame.field == nullptr) {
      Add(absl::StrCat("there is no field of this name", FieldsOffered(text, *frame.type)));
    } else if (const auto* const oneof = frame.field->real_containing_oneof();
               oneof != nullptr && !frame.chosen.insert(oneof).second &&
               frame.keys.count(frame.key) == 0) {
      Add(absl::StrCat("only one of ", ChoiceNames(*oneof), " can be given"));
    }
    if (!frame.keys.insert(frame.key).second) Add("is there twice", Weight::kAlways);
    return Goes();
  }

  bool end_object() override { return Leave(); }

  bool start_array(std::size_t) override {
    if (frames_.empty()) {
      Add(kObject);
      return false;
    }
    Frame frame{Frame::Kind::kList};
    if (const FieldDescriptor* const field = Wants()) {
      const bool is_list = field->is_repeated() && !field->is_map();
      if (is_list && frames_.back().kind == Frame::Kind::kMessage) {
        frame.field = field;
      } else if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE ||
                 !HasSpecialJson(*field->message_type())) {
        Add(IsWholeMap(*field) ? kObject : WantedValue(*field));
      }
    }
    return Enter(std::move(frame));
  }

  bool end_array() override { return Leave(); }

  bool parse_error(std::size_t end, const std::string&, const Json::exception& error) override {
    if (const std::string_view number = UnwritableNumber(text_, end); !number.empty()) {
      const absl::string_view word(number.data(), number.size());
      Add(absl::StrCat("JSON has no ", word, "; write \"", word, "\", in quotes"), Weight::kAlways);
      return false;
    }
    // "[json.exception.parse_error.101] parse error at line 1, column 2: …"
    const std::string_view text = error.what();
    const std::size_t prefix = text.find("] ");
    const std::string message(prefix == std::string_view::npos ? text : text.substr(prefix + 2));
    if (dynamic_cast<const Json::out_of_range*>(&error) != nullptr && !frames_.empty()) {
      Add("is too large a number", Weight::kAlways);
    } else {
      faults_.push_back({"", message});
    }
    return false;
  }

 private:
  enum class Weight { kIfAll, kAlways };

  // Whether the value of `field` that comes is the map itself, and not a value in it.
  bool IsWholeMap(const FieldDescriptor& field) const {
    return field.is_map() && frames_.back().kind == Frame::Kind::kMessage;
  }

  // The field of the value that comes, in or below the topmost object; null if there is none.
  const FieldDescriptor* Wants() const { return frames_.back().field; }

  template <typename Value>
  bool Scalar(const Value& value) {
    if (is_all_) Check(value);
    return Next();
  }

  // Protobuf's reader takes hexadecimal where a number is in quotes; what else is no number it
  // refuses itself.
  void CheckQuotedNumber(std::string_view value) {
    const FieldDescriptor* const field = frames_.empty() ? nullptr : Wants();
    if (field == nullptr || IsWholeMap(*field)) return;
    const bool is_number = field->cpp_type() == FieldDescriptor::CPPTYPE_DOUBLE ||
                           field->cpp_type() == FieldDescriptor::CPPTYPE_FLOAT;
    std::string_view digits = value;
    if (digits.starts_with('-') || digits.starts_with('+')) digits.remove_prefix(1);
    if (!is_number || !(digits.starts_with("0x") || digits.starts_with("0X"))) return;
    const bool is_shown = value.size() <= kMaxShown;
    Add(is_shown ? absl::StrCat("\"", absl::string_view(value.data(), value.size()), "\" ",
                                WantedValue(*field))
                 : WantedValue(*field),
        Weight::kAlways);
  }

  void Check(const Json& value) {
    if (frames_.empty()) return Add(kObject);
    const FieldDescriptor* const field = Wants();
    if (field == nullptr) return;
    if (IsWholeMap(*field)) return Add(kObject);
    if (CanBe(*field, value)) return;
    const std::string wanted = WantedValue(*field);
    const std::string shown = value.dump(-1, ' ', false, Json::error_handler_t::replace);
    const bool is_shown = wanted != kObject && shown.size() <= kMaxShown;
    Add(absl::StrCat(is_shown ? shown + " " : "", wanted));
  }

  bool Enter(Frame frame) {
    if (frames_.size() == kMaxNesting) {
      faults_.push_back({"", "is nested too deeply"});
      return false;
    }
    frames_.push_back(std::move(frame));
    return Goes();
  }

  bool Leave() {
    frames_.pop_back();
    return Next();
  }

  // After a value.
  bool Next() {
    if (!frames_.empty()) ++frames_.back().index;
    return Goes();
  }

  bool Goes() const { return faults_.size() < kMost; }

  void Add(std::string message, Weight weight = Weight::kIfAll) {
    if (is_all_ || weight == Weight::kAlways) faults_.push_back({Place(), std::move(message)});
  }

  // The path of what is being read, such as "parameters[1].value".
  std::string Place() const {
    std::string place;
    for (const Frame& frame : frames_) {
      if (frame.kind == Frame::Kind::kList) {
        absl::StrAppend(&place, "[", frame.index, "]");
      } else if (frame.kind == Frame::Kind::kMap) {
        absl::StrAppend(&place, "[\"", frame.key, "\"]");
      } else if (!frame.key.empty()) {
        absl::StrAppend(&place, place.empty() ? "" : ".", frame.key);
      }
    }
    return place;
  }

  const std::string_view text_;
  const Descriptor& type_;
  const bool is_all_;
  std::vector<Frame> frames_;
  std::vector<FieldViolation> faults_;
};

// Protobuf's messages have the form "(parameters[0].value): invalid value …" or
// "(parameters[0]) foo: Cannot find field.", and "foo: Cannot find field." at the root.
FieldViolation ToldFirst(std::string_view message) {
  FieldViolation told;
  std::string_view rest = message;
  if (rest.starts_with('(')) {
    const auto end = rest.find(')');
    if (end != std::string_view::npos) {
      told.field = std::string(rest.substr(1, end - 1));
      rest.remove_prefix(end + 1);
      while (!rest.empty() && (rest.front() == ':' || rest.front() == ' ')) rest.remove_prefix(1);
    }
  }
  constexpr std::string_view kUnknown = ": Cannot find field.";
  if (rest.ends_with(kUnknown)) {
    const std::string name(rest.substr(0, rest.size() - kUnknown.size()));
    absl::StrAppend(&told.field, told.field.empty() ? "" : ".", name);
    rest = "there is no field of this name";
  }
  told.message = std::string(rest);
  return told;
}

// `path` up to the first map on it: protobuf's reader counts the entries of maps, which have no
// order, so that "labels[1].value" tells nobody which one it is.
std::string UpToMap(const std::string& path, const Descriptor& type) {
  const Descriptor* holder = &type;
  std::size_t begin = 0;
  while (holder != nullptr && begin < path.size()) {
    const std::size_t end = path.find_first_of(".[", begin);
    const std::size_t length = end == std::string::npos ? end : end - begin;
    const FieldDescriptor* const field = FieldOf(*holder, path.substr(begin, length));
    if (field == nullptr) return path;
    if (field->is_map()) return path.substr(0, end);
    const std::size_t dot = path.find('.', begin);
    if (dot == std::string::npos) return path;
    begin = dot + 1;
    holder = field->message_type();
  }
  return path;
}

bool LiesIn(std::string_view path, std::string_view field) {
  return path.starts_with(field) && (path.size() == field.size() || field.empty() ||
                                     path[field.size()] == '.' || path[field.size()] == '[');
}

}  // namespace

std::vector<FieldViolation> JsonFaults(std::string_view json, const Descriptor& type,
                                       const google::protobuf::util::Status& read) {
  Walk walk(json, type, read.ok() ? Walk::Extent::kRepeatedKeys : Walk::Extent::kAll);
  Json::sax_parse(json, &walk);
  std::vector<FieldViolation> faults = walk.TakeFaults();
  if (read.ok() || faults.size() >= kMost) return faults;
  const auto message = read.message();
  FieldViolation first = ToldFirst(std::string_view(message.data(), message.size()));
  first.field = UpToMap(first.field, type);
  // What the walk did not know to be one.
  const bool is_told = std::any_of(faults.begin(), faults.end(), [&](const FieldViolation& fault) {
    return LiesIn(fault.field, first.field) || LiesIn(first.field, fault.field);
  });
  if (!is_told) faults.insert(faults.begin(), std::move(first));
  return faults;
}

}  // namespace mortise
