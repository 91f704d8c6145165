#include "common/rpc/page_tokens.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/message.h>

#include <memory>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "common/base/digest.h"

namespace mortise::rpc {
namespace {

using google::protobuf::Message;

constexpr std::size_t kDigest = 16;  // bytes in a token

// What a list is of: the type of its request, and its filters.
std::string FiltersOf(const Message& request) {
  const std::unique_ptr<Message> filters(request.New());
  filters->CopyFrom(request);
  for (const char* name : {"page_token", "page_size"}) {
    const auto* const field = request.GetDescriptor()->FindFieldByName(name);
    if (field != nullptr) filters->GetReflection()->ClearField(filters.get(), field);
  }
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream stream(&bytes);
    google::protobuf::io::CodedOutputStream coded(&stream);
    coded.SetSerializationDeterministic(true);
    filters->SerializeToCodedStream(&coded);
  }
  return absl::StrCat(request.GetDescriptor()->full_name(), ":", bytes.size(), ":", bytes);
}

std::string DigestOf(const std::string& position, const Message& request) {
  const std::string hex = Sha256Hex(absl::StrCat(FiltersOf(request), position));
  return absl::HexStringToBytes(hex).substr(0, kDigest);
}

}  // namespace

std::string SealPageToken(const std::string& position, const Message& request) {
  if (position.empty()) return "";
  return absl::WebSafeBase64Escape(absl::StrCat(DigestOf(position, request), position));
}

absl::StatusOr<std::string> OpenPageToken(const std::string& token, const Message& request) {
  if (token.empty()) return "";
  std::string sealed;
  if (absl::WebSafeBase64Unescape(token, &sealed) && sealed.size() > kDigest) {
    std::string position = sealed.substr(kDigest);
    // Compared as text: base64 spells one sequence of bytes in several ways.
    if (SealPageToken(position, request) == token) return position;
  }
  return InvalidField("page_token",
                      "is not one that this method gave for the same filters; begin without");
}

}  // namespace mortise::rpc
