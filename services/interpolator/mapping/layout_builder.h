// Adds pairs of paths to two surfaces until every patch is a small disk. Private to this folder;
// patch_layout.h is the door and says how.
#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "services/interpolator/mapping/layout_pieces.h"
#include "services/interpolator/mapping/layout_surface.h"
#include "services/interpolator/mapping/patch_layout.h"

namespace mortise::interpolator {

class LayoutBuilder {
 public:
  // The surfaces have the same paths and labelled patches, whose pieces (of the source) correspond.
  LayoutBuilder(LayoutSurface& source, LayoutSurface& target, std::vector<PatchPieces> patches,
                const LayoutOptions& options);

  // Connects the pieces of the boundary of every patch.
  absl::Status Connect();

  // Divides large patches. Each has a boundary of one piece.
  absl::Status Subdivide();

  // Returns the corners around each patch.
  const std::vector<BoundaryPiece>& walks() const { return walks_; }

 private:
  // A pair of paths that may be added.
  struct Candidate {
    double score = 0;  // the sum of the lengths over `way`, or less than that until it is known
    double way = 1;    // m of both boundaries between its ends; or 1
    Corner from = 0, to = 0;
    bool is_known = false;
  };
  struct Lengths {
    double limit = -1;  // m, how far has been searched
    std::map<Corner, double> source, target;
  };

  Candidate MakeCandidate(Corner from, Corner to, double way) const;
  std::optional<Candidate> Best(std::vector<Candidate> candidates, double highest) const;
  void Improve(std::map<Corner, Lengths>& searched, Candidate& candidate) const;
  std::vector<Candidate> Shortcuts(const BoundaryPiece& walk) const;
  bool IsLarge(const BoundaryPiece& walk) const;
  absl::StatusOr<int> Add(const Candidate& candidate);

  LayoutSurface& source_;
  LayoutSurface& target_;
  std::vector<PatchPieces> patches_;
  LayoutOptions options_;
  double diagonal_;  // m, of both surfaces' boxes
  std::vector<BoundaryPiece> walks_;
};

}  // namespace mortise::interpolator
