#include "common/mesh/scenes/cleaning/gltf_container.h"

#include <cstring>
#include <optional>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/scenes/cleaning/scene_limits.h"

namespace mortise::mesh {
namespace {

constexpr std::uint32_t kJsonChunk = 0x4e4f534a;
constexpr std::uint32_t kBinaryChunk = 0x004e4942;
constexpr std::size_t kGlbHeader = 12;
constexpr std::size_t kChunkHeader = 8;

std::uint32_t NumberAt(std::string_view bytes, std::size_t at) {
  std::uint32_t number = 0;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

void Append(std::uint32_t number, std::string& bytes) {
  bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

// Whether values lie deeper in each other than is read. Brackets in strings do not count.
bool IsTooDeep(std::string_view json) {
  int depth = 0;
  bool is_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    if (is_string) {
      if (json[i] == '\\') {
        ++i;
      } else if (json[i] == '"') {
        is_string = false;
      }
    } else if (json[i] == '"') {
      is_string = true;
    } else if (json[i] == '{' || json[i] == '[') {
      if (++depth > kMaxSceneDepth) return true;
    } else if (json[i] == '}' || json[i] == ']') {
      --depth;
    }
  }
  return false;
}

absl::StatusOr<nlohmann::json> ReadDocument(std::string_view json) {
  if (IsTooDeep(json)) {
    return InvalidField("file", absl::StrCat("is JSON with values more than ", kMaxSceneDepth,
                                             " deep in each other"));
  }
  nlohmann::json document = nlohmann::json::parse(json, nullptr, false);
  if (document.is_discarded()) return InvalidField("file", "is damaged: its JSON cannot be read");
  if (!document.is_object() || !document.contains("asset") || !document["asset"].is_object()) {
    return InvalidField("file", "is JSON, but no glTF");
  }
  const nlohmann::json& asset = document["asset"];
  const auto version = asset.find("version");
  if (version == asset.end() || !version->is_string()) {
    return InvalidField("file", "is glTF without a version");
  }
  if (!version->get_ref<const std::string&>().starts_with("2.")) {
    return InvalidField("file", "is glTF of another version than 2, which is not read");
  }
  return document;
}

// The bytes of a buffer whose address is "data:...;base64,...".
absl::StatusOr<std::string> ReadDataAddress(std::string_view address, std::size_t buffer) {
  const std::string which = absl::StrCat("buffers[", buffer, "] ");
  if (!address.starts_with("data:")) {
    return InvalidField(
        "file", absl::StrCat(which, "is in another file, \"", std::string(address.substr(0, 60)),
                             "\"; save it as GLB, or with its buffers in it"));
  }
  const std::size_t comma = address.find(',');
  std::string bytes;
  if (comma == std::string_view::npos || !address.substr(0, comma).ends_with(";base64") ||
      !absl::Base64Unescape({address.data() + comma + 1, address.size() - comma - 1}, &bytes)) {
    return InvalidField("file", absl::StrCat(which, "is damaged: it is no base64"));
  }
  return bytes;
}

absl::StatusOr<GltfContainer> Open(std::string_view json, std::optional<std::string_view> binary) {
  GltfContainer container;
  MORTISE_ASSIGN_OR_RETURN(container.document, ReadDocument(json));
  const nlohmann::json& buffers = GltfArray(container.document, "buffers");
  for (std::size_t b = 0; b < buffers.size(); ++b) {
    if (!buffers[b].is_object()) return InvalidField("file", "is damaged: a buffer is no object");
    MORTISE_ASSIGN_OR_RETURN(const std::uint64_t length, GltfNumber(buffers[b], "byteLength", 0));
    const auto address = buffers[b].find("uri");
    std::string decoded;
    std::string_view bytes = binary.value_or("");
    if (address != buffers[b].end() && address->is_string()) {
      MORTISE_ASSIGN_OR_RETURN(decoded, ReadDataAddress(address->get_ref<const std::string&>(), b));
      bytes = decoded;
    } else if (b != 0 || !binary) {
      return InvalidField("file", absl::StrCat("buffers[", b, "] has no data"));
    }
    if (length > bytes.size()) {
      return InvalidField("file", absl::StrCat("buffers[", b, "] declares ", length,
                                               " bytes, but has ", bytes.size()));
    }
    container.offset.push_back(container.data.size());
    container.length.push_back(length);
    container.data.append(bytes.substr(0, length));
    container.data.resize((container.data.size() + 3) / 4 * 4);
  }
  return container;
}

}  // namespace

absl::StatusOr<std::uint64_t> GltfNumber(const nlohmann::json& object, const char* key,
                                         std::uint64_t absent) {
  const auto value = object.find(key);
  if (value == object.end()) return absent;
  if (!value->is_number_unsigned() || value->get<std::uint64_t>() > UINT32_MAX) {
    return InvalidField("file", absl::StrCat("is damaged: ", key, " is no whole number in range"));
  }
  return value->get<std::uint64_t>();
}

const nlohmann::json& GltfArray(const nlohmann::json& object, const char* key) {
  static const nlohmann::json kNone = nlohmann::json::array();
  const auto value = object.find(key);
  return value == object.end() || !value->is_array() ? kNone : *value;
}

absl::StatusOr<GltfContainer> OpenGlb(std::string_view bytes) {
  if (bytes.size() < kGlbHeader + kChunkHeader) {
    return InvalidField("file", "is a GLB that ends in its header");
  }
  if (NumberAt(bytes, 4) != 2) {
    return InvalidField("file", "is a GLB of another version than 2, which is not read");
  }
  std::optional<std::string_view> json, binary;
  for (std::size_t at = kGlbHeader; at + kChunkHeader <= bytes.size();) {
    const std::size_t length = NumberAt(bytes, at);
    const std::uint32_t kind = NumberAt(bytes, at + 4);
    at += kChunkHeader;
    if (length > bytes.size() - at) {
      return InvalidField("file", absl::StrCat("has a chunk of ", length, " bytes, but ends after ",
                                               bytes.size() - at));
    }
    if (kind == kJsonChunk && !json) json = bytes.substr(at, length);
    if (kind == kBinaryChunk && !binary) binary = bytes.substr(at, length);
    at += length;
  }
  if (!json) return InvalidField("file", "is a GLB without its JSON");
  return Open(*json, binary);
}

absl::StatusOr<GltfContainer> OpenGltf(std::string_view json) { return Open(json, std::nullopt); }

std::string WriteGlb(const nlohmann::json& document, std::string_view data) {
  std::string json = document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string glb = "glTF";
  Append(2, glb);
  Append(static_cast<std::uint32_t>(kGlbHeader + 2 * kChunkHeader + json.size() + data.size()),
         glb);
  Append(static_cast<std::uint32_t>(json.size()), glb);
  Append(kJsonChunk, glb);
  glb += json;
  Append(static_cast<std::uint32_t>(data.size()), glb);
  Append(kBinaryChunk, glb);
  return glb.append(data);
}

}  // namespace mortise::mesh
