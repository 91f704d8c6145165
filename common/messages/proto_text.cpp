#include "common/messages/proto_text.h"

#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>

#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/base/text_encoding.h"
#include "common/messages/text_faults.h"

namespace mortise::parametric {
namespace {

constexpr int kMaxNesting = 32;

// What it says is told by TextFaults, all of it.
class Silence : public google::protobuf::io::ErrorCollector {
 public:
  void AddError(int, int, const std::string& message) override {
    if (first_.empty()) first_ = message;
  }
  void AddWarning(int, int, const std::string&) override {}

  const std::string& first() const { return first_; }

 private:
  std::string first_;
};

}  // namespace

absl::Status ParseProtoText(std::string_view text, const std::string& origin,
                            google::protobuf::Message& message) {
  if (text.size() > kMaxTextBytes) return TooLarge(origin, "4 MiB");
  MORTISE_ASSIGN_OR_RETURN(text, WithoutByteOrderMark(text, origin));
  Silence parser_says;
  google::protobuf::TextFormat::Parser parser;
  parser.RecordErrorsTo(&parser_says);
  parser.SetRecursionLimit(kMaxNesting);
  if (parser.ParseFromString(std::string(text), &message)) return absl::OkStatus();
  std::vector<FieldViolation> faults;
  for (const TextFault& fault : TextFaults(text, *message.GetDescriptor())) {
    faults.push_back(
        {absl::StrCat(origin, ": line ", fault.line, ", column ", fault.column), fault.message});
  }
  if (faults.empty()) return InvalidField(origin, parser_says.first());
  return InvalidFields(faults);
}

}  // namespace mortise::parametric
