#include "services/interpolator/mapping/layout_builder.h"

#include <algorithm>
#include <limits>

#include "common/base/errors.h"
#include "services/interpolator/mapping/shortest_paths.h"

namespace mortise::interpolator {
namespace {

constexpr double kFirstSearch = 1e-3;  // of the diagonal, the least radius of a search

double Diagonal(const LayoutSurface& surface) {
  Eigen::AlignedBox3d box;
  for (const OpenMesh::VertexHandle vertex : surface.mesh().vertices()) {
    box.extend(surface.mesh().point(vertex));
  }
  return box.diagonal().norm();
}

double AreaOf(const LayoutSurface& surface, OpenMesh::FaceHandle face) {
  std::vector<Eigen::Vector3d> corners;
  for (const OpenMesh::VertexHandle vertex : surface.mesh().fv_range(face)) {
    corners.push_back(surface.mesh().point(vertex));
  }
  return (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm() / 2;
}

// Returns the share of the surface's area that each patch has.
std::vector<double> SharesOf(const LayoutSurface& surface) {
  std::vector<double> shares(static_cast<std::size_t>(surface.patch_count()), 0);
  double sum = 0;
  for (const OpenMesh::FaceHandle face : surface.mesh().faces()) {
    const double area = AreaOf(surface, face);
    sum += area;
    shares[static_cast<std::size_t>(surface.patch(face))] += area;
  }
  for (double& share : shares) share /= sum;
  return shares;
}

double Distance(const LayoutSurface& surface, Corner from, Corner to) {
  return (surface.Point(surface.node_vertex(surface.NodeOf(from))) -
          surface.Point(surface.node_vertex(surface.NodeOf(to))))
      .norm();
}

}  // namespace

LayoutBuilder::LayoutBuilder(LayoutSurface& source, LayoutSurface& target,
                             std::vector<PatchPieces> patches, const LayoutOptions& options)
    : source_(source),
      target_(target),
      patches_(std::move(patches)),
      options_(options),
      diagonal_(Diagonal(source) + Diagonal(target)) {}

LayoutBuilder::Candidate LayoutBuilder::MakeCandidate(const Searched& searched, Corner from,
                                                      Corner to, double way) const {
  // No path is shorter than the straight line.
  const double least = Distance(source_, from, to) + Distance(target_, from, to);
  Candidate candidate{.score = least / way, .way = way, .from = from, .to = to};
  const auto known = searched.find(from);
  if (known != searched.end()) candidate.score = LeastOf(known->second, candidate) / way;
  return candidate;
}

double LayoutBuilder::LeastOf(const Lengths& lengths, const Candidate& candidate) const {
  const double before = candidate.score * candidate.way;
  // A corner that was made since was a part of another one, of which it is not known.
  if (candidate.to >= 2 * lengths.paths) return before;
  const auto source = lengths.source.find(candidate.to), target = lengths.target.find(candidate.to);
  const double ours = source != lengths.source.end() ? source->second : lengths.limit;
  const double theirs = target != lengths.target.end() ? target->second : lengths.limit;
  return std::max(before, ours + theirs);
}

// Searches somewhat further on each surface than half of what both paths are known to be long.
void LayoutBuilder::Improve(Lengths& lengths, Candidate& candidate) {
  const bool is_fresh = lengths.paths == source_.path_count();
  double limit = std::max(0.75 * candidate.score * candidate.way, kFirstSearch * diagonal_);
  if (is_fresh && lengths.limit >= limit && lengths.source.count(candidate.to) > 0 &&
      lengths.target.count(candidate.to) > 0) {
    limit = lengths.limit;
  } else if (is_fresh && lengths.limit > 0) {
    limit = std::max(limit, 2 * lengths.limit);
  }
  if (!is_fresh || lengths.limit < limit) {
    lengths.limit = limit;
    lengths.paths = source_.path_count();
    lengths.source = ShortestPaths(source_, candidate.from, limit, &source_space_).lengths();
    lengths.target = ShortestPaths(target_, candidate.from, limit, &target_space_).lengths();
  }
  candidate.is_known =
      lengths.source.count(candidate.to) > 0 && lengths.target.count(candidate.to) > 0;
  candidate.score = LeastOf(lengths, candidate) / candidate.way;
}

// Returns the candidate of the least score that is not higher than `highest`. Lengths are only
// searched of those whose bounds are lower than all that is known.
std::optional<LayoutBuilder::Candidate> LayoutBuilder::Best(std::vector<Candidate> candidates,
                                                            double highest, Searched& searched) {
  const auto is_worse = [](const Candidate& a, const Candidate& b) {
    return std::tie(a.score, a.from, a.to) > std::tie(b.score, b.from, b.to);
  };
  std::make_heap(candidates.begin(), candidates.end(), is_worse);
  while (!candidates.empty()) {
    std::pop_heap(candidates.begin(), candidates.end(), is_worse);
    Candidate& best = candidates.back();
    if (best.score > highest) return std::nullopt;
    if (best.is_known) return best;
    Improve(searched[best.from], best);
    std::push_heap(candidates.begin(), candidates.end(), is_worse);
  }
  return std::nullopt;
}

absl::StatusOr<int> LayoutBuilder::Add(const Candidate& candidate) {
  constexpr double kEverywhere = std::numeric_limits<double>::infinity();
  const Trace ours = ShortestPaths(source_, candidate.from, kEverywhere).PathTo(candidate.to);
  const Trace theirs = ShortestPaths(target_, candidate.from, kEverywhere).PathTo(candidate.to);
  MORTISE_ASSIGN_OR_RETURN(const int path, source_.Insert(ours));
  MORTISE_RETURN_IF_ERROR(target_.Insert(theirs).status());
  return path;
}

absl::Status LayoutBuilder::Connect() {
  for (PatchPieces& patch : patches_) {
    std::vector<BoundaryPiece>& pieces = patch.pieces;
    Searched searched;
    while (pieces.size() > 1) {
      std::vector<Candidate> candidates;
      for (std::size_t a = 0; a < pieces.size(); ++a) {
        for (std::size_t b = a + 1; b < pieces.size(); ++b) {
          for (const Corner from : pieces[a]) {
            for (const Corner to : pieces[b])
              candidates.push_back(MakeCandidate(searched, from, to, 1));
          }
        }
      }
      const std::optional<Candidate> best = Best(std::move(candidates), 1e3 * diagonal_, searched);
      if (!best) return absl::InternalError("no path leads from one piece of a patch to another");
      MORTISE_ASSIGN_OR_RETURN(const int path, Add(*best));
      const auto is_joined = [&best](const BoundaryPiece& piece) {
        return std::find(piece.begin(), piece.end(), best->from) != piece.end() ||
               std::find(piece.begin(), piece.end(), best->to) != piece.end();
      };
      pieces.erase(std::remove_if(pieces.begin(), pieces.end(), is_joined), pieces.end());
      pieces.push_back(source_.Walk(2 * path));
    }
    walks_.push_back(pieces.front());
  }
  return absl::OkStatus();
}

bool LayoutBuilder::IsLarge(const BoundaryPiece& walk) const {
  const auto of_source = static_cast<std::size_t>(source_.PatchOf(walk.front()));
  const auto of_target = static_cast<std::size_t>(target_.PatchOf(walk.front()));
  return source_shares_[of_source] > options_.large_patch ||
         target_shares_[of_target] > options_.large_patch;
}

void LayoutBuilder::MeasurePatches() {
  source_shares_ = SharesOf(source_);
  target_shares_ = SharesOf(target_);
}

std::vector<LayoutBuilder::Candidate> LayoutBuilder::Shortcuts(const BoundaryPiece& walk) const {
  std::vector<double> along = {0};  // m, of both, at the start of each path
  for (const int directed : walk) {
    along.push_back(along.back() + source_.LengthOf(directed / 2) + target_.LengthOf(directed / 2));
  }
  std::vector<Candidate> shortcuts;
  for (std::size_t a = 0; a < walk.size(); ++a) {
    for (std::size_t b = a + 1; b < walk.size(); ++b) {
      if (source_.NodeOf(walk[a]) == source_.NodeOf(walk[b])) continue;
      const double forwards = along[b] - along[a];
      const double way = std::min(forwards, along.back() - forwards);
      const Candidate candidate = MakeCandidate({}, walk[a], walk[b], way);
      if (candidate.score <= options_.shortcut) shortcuts.push_back(candidate);
    }
  }
  return shortcuts;
}

absl::Status LayoutBuilder::Subdivide() {
  MeasurePatches();
  for (std::size_t patch = 0; patch < walks_.size(); ++patch) {
    while (IsLarge(walks_[patch])) {
      Searched searched;
      const std::optional<Candidate> best =
          Best(Shortcuts(walks_[patch]), options_.shortcut, searched);
      if (!best) break;
      MORTISE_ASSIGN_OR_RETURN(const int path, Add(*best));
      if (source_.SplitPatch(path) < 0 || target_.SplitPatch(path) < 0) {
        return absl::InternalError("a path across a disk does not divide it");
      }
      walks_[patch] = source_.Walk(2 * path);
      walks_.push_back(source_.Walk(2 * path + 1));
      MeasurePatches();
    }
  }
  return absl::OkStatus();
}

}  // namespace mortise::interpolator
