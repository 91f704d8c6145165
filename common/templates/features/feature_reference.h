// Says how features refer to faces and edges: by what made them, never by a number in the kernel's
// lists, so that a reference means the same face when parameters change what is around it.
//
//   face = feature [ "[" ( instance | "*" ) "]" ] [ "." role ]
//   edge = face "&" ( face | "*" )
//
// "plate.start" and "plate.end" are the caps of the extrusion `plate`; "plate.outline.right" is the
// face of segment `right` of the profile `outline` of its sketch, "plate.outline" those of all of
// that profile's segments, and "plate" all faces that the feature made. "holes[2].wall" is the wall
// of instance 2 of the pattern `holes`, "holes[*].wall" those of all instances with the feature
// itself. A face that later features split is all its pieces; faces that are merged are found by
// the names of each.
//
// "plate.outline & plate.end" are the edges where the two meet, "plate.end & *" all edges of a
// face.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace mortise::cad {

inline constexpr int kNoInstance = -1;     // not of a pattern
inline constexpr int kEveryInstance = -2;  // "[*]"

// Where a face comes from; as a reference, a pattern of such names.
struct FaceName {
  std::string feature;
  int instance = kNoInstance;  // of a pattern, from 0
  std::string role;  // "start", "outline.right", …; empty for all, or of features with one

  friend bool operator==(const FaceName&, const FaceName&) = default;
};

struct EdgeReference {
  FaceName face;
  std::optional<FaceName> other;  // nothing for every edge of `face`
};

// Reads a reference. INVALID_ARGUMENT saying what was expected. The status names no field; the
// caller knows it.
absl::StatusOr<FaceName> ParseFaceReference(std::string_view text);
absl::StatusOr<EdgeReference> ParseEdgeReference(std::string_view text);

// Returns "holes[2].wall".
std::string ToString(const FaceName& name);

// Whether a face of this name is among those that `reference` means. Patterns must have been told
// apart before: instance 0 of a pattern is its source.
bool Matches(const FaceName& reference, const FaceName& name);

}  // namespace mortise::cad
