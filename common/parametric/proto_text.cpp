#include "common/parametric/proto_text.h"

#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

constexpr int kMaxNesting = 32;
constexpr int kMaxErrors = 20;

// Joins what the parser finds: "line 3, column 7: …".
class ErrorJoiner : public google::protobuf::io::ErrorCollector {
 public:
  void AddError(int line, int column, const std::string& message) override {
    if (++count_ > kMaxErrors) return;
    absl::StrAppend(&joined_, joined_.empty() ? "" : "; ", "line ", line + 1, ", column ",
                    column + 1, ": ", message);
  }
  void AddWarning(int, int, const std::string&) override {}

  const std::string& joined() const { return joined_; }

 private:
  int count_ = 0;
  std::string joined_;
};

}  // namespace

absl::Status ParseProtoText(std::string_view text, const std::string& origin,
                            google::protobuf::Message& message) {
  if (text.size() > kMaxTextBytes) return TooLarge(origin, "4 MiB");
  ErrorJoiner errors;
  google::protobuf::TextFormat::Parser parser;
  parser.RecordErrorsTo(&errors);
  parser.SetRecursionLimit(kMaxNesting);
  if (!parser.ParseFromString(std::string(text), &message)) {
    return InvalidField(origin, errors.joined());
  }
  return absl::OkStatus();
}

}  // namespace mortise::parametric
