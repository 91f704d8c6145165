// Best first, through the tree and the primitives of its leaves.
#include "services/retrieval/index/primitive_index.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <queue>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/retrieval/index/index_builder.h"
#include "services/retrieval/index/primitive_distance.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;
using Eigen::Map;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kMaxDescriptors = 4;
// Of a bound: what rounding may take off a distance. Far more than it does, far less than matters.
constexpr double kSlack = 1e-5;
constexpr double kLittle = 0.02;  // of a square

// In what order matches are: by distance, family, primitive, turn.
auto Rank(const IndexMatch& match) {
  return std::tie(match.distance, match.family, match.primitive, match.turn);
}

bool IsNearer(const IndexMatch& a, const IndexMatch& b) { return Rank(a) < Rank(b); }

// The best match of each family, and the `count` best of these.
class Matches {
 public:
  Matches(const IndexArrays& arrays, const IndexQuery& query)
      : arrays_(arrays),
        query_(query),
        best_(arrays.families.size()),
        allowed_(arrays.families.size(), query.allowed ? kUnknown : kYes) {}

  bool IsAllowed(std::int32_t family) {
    char& known = allowed_[static_cast<std::size_t>(family)];
    if (known == kUnknown) {
      known = query_.allowed(arrays_.families[static_cast<std::size_t>(family)]) ? kYes : kNo;
    }
    return known == kYes;
  }

  // What a primitive of this family must not be further than to matter.
  double Limit(std::int32_t family) const {
    const auto& best = best_[static_cast<std::size_t>(family)];
    return best ? std::min(limit_, best->distance) : limit_;
  }

  // The same for any family.
  double Limit() const { return limit_; }

  // Takes note of a primitive's distance from one of the query's descriptors. `offset` is room for
  // N numbers.
  void Compare(std::int32_t entry, int turn, VectorXd* offset) {
    const PrimitiveEntry& primitive = arrays_.primitives[static_cast<std::size_t>(entry)];
    const VectorXd& x = query_.descriptors[static_cast<std::size_t>(turn)];
    Add(primitive.family, {.family = arrays_.families[static_cast<std::size_t>(primitive.family)],
                           .primitive = primitive.number,
                           .turn = turn,
                           .distance = DistanceFrom(arrays_, primitive, x.data(), offset->data()),
                           .entry = entry});
  }

  std::vector<IndexMatch> Take() { return std::move(top_); }

 private:
  void Add(std::int32_t family, const IndexMatch& match) {
    std::optional<IndexMatch>& best = best_[static_cast<std::size_t>(family)];
    if (best && !IsNearer(match, *best)) return;
    best = match;
    const auto same = std::find_if(top_.begin(), top_.end(), [&](const IndexMatch& each) {
      return each.family == match.family;
    });
    if (same != top_.end()) top_.erase(same);
    top_.insert(std::upper_bound(top_.begin(), top_.end(), match, IsNearer), match);
    const auto count = static_cast<std::size_t>(query_.count);
    if (top_.size() > count) top_.pop_back();
    if (top_.size() == count) limit_ = top_.back().distance;
  }

  static constexpr char kUnknown = 0, kYes = 1, kNo = 2;

  const IndexArrays& arrays_;
  const IndexQuery& query_;
  std::vector<std::optional<IndexMatch>> best_;
  std::vector<char> allowed_;
  std::vector<IndexMatch> top_;  // ascending
  double limit_ = std::numeric_limits<double>::infinity();
};

// One search.
class Search {
 public:
  Search(const IndexArrays& arrays, const IndexQuery& query)
      : arrays_(arrays),
        query_(query),
        matches_(arrays, query),
        width_(arrays.sizes.leading + 1),
        offset_(arrays.sizes.dimension) {}

  std::vector<IndexMatch> Run() {
    for (std::size_t turn = 0; turn < query_.descriptors.size(); ++turn) {
      places_.push_back(PlaceOf(query_.descriptors[turn]));
      Enqueue(0, static_cast<int>(turn));
    }
    while (!queue_.empty() && queue_.top().bound <= matches_.Limit()) {
      const Entry entry = queue_.top();
      queue_.pop();
      const NodeEntry& node = arrays_.nodes[static_cast<std::size_t>(entry.node)];
      if (IsSettled(node, entry.bound)) continue;
      if (node.left >= 0) {
        Enqueue(node.left, entry.turn);
        Enqueue(node.right, entry.turn);
      } else {
        VisitLeaf(node, entry.turn);
      }
    }
    return matches_.Take();
  }

