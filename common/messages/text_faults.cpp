// Walks through the tokens once, with the types of the message beside them.
#include "common/messages/text_faults.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <cstdint>
#include <limits>
#include <set>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "common/messages/message_words.h"

namespace mortise {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::io::Tokenizer;

constexpr std::size_t kMost = 40;  // faults, about as many as an answer holds
constexpr int kMaxNesting = 100;

// A value that is no message, as it was written.
struct Scalar {
  Tokenizer::Token token;
  bool is_negative = false;
};

// Whether a whole number is at most `largest`, or at least `least` below zero.
bool IsWithin(const Scalar& value, std::uint64_t least, std::uint64_t largest) {
  std::uint64_t number = 0;
  return value.token.type == Tokenizer::TYPE_INTEGER &&
         Tokenizer::ParseInteger(value.token.text, value.is_negative ? least : largest, &number);
}

bool IsNumber(const Scalar& value) {
  if (value.token.type == Tokenizer::TYPE_INTEGER || value.token.type == Tokenizer::TYPE_FLOAT) {
    return true;
  }
  const std::string name = absl::AsciiStrToLower(value.token.text);
  return name == "inf" || name == "infinity" || name == "nan";
}

bool IsBool(const Scalar& value) {
  static const std::set<std::string> kNames = {"true", "True", "t", "false", "False", "f"};
  return !value.is_negative && (kNames.count(value.token.text) != 0 || IsWithin(value, 0, 1));
}

// Whether `value` can be one of `field`.
bool CanBe(const FieldDescriptor& field, const Scalar& value) {
  constexpr std::uint64_t kInt32 = std::numeric_limits<std::int32_t>::max();
  constexpr std::uint64_t kInt64 = std::numeric_limits<std::int64_t>::max();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
      return IsBool(value);
    case FieldDescriptor::CPPTYPE_INT32:
      return IsWithin(value, kInt32 + 1, kInt32);
    case FieldDescriptor::CPPTYPE_INT64:
      return IsWithin(value, kInt64 + 1, kInt64);
    case FieldDescriptor::CPPTYPE_UINT32:
      return !value.is_negative && IsWithin(value, 0, std::numeric_limits<std::uint32_t>::max());
    case FieldDescriptor::CPPTYPE_UINT64:
      return !value.is_negative && IsWithin(value, 0, std::numeric_limits<std::uint64_t>::max());
    case FieldDescriptor::CPPTYPE_DOUBLE:
    case FieldDescriptor::CPPTYPE_FLOAT:
      return IsNumber(value);
    case FieldDescriptor::CPPTYPE_ENUM:
      return IsWithin(value, kInt32 + 1, kInt32) ||
             (!value.is_negative &&
              field.enum_type()->FindValueByName(value.token.text) != nullptr);
    case FieldDescriptor::CPPTYPE_STRING:
      return value.token.type == Tokenizer::TYPE_STRING;
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return false;
  }
  return true;
}

class Faults : public google::protobuf::io::ErrorCollector {
 public:
  void AddError(int line, int column, const std::string& message) override {
    if (faults_.size() < kMost) faults_.push_back({line + 1, column + 1, message});
  }
  void AddWarning(int, int, const std::string&) override {}

  bool IsFull() const { return faults_.size() >= kMost; }
  std::vector<TextFault> Take() { return std::move(faults_); }

 private:
  std::vector<TextFault> faults_;
};

class Walk {
 public:
  Walk(google::protobuf::io::ZeroCopyInputStream& text, Faults& faults)
      : faults_(faults), tokens_(&text, &faults) {
    // As protobuf's reader has it.
    tokens_.set_comment_style(Tokenizer::SH_COMMENT_STYLE);
    tokens_.set_allow_f_after_float(true);
    tokens_.set_require_space_after_number(false);
    tokens_.set_allow_multiline_strings(true);
    tokens_.Next();
  }

  // The fields up to `end`, which ends the text if it is empty. False where the rest cannot be
  // understood; `type` is null for a message of which nothing is known.
  bool Fields(const Descriptor* type, const std::string& end, int depth) {
    if (depth > kMaxNesting) return Stop("is nested too deeply");
    std::set<const FieldDescriptor*> fields;
    std::set<const google::protobuf::OneofDescriptor*> chosen;
    while (!IsAtEnd(end)) {
      if (faults_.IsFull()) return false;
      const Tokenizer::Token name = Present();
      const FieldDescriptor* field = nullptr;
      if (name.type == Tokenizer::TYPE_IDENTIFIER) {
        field = type == nullptr ? nullptr : type->FindFieldByName(name.text);
        if (field != nullptr) {
          CheckOnce(name, *field, fields, chosen);
        } else if (type != nullptr) {
          Add(name, absl::StrCat("there is no field '", name.text, "' of ", type->full_name(),
                                 FieldsOffered(name.text, *type)));
        }
        tokens_.Next();
      } else if (!Extension()) {
        return false;
      }
      if (!Value(field, depth)) return false;
      if (!TryTake(";")) TryTake(",");
    }
    return true;
  }

