#include "services/composer/holding/loose_fasteners.h"

#include <algorithm>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "services/composer/holding/joints.h"
#include "services/composer/model/overlap.h"

namespace mortise::composer {
namespace {

constexpr double kTouches = 2e-4;  // m, between boxes
constexpr char kOwn[] = "our own rule of thumb";

bool Touches(const Fastener& pin, const parametric::BoundingBox& box) {
  return CommonDepth(pin.box, box) >= -kTouches;
}

// What is wrong with a pin; empty if nothing is.
std::string WhyLoose(const Fastener& pin, const std::vector<Fastener>& fasteners,
                     const std::vector<JoinedPart>& principals) {
  int reached = 0, touched = 0;
  std::string into;
  for (const JoinedPart& part : principals) {
    if (!Touches(pin, part.box)) continue;
    ++touched;
    if (CommonDepth(pin.box, part.box) <= kMaxOverlap) continue;
    ++reached;
    into = part.name;
  }
  const bool is_held = std::any_of(fasteners.begin(), fasteners.end(), [&](const Fastener& other) {
    if (&other == &pin || !Touches(pin, other.box)) return false;
    // A pin may lie in another's bore.
    return !other.IsPin() || AreCoaxial(pin, other) ||
           CommonDepth(pin.box, other.box) > kMaxOverlap;
  });
  if (is_held || reached >= 2) return "";
  if (pin.kind != FastenerKind::kScrew && reached == 1 && touched >= 2) return "";
  if (reached == 0) return "goes into no part";
  return absl::StrCat("goes into '", into, "' alone");
}

}  // namespace

std::vector<Finding> FindLooseFasteners(const parametric::Assembly& drawn,
                                        const std::vector<parametric::Item>& items,
                                        const std::vector<parametric::Material>& materials) {
  std::vector<Fastener> fasteners;
  std::vector<JoinedPart> principals;
  for (const parametric::AssemblyPart& part : drawn.parts) {
    if (part.connecting) {
      fasteners.push_back(FastenerOf(part, items));
    } else {
      principals.push_back(JoinedPartOf(part, items, materials));
    }
  }
  std::vector<Finding> findings;
  for (const Fastener& fastener : fasteners) {
    if (!fastener.IsPin()) continue;
    std::string why = WhyLoose(fastener, fasteners, principals);
    if (why.empty()) continue;
    findings.push_back(
        {Severity::kWarning, kJoinsNothing, {fastener.name}, 0, 1, "1", std::move(why), kOwn});
  }
  return findings;
}

}  // namespace mortise::composer
