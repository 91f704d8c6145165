#include "gateway/contract/connect_protocol.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::gateway {
namespace {

using Json = nlohmann::ordered_json;

struct CodeRow {
  std::string_view name;
  int http_status;
};

// By code number; the protocol's table.
constexpr std::array<CodeRow, 17> kCodes = {{{"ok", 200},
                                             {"canceled", 499},
                                             {"unknown", 500},
                                             {"invalid_argument", 400},
                                             {"deadline_exceeded", 504},
                                             {"not_found", 404},
                                             {"already_exists", 409},
                                             {"permission_denied", 403},
                                             {"resource_exhausted", 429},
                                             {"failed_precondition", 400},
                                             {"aborted", 409},
                                             {"out_of_range", 400},
                                             {"unimplemented", 501},
                                             {"internal", 500},
                                             {"unavailable", 503},
                                             {"data_loss", 500},
                                             {"unauthenticated", 401}}};

const CodeRow& RowOf(absl::StatusCode code) {
  const int number = static_cast<int>(code);
  return kCodes[number >= 0 && number < static_cast<int>(kCodes.size()) ? number : 2];
}

std::string Base64Unpadded(std::string_view bytes) {
  std::string text = absl::Base64Escape(absl::string_view(bytes.data(), bytes.size()));
  while (!text.empty() && text.back() == '=') text.pop_back();
  return text;
}

// What programs look for, where they need not know the types of details.
void PutInWords(const Json& detail, Json& object) {
  if (const auto reason = detail.find("reason"); reason != detail.end()) {
    object["reason"] = *reason;
  }
  const auto violations = detail.find("fieldViolations");
  if (violations == detail.end() || !violations->is_array()) return;
  for (const Json& violation : *violations) {
    object["fields"].push_back(
        {{"field", violation.value("field", "")}, {"message", violation.value("description", "")}});
  }
}

Json ErrorObject(const ConnectError& error) {
  Json object;
  object["code"] = RowOf(error.code).name;
  if (!error.message.empty()) object["message"] = error.message;
  std::vector<Json> readable;
  for (const ErrorDetailBytes& detail : error.details) {
    readable.push_back(Json::parse(detail.json, nullptr, false));
    if (readable.back().is_object()) PutInWords(readable.back(), object);
  }
  for (std::size_t i = 0; i < error.details.size(); ++i) {
    const ErrorDetailBytes& detail = error.details[i];
    Json entry = {{"type", detail.type}, {"value", Base64Unpadded(detail.value)}};
    if (readable[i].is_object()) entry["debug"] = std::move(readable[i]);
    object["details"].push_back(std::move(entry));
  }
  return object;
}

std::string Dump(const Json& object) {
  return object.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::optional<ConnectCodec> ParseContentType(std::string_view content_type) {
  std::string type(content_type.substr(0, content_type.find(';')));
  while (!type.empty() && type.back() == ' ') type.pop_back();
  absl::AsciiStrToLower(&type);
  if (type == "application/json") return ConnectCodec{true, false};
  if (type == "application/proto") return ConnectCodec{false, false};
  if (type == "application/connect+json") return ConnectCodec{true, true};
  if (type == "application/connect+proto") return ConnectCodec{false, true};
  return std::nullopt;
}

std::string_view ContentTypeOf(const ConnectCodec& codec) {
  if (codec.streaming) return codec.json ? "application/connect+json" : "application/connect+proto";
  return codec.json ? "application/json" : "application/proto";
}

std::string_view ConnectCodeName(absl::StatusCode code) { return RowOf(code).name; }

int HttpStatusOf(absl::StatusCode code) { return RowOf(code).http_status; }

absl::StatusOr<absl::Duration> ParseTimeout(std::string_view text) {
  const bool digits = std::all_of(text.begin(), text.end(), [](char c) {
    return absl::ascii_isdigit(static_cast<unsigned char>(c));
  });
  if (text.empty() || text.size() > 10 || !digits) {
    return InvalidField("connect-timeout-ms", "must be 1 to 10 digits");
  }
  int64_t milliseconds = 0;
  for (const char c : text) milliseconds = milliseconds * 10 + (c - '0');
  return absl::Milliseconds(milliseconds);
}

std::string ErrorJson(const ConnectError& error) { return Dump(ErrorObject(error)); }

std::string EndStreamJson(const std::optional<ConnectError>& error, const HeaderList& trailers) {
  Json object = Json::object();
  if (error) object["error"] = ErrorObject(*error);
  for (const auto& [name, value] : trailers) object["metadata"][name].push_back(value);
  return Dump(object);
}

std::string Envelope(uint8_t flags, std::string_view payload) {
  const auto size = static_cast<uint32_t>(payload.size());
  std::string bytes;
  bytes.reserve(kEnvelopeHeaderBytes + payload.size());
  bytes.push_back(static_cast<char>(flags));
  for (const int shift : {24, 16, 8, 0}) bytes.push_back(static_cast<char>(size >> shift & 0xff));
  bytes.append(payload);
  return bytes;
}

absl::StatusOr<std::vector<std::string_view>> SplitEnvelopes(std::string_view body,
                                                             std::size_t limit) {
  std::vector<std::string_view> payloads;
  while (!body.empty()) {
    if (body.size() < kEnvelopeHeaderBytes) {
      return InvalidField("request", "the body ends within an envelope's first five bytes");
    }
    const auto flags = static_cast<uint8_t>(body[0]);
    if (flags == kCompressedFlag) return NotBuilt("compressed messages");
    if (flags != 0) return InvalidField("request", "an envelope has unknown flags");
    std::size_t size = 0;
    for (int i = 1; i <= 4; ++i) size = size << 8 | static_cast<uint8_t>(body[i]);
    body.remove_prefix(kEnvelopeHeaderBytes);
    if (size > limit) return TooLarge("a message", absl::StrCat(limit, " bytes"));
    if (size > body.size()) {
      return InvalidField("request", "the body ends within an envelope's message");
    }
    payloads.push_back(body.substr(0, size));
    body.remove_prefix(size);
  }
  return payloads;
}

}  // namespace mortise::gateway