  const IndexEffort& effort() const { return effort_; }

 private:
  struct Entry {
    double bound = 0;
    std::int32_t node = 0;
    std::int32_t turn = 0;
    bool operator<(const Entry& other) const {  // the smallest bound is on top of the queue
      return std::tie(bound, node, turn) > std::tie(other.bound, other.node, other.turn);
    }
  };

  VectorXd PlaceOf(const VectorXd& x) const {
    const Map<const VectorXd> mean(arrays_.mean.data(), x.size());
    const Map<const MatrixXd> components(arrays_.components.data(), x.size(), width_ - 1);
    const VectorXd offset = x - mean;
    VectorXd place(width_);
    place.head(width_ - 1) = components.transpose() * offset;
    place[width_ - 1] = (offset - components * place.head(width_ - 1)).norm();
    return place;
  }

  void Enqueue(std::int32_t node, int turn) {
    ++effort_.nodes;
    const double bound = BoundOf(node, places_[static_cast<std::size_t>(turn)]);
    if (bound <= matches_.Limit()) queue_.push({bound, node, turn});
  }

  // Never more than the distance of anything below a node.
  double BoundOf(std::int32_t node, const VectorXd& place) const {
    const double* ball = arrays_.balls.data() + node * (width_ + 1);
    const double radius = ball[width_];
    const double most = matches_.Limit() * (1 + 2 * kSlack) + radius;
    const double square = SquareBetween(place.data(), ball, most * most);
    const double to_ball = std::sqrt(square) - radius;
    if (square > most * most) return (1 - kSlack) * to_ball;
    const double* box = arrays_.boxes.data() + node * 2 * width_;
    const Map<const VectorXd> lower(box, width_), upper(box + width_, width_);
    const double to_box = (lower - place).cwiseMax(place - upper).cwiseMax(0).norm();
    return (1 - kSlack) * std::max({to_ball, to_box, 0.0});
  }

  // The square of the distance between places, or part of it that is above `most`: the first
  // components tell nearly all.
  double SquareBetween(const double* a, const double* b, double most) const {
    constexpr Index kAtOnce = 8;
    using Some = Eigen::Matrix<double, kAtOnce, 1>;
    double square = 0;
    Index i = 0;
    for (; i + kAtOnce <= width_; i += kAtOnce) {
      square += (Map<const Some>(a + i) - Map<const Some>(b + i)).squaredNorm();
      if (square > most) return square;
    }
    for (; i < width_; ++i) square += (a[i] - b[i]) * (a[i] - b[i]);
    return square;
  }

  // Whether a node of a single family holds nothing that matters.
  bool IsSettled(const NodeEntry& node, double bound) {
    return node.family >= 0 &&
           (!matches_.IsAllowed(node.family) || bound > matches_.Limit(node.family));
  }

  void VisitLeaf(const NodeEntry& leaf, int turn) {
    for (std::int32_t i = leaf.first; i < leaf.last;) {
      std::int32_t end = i + 1;
      while (end < leaf.last &&
             arrays_.primitives[static_cast<std::size_t>(end)].representative == i) {
        ++end;
      }
      if (end == i + 1) {
        Visit(i, turn);
      } else {
        VisitGroup(i, end, turn);
      }
      i = end;
    }
  }

  void Visit(std::int32_t i, int turn) {
    const PrimitiveEntry& primitive = arrays_.primitives[static_cast<std::size_t>(i)];
    if (!matches_.IsAllowed(primitive.family)) return;
    const double limit = matches_.Limit(primitive.family);
    if (PlaceBound(i, places_[static_cast<std::size_t>(turn)], limit) > limit) return;
    ++effort_.distances;
    matches_.Compare(i, turn, &offset_);
  }

