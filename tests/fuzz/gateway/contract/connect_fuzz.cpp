// Bodies of Connect calls: envelopes, and JSON transcoded to messages and back.
#include <google/protobuf/descriptor.h>

#include <cstdint>
#include <cstdlib>

#include "gateway/contract/connect_protocol.h"
#include "gateway/contract/contract.h"
#include "gateway/contract/transcoder.h"

namespace mortise::gateway {
namespace {

struct Fixture {
  std::unique_ptr<const Contract> contract = Contract::Load();
  Transcoder transcoder{*contract};
};

void Check(bool condition) {
  if (!condition) std::abort();
}

// The first byte chooses the method whose request the rest is.
void Transcode(const Fixture& fixture, std::string_view input) {
  if (input.empty()) return;
  const auto& methods = fixture.contract->methods();
  const auto& type =
      *methods[static_cast<unsigned char>(input[0]) % methods.size()].descriptor->input_type();
  const auto binary = fixture.transcoder.ToBinary(type, input.substr(1));
  if (!binary.ok()) {
    Check(binary.status().code() == absl::StatusCode::kInvalidArgument);
    return;
  }
  // What was understood can be written, and is understood again.
  const auto json = fixture.transcoder.ToJson(type, *binary);
  if (json.ok()) Check(fixture.transcoder.ToBinary(type, *json).ok());
}

}  // namespace
}  // namespace mortise::gateway

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mortise::gateway;
  static const Fixture fixture;
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  const auto payloads = SplitEnvelopes(input, 1 << 16);
  if (payloads.ok()) {
    std::string body;
    for (const std::string_view payload : *payloads) body += Envelope(0, payload);
    Check(body == input);
    for (const std::string_view payload : *payloads) Transcode(fixture, payload);
  }
  Transcode(fixture, input);
  (void)ParseContentType(input);
  (void)ParseTimeout(input);
  return 0;
}
