#include "gateway/forwarding/wire.h"

#include <grpc/impl/codegen/grpc_types.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::gateway {

grpc::ByteBuffer ToByteBuffer(std::string_view bytes) {
  const grpc::Slice slice(bytes.data(), bytes.size());
  return grpc::ByteBuffer(&slice, 1);
}

std::string ToString(const grpc::ByteBuffer& buffer) {
  std::vector<grpc::Slice> slices;
  if (!buffer.Dump(&slices).ok()) return {};
  std::string bytes;
  bytes.reserve(buffer.Length());
  for (const grpc::Slice& slice : slices) {
    bytes.append(reinterpret_cast<const char*>(slice.begin()), slice.size());
  }
  return bytes;
}

bool IsReservedMetadata(std::string_view key) {
  if (key.starts_with(':') || key.starts_with("grpc-") || key.starts_with("mortise-")) return true;
  constexpr std::array<std::string_view, 12> kReserved = {
      "authorization", "connection", "content-length",
      "content-type",  "cookie",     "host",
      "keep-alive",    "te",         "transfer-encoding",
      "upgrade",       "user-agent", "x-request-id"};
  for (const std::string_view reserved : kReserved) {
    if (key == reserved) return true;
  }
  return false;
}

bool IsLegalMetadata(std::string_view key, std::string_view value) {
  const bool legal_key = !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.';
  });
  return legal_key && (key.ends_with("-bin") || std::all_of(value.begin(), value.end(), [](char c) {
                         return c >= 0x20 && c <= 0x7e;
                       }));
}

void PassedMetadata::Add(std::string_view key, std::string_view value) {
  constexpr std::size_t kOverhead = 32;
  const std::size_t size = key.size() + value.size() + kOverhead;
  bytes_ += size;
  by_key_[std::string(key)] += size;
}

absl::Status PassedMetadata::Check(std::string_view what) const {
  if (bytes_ <= kMaxMetadataBytes) return absl::OkStatus();
  std::vector<std::pair<std::size_t, std::string>> largest;
  for (const auto& [key, size] : by_key_) largest.emplace_back(size, key.substr(0, 64));
  std::sort(largest.rbegin(), largest.rend());
  constexpr std::size_t kNamed = 3;
  std::string names;
  for (std::size_t i = 0; i < std::min(kNamed, largest.size()); ++i) {
    absl::StrAppend(&names, i == 0 ? "" : ", ", largest[i].second, " (", largest[i].first, ")");
  }
  const std::string words(what);
  return WithDetail(absl::ResourceExhaustedError(absl::StrCat(
                        "the ", words, " to be passed on have ", bytes_, " bytes, at most ",
                        kMaxMetadataBytes, " are taken; the largest: ", names)),
                    {"METADATA_TOO_LARGE", words});
}

void SetFlowControl(const std::function<void(const char* name, int value)>& set) {
  set(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  set(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, 1 << 20);
}

}  // namespace mortise::gateway