  // Primitives that are nearly the same but for where they are: the distance from the first one's
  // box, which is convex, and its slope there bound those of all.
  void VisitGroup(std::int32_t first, std::int32_t end, int turn) {
    const VectorXd& place = places_[static_cast<std::size_t>(turn)];
    const double reach = static_cast<double>(arrays_.drifts[static_cast<std::size_t>(first)].reach);
    const double limit = matches_.Limit() + reach;
    if (PlaceBound(first, place, limit) > limit) return;
    const Slope slope = SlopeAt(first, turn);
    if (slope.bound > limit) return;
    for (std::int32_t i = first; i < end; ++i) {
      const PrimitiveEntry& primitive = arrays_.primitives[static_cast<std::size_t>(i)];
      const double bound = BoundAlong(slope, arrays_.drifts[static_cast<std::size_t>(i)], reach);
      if (bound > matches_.Limit()) continue;
      if (!matches_.IsAllowed(primitive.family) || bound > matches_.Limit(primitive.family)) {
        continue;
      }
      Visit(i, turn);
    }
  }

  using Leading = Eigen::Array<float, 16, 1>;

  // How the distance from a box changes with its place.
  struct Slope {
    double bound = 0;                   // of the distance
    Leading leading = Leading::Zero();  // towards the query: its unit vector along the components
    double rest = 1;                    // no more of it is beside these
  };

  Slope SlopeAt(std::int32_t first, int turn) {
    const PrimitiveEntry& primitive = arrays_.primitives[static_cast<std::size_t>(first)];
    const VectorXd& x = query_.descriptors[static_cast<std::size_t>(turn)];
    within_.resize(primitive.axes);
    ++effort_.distances;
    const BoxOffset box =
        OffsetFromBox(arrays_, primitive, x.data(), offset_.data(), within_.data());
    // Where little is left, its direction is that of the axes' rounding.
    if (!(box.box_square > kLittle * box.center_square)) return {};
    const double distance = std::sqrt(box.box_square);
    Slope slope{.bound = (1 - kSlack) * distance};
    const Index used = std::min<Index>(width_ - 1, slope.leading.size());
    VectorXd leading = places_[static_cast<std::size_t>(turn)].head(used) -
                       Map<const VectorXd>(arrays_.places.data() + first * (width_ + 1), used);
    for (std::int32_t i = 0; i < primitive.axes; ++i) {
      leading -=
          within_[i] *
          Map<const VectorXd>(arrays_.leading_axes.data() + (primitive.radii + i) * width_, used);
    }
    leading /= distance;
    slope.rest = std::sqrt(std::max(0.0, 1 - leading.squaredNorm()) + 3 * kSlack);
    slope.leading.head(used) = leading.cast<float>().array();
    return slope;
  }

  // Never more than the distance from a primitive of the group, as distances from convex sets lie
  // above their tangents.
  static double BoundAlong(const Slope& slope, const DriftEntry& drift, double reach) {
    const Map<const Leading> leading(drift.leading.data());
    const double along = static_cast<double>((slope.leading * leading).sum());
    return slope.bound - along - slope.rest * static_cast<double>(drift.rest) -
           static_cast<double>(drift.misfit) - 3 * kSlack * reach;
  }

  // Never more than the distance from a primitive; less than that as soon as it is above `limit`.
  double PlaceBound(std::int32_t i, const VectorXd& place, double limit) const {
    const double* known = arrays_.places.data() + i * (width_ + 1);
    const double most = limit * (1 + 2 * kSlack) + known[width_];
    const double square = SquareBetween(place.data(), known, most * most);
    if (square > most * most) return (1 - kSlack) * (std::sqrt(square) - known[width_]);
    const PrimitiveEntry& primitive = arrays_.primitives[static_cast<std::size_t>(i)];
    if (primitive.axes == 0) return (1 - kSlack) * std::sqrt(square);
    return TangentBound(primitive, place, known);
  }

