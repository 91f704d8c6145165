// Messages that people wrote, as JSON or protobuf text: what can be read has no faults but fields
// that are there twice, and what cannot be read has some.
#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>
#include <google/protobuf/util/json_util.h>

#include <cstdint>
#include <cstdlib>
#include <string>

#include "common/messages/json_faults.h"
#include "common/messages/text_faults.h"
#include "mortise/v1/catalog.pb.h"

namespace {

using Message = mortise::v1::ImportTemplateRequest;

void Check(bool condition) {
  if (!condition) std::abort();
}

void FindInJson(const std::string& json) {
  Message message;
  const auto read = google::protobuf::util::JsonStringToMessage(json, &message);
  const auto faults = mortise::JsonFaults(json, *Message::descriptor(), read);
  if (!read.ok()) Check(!faults.empty());
  for (const mortise::FieldViolation& fault : faults) Check(!fault.message.empty());
}

class Silence : public google::protobuf::io::ErrorCollector {
 public:
  void AddError(int, int, const std::string&) override {}
};

void FindInText(const std::string& text) {
  Message message;
  Silence silence;
  google::protobuf::TextFormat::Parser parser;
  parser.RecordErrorsTo(&silence);
  parser.SetRecursionLimit(32);
  const bool is_read = parser.ParseFromString(text, &message);
  const auto faults = mortise::TextFaults(text, *Message::descriptor());
  if (is_read) Check(faults.empty());
  for (const mortise::TextFault& fault : faults) Check(fault.line > 0 && fault.column > 0);
}

}  // namespace

// The first byte chooses.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  data[0] == '{' ? FindInJson("{" + text) : FindInText(text);
  return 0;
}