 private:
  const Tokenizer::Token& Present() { return tokens_.current(); }

  bool IsAtEnd(const std::string& end) {
    if (end.empty()) return Present().type == Tokenizer::TYPE_END;
    return Present().text == end && Present().type == Tokenizer::TYPE_SYMBOL;
  }

  bool TryTake(const char* symbol) {
    if (Present().type != Tokenizer::TYPE_SYMBOL || Present().text != symbol) return false;
    tokens_.Next();
    return true;
  }

  void Add(const Tokenizer::Token& place, const std::string& message) {
    faults_.AddError(place.line, place.column, message);
  }

  bool Stop(const std::string& message) {
    Add(Present(), message);
    return false;
  }

  bool StopAtPresent() {
    return Stop(Present().type == Tokenizer::TYPE_END
                    ? "the text ends here, within a field"
                    : absl::StrCat("'", Present().text, "' is not expected here"));
  }

  void CheckOnce(const Tokenizer::Token& name, const FieldDescriptor& field,
                 std::set<const FieldDescriptor*>& fields,
                 std::set<const google::protobuf::OneofDescriptor*>& chosen) {
    if (field.is_repeated()) return;
    const auto* const oneof = field.real_containing_oneof();
    if (!fields.insert(&field).second) {
      Add(name, absl::StrCat("'", name.text, "' is there twice"));
    } else if (oneof != nullptr && !chosen.insert(oneof).second) {
      Add(name, absl::StrCat("only one of ", ChoiceNames(*oneof), " can be given"));
    }
  }

  // "[…]" in place of a field's name.
  bool Extension() {
    if (!TryTake("[")) return StopAtPresent();
    while (!TryTake("]")) {
      if (Present().type == Tokenizer::TYPE_END) return StopAtPresent();
      tokens_.Next();
    }
    return true;
  }

  // What follows a name.
  bool Value(const FieldDescriptor* field, int depth) {
    const bool has_colon = TryTake(":");
    const bool is_message = Present().text == "{" || Present().text == "<";
    const bool is_list = Present().text == "[" && Present().type == Tokenizer::TYPE_SYMBOL;
    if (!has_colon && !is_message) {
      const bool could_be_one = is_list || Present().type == Tokenizer::TYPE_STRING ||
                                Present().type == Tokenizer::TYPE_INTEGER ||
                                Present().type == Tokenizer::TYPE_FLOAT;
      if (!could_be_one) return StopAtPresent();
      const bool is_list_of_messages =
          is_list && field != nullptr && field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
      if (!is_list_of_messages) Add(Present(), "there must be a ':' before the value");
    }
    if (!is_list) return Element(field, depth);
    if (field != nullptr && !field->is_repeated()) {
      Add(Present(), absl::StrCat("'", field->name(), "' is no list"));
      field = nullptr;
    }
    return List(field, depth);
  }

  bool List(const FieldDescriptor* field, int depth) {
    TryTake("[");
    if (TryTake("]")) return true;
    do {
      if (!Element(field, depth)) return false;
    } while (TryTake(","));
    return TryTake("]") || StopAtPresent();
  }

  bool Element(const FieldDescriptor* field, int depth) {
    const Tokenizer::Token start = Present();
    const bool in_braces = TryTake("{");
    if (in_braces || TryTake("<")) {
      const bool fits = field == nullptr || field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
      if (!fits) Add(start, WantedValue(*field, Notation::kTextFormat));
      const std::string end = in_braces ? "}" : ">";
      const Descriptor* const type = field == nullptr || !fits ? nullptr : field->message_type();
      if (!Fields(type, end, depth + 1)) return false;
      tokens_.Next();
      return true;
    }
    Scalar value;
    value.is_negative = TryTake("-");
    value.token = Present();
    switch (value.token.type) {
      case Tokenizer::TYPE_STRING:
        while (Present().type == Tokenizer::TYPE_STRING) tokens_.Next();  // they make one text
        break;
      case Tokenizer::TYPE_INTEGER:
      case Tokenizer::TYPE_FLOAT:
      case Tokenizer::TYPE_IDENTIFIER:
        tokens_.Next();
        break;
      default:
        return StopAtPresent();
    }
    if (field != nullptr && !CanBe(*field, value)) {
      Add(start, WantedValue(*field, Notation::kTextFormat));
    }
    return true;
  }

  Faults& faults_;
  Tokenizer tokens_;
};

}  // namespace

std::vector<TextFault> TextFaults(std::string_view text, const Descriptor& type) {
  google::protobuf::io::ArrayInputStream stream(text.data(), static_cast<int>(text.size()));
  Faults faults;
  Walk(stream, faults).Fields(&type, "", 0);
  return faults.Take();
}

}  // namespace mortise