  // Never more than the distance from a tangent whose centre has the place `known`. The offset x -
  // c is known along the components, and the length of its rest within limits; so is its part a
  // along each axis. An axis of radius r makes the square of the distance less than that of the
  // offset by a² at most, and where |a| > r, by a² - (|a| - r)²: the more the larger |a| is.
  double TangentBound(const PrimitiveEntry& primitive, const VectorXd& place,
                      const double* known) const {
    const Map<const VectorXd> center(known, width_);
    const auto offset = place.head(width_ - 1) - center.head(width_ - 1);
    const double shortest = std::abs(place[width_ - 1] - center[width_ - 1]);
    const double longest = place[width_ - 1] + center[width_ - 1];
    double square = (1 - kSlack) * (offset.squaredNorm() + shortest * shortest);
    for (std::int32_t i = 0; i < primitive.axes; ++i) {
      const double* axis = arrays_.leading_axes.data() + (primitive.radii + i) * width_;
      const double along =
          (1 + kSlack) * std::abs(offset.dot(Map<const VectorXd>(axis, width_ - 1))) +
          axis[width_ - 1] * longest;
      const double radius = arrays_.radii[static_cast<std::size_t>(primitive.radii + i)];
      square -= along <= radius ? along * along : radius * (2 * along - radius);
    }
    return (1 - kSlack) * std::sqrt(std::max(0.0, square));
  }

  const IndexArrays& arrays_;
  const IndexQuery& query_;
  Matches matches_;
  Index width_;  // d + 1
  VectorXd offset_;
  VectorXd within_;
  std::vector<VectorXd> places_;  // of each descriptor of the query
  std::priority_queue<Entry> queue_;
  IndexEffort effort_;
};

}  // namespace

absl::StatusOr<PrimitiveIndex> PrimitiveIndex::Build(std::vector<FamilyCover> covers) {
  MORTISE_ASSIGN_OR_RETURN(OwnedArrays arrays, BuildArrays(std::move(covers)));
  auto owner = std::make_shared<const OwnedArrays>(std::move(arrays));
  const IndexArrays view = owner->View();
  return PrimitiveIndex(view, std::move(owner));
}

PrimitiveIndex::PrimitiveIndex(IndexArrays arrays, std::shared_ptr<const void> owner)
    : arrays_(arrays), owner_(std::move(owner)) {}

absl::Status PrimitiveIndex::Check(const IndexQuery& query) const {
  if (query.count < 1) return InvalidField("count", "must be at least 1");
  if (query.descriptors.empty() || query.descriptors.size() > kMaxDescriptors) {
    return InvalidField("descriptors", "there must be one to four");
  }
  for (std::size_t i = 0; i < query.descriptors.size(); ++i) {
    const std::string name = absl::StrCat("descriptors[", i, "]");
    if (query.descriptors[i].size() != dimension()) {
      return InvalidField(name, absl::StrCat("must have ", dimension(), " numbers"));
    }
    if (!query.descriptors[i].allFinite()) {
      return InvalidField(name, "has numbers that are not finite");
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<IndexMatch>> PrimitiveIndex::Nearest(const IndexQuery& query,
                                                                IndexEffort* effort) const {
  MORTISE_RETURN_IF_ERROR(Check(query));
  Search search(arrays_, query);
  std::vector<IndexMatch> matches = search.Run();
  if (effort) *effort = search.effort();
  return matches;
}

absl::StatusOr<std::vector<IndexMatch>> PrimitiveIndex::LinearScan(const IndexQuery& query) const {
  MORTISE_RETURN_IF_ERROR(Check(query));
  Matches matches(arrays_, query);
  VectorXd offset(dimension());
  for (std::size_t turn = 0; turn < query.descriptors.size(); ++turn) {
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(arrays_.primitives.size()); ++i) {
      if (matches.IsAllowed(arrays_.primitives[static_cast<std::size_t>(i)].family)) {
        matches.Compare(i, static_cast<int>(turn), &offset);
      }
    }
  }
  return matches.Take();
}

Primitive PrimitiveIndex::PrimitiveOf(const IndexMatch& match) const {
  const PrimitiveEntry& entry = arrays_.primitives[static_cast<std::size_t>(match.entry)];
  const Index size = dimension();
  const Map<const Eigen::MatrixXf> vectors(arrays_.vectors.data() + entry.vectors, size,
                                           1 + entry.axes);
  return {.parameters = Map<const VectorXd>(arrays_.parameters.data() + entry.parameters,
                                            entry.parameter_count),
          .center = vectors.col(0).cast<double>(),
          .axes = vectors.rightCols(entry.axes).cast<double>(),
          .radii = Map<const VectorXd>(arrays_.radii.data() + entry.radii, entry.axes),
          .structure = entry.structure};
}

}  // namespace mortise::retrieval
