// Parses references to faces and edges.
#include "common/templates/features/feature_reference.h"

#include <algorithm>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/expressions/identifier.h"

namespace mortise::cad {
namespace {

constexpr std::size_t kMaxReference = 300;  // bytes

absl::Status Malformed(std::string_view text, std::string_view expected) {
  return absl::InvalidArgumentError(
      absl::StrCat("'", std::string(text.substr(0, kMaxReference)), "': ", std::string(expected)));
}

bool IsWordCharacter(char c) {
  return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '_';
}

// Identifiers, or numbers as the sides of polygons have, joined by full stops.
bool IsRole(std::string_view role) {
  for (const std::string& part : std::vector<std::string>(absl::StrSplit(std::string(role), '.'))) {
    if (part.empty() || !std::all_of(part.begin(), part.end(), IsWordCharacter)) return false;
  }
  return true;
}

std::string_view Strip(std::string_view text) {
  const absl::string_view stripped =
      absl::StripAsciiWhitespace(absl::string_view(text.data(), text.size()));
  return {stripped.data(), stripped.size()};
}

}  // namespace

absl::StatusOr<FaceName> ParseFaceReference(std::string_view text) {
  const std::string_view face = Strip(text);
  if (face.size() > kMaxReference) return Malformed(face, "is longer than a reference can be");
  const std::size_t end = std::min(face.find_first_of("[."), face.size());
  FaceName name{std::string(face.substr(0, end)), kNoInstance, {}};
  if (!parametric::IsIdentifier(name.feature)) {
    return Malformed(face, "must begin with the name of a feature");
  }
  std::string_view rest = face.substr(end);
  if (rest.starts_with('[')) {
    const std::size_t close = rest.find(']');
    if (close == std::string_view::npos) return Malformed(face, "has no ']'");
    const std::string instance(rest.substr(1, close - 1));
    if (instance == "*") {
      name.instance = kEveryInstance;
    } else if (!absl::SimpleAtoi(instance, &name.instance) || name.instance < 0) {
      return Malformed(face, "the instance in brackets must be a number from 0, or *");
    }
    rest.remove_prefix(close + 1);
  }
  if (rest.empty()) return name;
  if (rest.front() != '.' || !IsRole(rest.substr(1))) {
    return Malformed(face, "must be like 'feature.role' or 'pattern[instance].role'");
  }
  name.role = rest.substr(1);
  return name;
}

absl::StatusOr<EdgeReference> ParseEdgeReference(std::string_view text) {
  const std::size_t ampersand = text.find('&');
  if (ampersand == std::string_view::npos) {
    return Malformed(Strip(text), "must be like 'face & face' or 'face & *'");
  }
  EdgeReference reference;
  auto face = ParseFaceReference(text.substr(0, ampersand));
  if (!face.ok()) return face.status();
  reference.face = *std::move(face);
  const std::string_view other = Strip(text.substr(ampersand + 1));
  if (other == "*") return reference;
  auto second = ParseFaceReference(other);
  if (!second.ok()) return second.status();
  reference.other = *std::move(second);
  return reference;
}

std::string ToString(const FaceName& name) {
  return absl::StrCat(name.feature,
                      name.instance == kEveryInstance ? "[*]"
                      : name.instance >= 0            ? absl::StrCat("[", name.instance, "]")
                                                      : "",
                      name.role.empty() ? "" : ".", name.role);
}

bool Matches(const FaceName& reference, const FaceName& name) {
  if (reference.feature != name.feature) return false;
  if (reference.instance >= 0 && reference.instance != name.instance) return false;
  if (reference.role.empty() || reference.role == name.role) return true;
  return name.role.starts_with(reference.role + ".");
}

}  // namespace mortise::cad
