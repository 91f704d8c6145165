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
#include "services/interpolator/mapping/shortest_paths.h"

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
  // How long the paths from a corner are.
  struct Lengths {
    double limit = 0;  // m, how far has been searched
    int paths = 0;     // that there were then; those added since make others longer, not shorter
    std::map<Corner, double> source, target;
  };
  using Searched = std::map<Corner, Lengths>;

  Candidate MakeCandidate(const Searched& searched, Corner from, Corner to, double way) const;
  // Returns the least that a pair of paths may be long, by what was searched.
  double LeastOf(const Lengths& lengths, const Candidate& candidate) const;
  std::optional<Candidate> Best(std::vector<Candidate> candidates, double highest,
                                Searched& searched);
  void Improve(Lengths& lengths, Candidate& candidate);
  std::vector<Candidate> Shortcuts(const BoundaryPiece& walk) const;
  bool IsLarge(const BoundaryPiece& walk) const;
  void MeasurePatches();
  absl::StatusOr<int> Add(const Candidate& candidate);

  LayoutSurface& source_;
  LayoutSurface& target_;
  std::vector<PatchPieces> patches_;
  LayoutOptions options_;
  double diagonal_;  // m, of both surfaces' boxes
  SearchSpace source_space_, target_space_;
  std::vector<double> source_shares_, target_shares_;  // of the area, of each patch
  std::vector<BoundaryPiece> walks_;
};

}  // namespace mortise::interpolator
