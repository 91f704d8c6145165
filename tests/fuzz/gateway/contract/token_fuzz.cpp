// Bearer tokens and key files of strangers: nothing but a status comes of them.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "gateway/contract/token.h"

namespace {

// The public key of RFC 8037's example.
constexpr char kKeys[] = R"({"keys":[{"kty":"OKP","crv":"Ed25519","kid":"a",)"
                         R"("x":"11qYAYKxCrfVS_7TyWQHOg7hcvPapiMlrwIaaPcHURo"}]})";

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace mortise::gateway;
  static const TokenKeys keys = *TokenKeys::Parse(kKeys);
  const std::string_view input(reinterpret_cast<const char*>(data), size);
  (void)TokenKeys::Parse(input);
  const auto token = BearerToken(input);
  if (keys.Verify(token.value_or(input), {}, absl::UnixEpoch()).ok()) std::abort();
  return 0;
}
