// Puts off what cuts from or unites with one body in a row until somebody needs the body as it is:
// one of the kernel's operations with many solids takes much less time than many with one. Private
// to this folder: it brings Open CASCADE's headers.
#pragma once

#include <cstddef>
#include <gp_Ax3.hxx>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "common/templates/features/feature_changes.h"
#include "common/templates/features/named_body.h"

namespace mortise::cad {

class DeferredCombination {
 public:
  DeferredCombination(Operation operation, std::size_t body) : operation_(operation), body_(body) {}

  // Whether `operation` on the body of index `body` can be done together with this one.
  bool Accepts(Operation operation, std::size_t body) const;

  void Add(const std::string& feature, const std::vector<NamedBody>& solids);

  // Returns the plane of a face, as FrameOfFace has it once all this is done, and remembers that
  // what is added from here on relies on it. Nothing if that cannot be told before. `state` is that
  // of the bodies before.
  std::optional<FaceFrame> FrameBefore(const std::string& face, const ModelState& state);

  // Changes the body. INVALID_ARGUMENT without a place among the features if the kernel cannot,
  // nothing is left, or a face that was relied on is gone or not where it was.
  absl::Status Apply(ModelState& state) const;

 private:
  struct Step {
    std::string feature;
    std::vector<NamedBody> solids;
  };
  struct Plane {
    std::string face;
    gp_Ax3 frame;
    std::size_t after = 0;  // so many steps
  };

  absl::Status ApplyTogether(NamedBody& body) const;
  absl::Status ApplyInTurn(ModelState& state) const;

  Operation operation_;
  std::size_t body_;
  std::vector<Step> steps_;
  std::vector<Plane> planes_;
};

}  // namespace mortise::cad
