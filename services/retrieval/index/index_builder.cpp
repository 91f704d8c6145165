// Principal components of the centres, then halves of halves.
#include "services/retrieval/index/index_builder.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kMaxLeading = 64;          // d
constexpr Index kMaxForCovariance = 4096;  // centres, evenly spread over the collection
constexpr int kLeafSize = 16;
constexpr int kGroupSize = 256;     // of a leaf that is one group
constexpr double kMaxMisfit = 0.1;  // within a group, of the largest radius
constexpr double kMaxDrift = 0.25;  // within a group, of the collection's extent
constexpr double kSlack = 1e-6;  // of a bound's radius and place: axes of floats are not quite unit

std::string Named(const FamilyCover& cover, std::size_t primitive) {
  return absl::StrCat("covers[", cover.family, "].primitives[", primitive, "]");
}

absl::Status CheckPrimitive(const FamilyCover& cover, std::size_t at, Index dimension) {
  const Primitive& primitive = cover.primitives[at];
  const Index axes = primitive.axes.cols();
  if (primitive.center.size() != dimension || dimension == 0 ||
      (axes > 0 && primitive.axes.rows() != dimension)) {
    return InvalidField(Named(cover, at),
                        "has another dimension than the first primitive, or none");
  }
  if (primitive.radii.size() != axes || (axes > 0 && !(primitive.radii.minCoeff() > 0))) {
    return InvalidField(Named(cover, at), "needs a radius above 0 for each axis");
  }
  if (!primitive.center.allFinite() || !primitive.axes.allFinite() ||
      !primitive.radii.allFinite() || !primitive.parameters.allFinite()) {
    return InvalidField(Named(cover, at), "has numbers that are not finite");
  }
  return absl::OkStatus();
}

absl::Status Check(const std::vector<FamilyCover>& sorted) {
  Index dimension = -1;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const std::string name = absl::StrCat("covers[", sorted[i].family, "]");
    if (sorted[i].family < 0) return InvalidField(name, "a family's number must be 0 or more");
    if (i > 0 && sorted[i].family == sorted[i - 1].family) {
      return InvalidField(name, "this family is there twice");
    }
    for (std::size_t k = 0; k < sorted[i].primitives.size(); ++k) {
      if (dimension < 0) dimension = sorted[i].primitives[k].center.size();
      MORTISE_RETURN_IF_ERROR(CheckPrimitive(sorted[i], k, dimension));
    }
  }
  if (dimension < 0) return InvalidField("covers", "there is no primitive");
  return absl::OkStatus();
}

// One primitive on its way into the tree.
struct Item {
  std::int32_t family = 0;
  std::int32_t number = 0;
  const Primitive* primitive = nullptr;
  VectorXd place = {};      // d + 1: the centre's
  VectorXd half_size = {};  // d + 1: of a box around it
  double radius = 0;
  std::int32_t representative = 0;
  DriftEntry drift = {};
};

// How far `moved`, which has as many axes, reaches out of the box around `first` with its centre on
// that one's.
double MisfitOf(const Primitive& first, const Primitive& moved) {
  double misfit = 0;
  for (Index i = 0; i < first.axes.cols(); ++i) {
    const double sign = first.axes.col(i).dot(moved.axes.col(i)) < 0 ? -1 : 1;
    misfit += moved.radii[i] * (moved.axes.col(i) - sign * first.axes.col(i)).norm() +
              std::max(0.0, moved.radii[i] - first.radii[i]);
  }
  return misfit;
}

// Whether a primitive is so much like `first` that they are of one group, but for where it is.
bool HasShapeOf(const Primitive& first, const Primitive& other) {
  if (first.axes.cols() != other.axes.cols()) return false;
  double misfit = 0;
  for (Index i = 0; i < first.axes.cols(); ++i) {
    const double turned = 2 - 2 * std::abs(first.axes.col(i).dot(other.axes.col(i)));
    misfit += other.radii[i] * std::sqrt(std::max(0.0, turned)) +
              std::max(0.0, other.radii[i] - first.radii[i]);
  }
  return misfit <= kMaxMisfit * LargestRadius(first);
}

class Builder {
 public:
  explicit Builder(const std::vector<FamilyCover>& covers) {
    for (std::size_t i = 0; i < covers.size(); ++i) {
      arrays_.families.push_back(covers[i].family);
      for (std::size_t k = 0; k < covers[i].primitives.size(); ++k) {
        items_.push_back({.family = static_cast<std::int32_t>(i),
                          .number = static_cast<std::int32_t>(k),
                          .primitive = &covers[i].primitives[k]});
      }
    }
  }

  OwnedArrays Build() {
    FindComponents();
    for (Item& item : items_) Place(&item);
    Divide(0, static_cast<std::int32_t>(items_.size()));
    WritePrimitives();
    SetSizes();
    return std::move(arrays_);
  }

 private:
  void FindComponents() {
    const Index size = items_.front().primitive->center.size();
    const Index total = static_cast<Index>(items_.size());
    const Index used = std::min(total, kMaxForCovariance);
    MatrixXd centers(size, used);
    for (Index i = 0; i < used; ++i) {
      centers.col(i) = items_[static_cast<std::size_t>(i * total / used)].primitive->center;
    }
    mean_ = centers.rowwise().mean();
    centers.colwise() -= mean_;
    extent_ = std::sqrt(centers.squaredNorm() / static_cast<double>(used));
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(centers * centers.transpose());
    components_ = solver.eigenvectors().rightCols(std::min(size, kMaxLeading)).rowwise().reverse();
    arrays_.mean.assign(mean_.begin(), mean_.end());
    arrays_.components.assign(components_.data(), components_.data() + components_.size());
  }

  void Place(Item* item) const {
    const Primitive& primitive = *item->primitive;
    const VectorXd offset = primitive.center - mean_;
    const Index leading = components_.cols();
    item->place.resize(leading + 1);
    item->place.head(leading) = components_.transpose() * offset;
    item->place[leading] = (offset - components_ * item->place.head(leading)).norm();
    item->radius = LargestRadius(primitive);
    item->half_size.setConstant(leading + 1, item->radius);  // the length of the rest: by radius
    const MatrixXd spans = components_.transpose() * primitive.axes * primitive.radii.asDiagonal();
    for (Index i = 0; i < leading; ++i) item->half_size[i] = spans.row(i).norm();
  }

  // Makes the node of items first … last - 1 and what is below it; returns its number.
  std::int32_t Divide(std::int32_t first, std::int32_t last) {
    const auto number = static_cast<std::int32_t>(arrays_.nodes.size());
    NodeEntry node{.first = first, .last = last};
    const auto begin = items_.begin() + first, end = items_.begin() + last;
    const std::int32_t family = begin->family;
    if (std::all_of(begin, end, [&](const Item& item) { return item.family == family; })) {
      node.family = family;
    }
    arrays_.nodes.push_back(node);
    AddBounds(first, last);
    if (last - first <= kLeafSize || IsOneGroup(first, last)) {
      std::sort(begin, end, [](const Item& a, const Item& b) {
        return std::pair(a.family, a.number) < std::pair(b.family, b.number);
      });
      for (std::int32_t group = first; group < last;) group = Group(group, last);
      return number;
    }
    const std::int32_t middle = Halve(first, last);
    const std::int32_t left = Divide(first, middle);
    const std::int32_t right = Divide(middle, last);
    arrays_.nodes[static_cast<std::size_t>(number)].left = left;
    arrays_.nodes[static_cast<std::size_t>(number)].right = right;
    return number;
  }

  // Whether an item is nearly the same as the first of a group, and near it.
  bool BelongsTo(const Item& seed, const Item& item) const {
    return (item.place - seed.place).norm() <= kMaxDrift * extent_ &&
           HasShapeOf(*seed.primitive, *item.primitive);
  }

  bool IsOneGroup(std::int32_t first, std::int32_t last) const {
    return last - first <= kGroupSize &&
           std::all_of(items_.begin() + first, items_.begin() + last, [&](const Item& item) {
             return BelongsTo(items_[static_cast<std::size_t>(first)], item);
           });
  }

  // Makes a group of the item `first` and those up to `last` that are nearly the same; returns its
  // end.
  std::int32_t Group(std::int32_t first, std::int32_t last) {
    const auto begin = items_.begin() + first;
    const Item seed = *begin;
    const auto end = std::stable_partition(begin, items_.begin() + last,
                                           [&](const Item& item) { return BelongsTo(seed, item); });
    // From the middle of all, the others are the nearest.
    VectorXd middle = VectorXd::Zero(begin->place.size());
    for (auto item = begin; item != end; ++item) middle += item->place;
    middle /= static_cast<double>(end - begin);
    std::rotate(begin,
                std::min_element(begin, end,
                                 [&](const Item& a, const Item& b) {
                                   return (a.place - middle).squaredNorm() <
                                          (b.place - middle).squaredNorm();
                                 }),
                end);
    for (auto item = begin; item != end; ++item) {
      item->representative = first;
      item->drift = DriftFrom(*begin, *item);
      const double reach =
          (1 + kSlack) * (item->primitive->center - begin->primitive->center).norm() +
          static_cast<double>(item->drift.misfit);
      begin->drift.reach = std::max(begin->drift.reach, static_cast<float>((1 + kSlack) * reach));
    }
    return static_cast<std::int32_t>(end - items_.begin());
  }

  static DriftEntry DriftFrom(const Item& first, const Item& item) {
    DriftEntry drift;
    const VectorXd offset = item.primitive->center - first.primitive->center;
    const Index used =
        std::min<Index>(item.place.size() - 1, static_cast<Index>(drift.leading.size()));
    const VectorXd leading = (item.place - first.place).head(used);
    for (Index i = 0; i < used; ++i) {
      drift.leading[static_cast<std::size_t>(i)] = static_cast<float>(leading[i]);
    }
    const double rest = offset.squaredNorm() - leading.squaredNorm();
    drift.rest = static_cast<float>(std::sqrt(std::max(0.0, rest)) + kSlack * offset.norm());
    const double misfit = MisfitOf(*first.primitive, *item.primitive);
    drift.misfit = static_cast<float>((1 + kSlack) * misfit + kSlack * item.radius);
    return drift;
  }

  // Puts those with smaller coordinates first, by the coordinate with the largest spread, and
  // divides where there is the widest gap in the middle half; sizes count as a coordinate, so that
  // large ellipsoids do not widen the bounds of small ones.
  std::int32_t Halve(std::int32_t first, std::int32_t last) {
    const Index size = items_.front().place.size();
    VectorXd sum = VectorXd::Zero(size + 1), squares = sum;
    for (std::int32_t i = first; i < last; ++i) {
      const VectorXd key = KeyOf(items_[static_cast<std::size_t>(i)]);
      sum += key;
      squares += key.cwiseAbs2();
    }
    Index widest = 0;
    (squares - sum.cwiseAbs2() / (last - first)).maxCoeff(&widest);
    std::sort(items_.begin() + first, items_.begin() + last, [&](const Item& a, const Item& b) {
      const double left = KeyOf(a, widest), right = KeyOf(b, widest);
      return std::tie(left, a.family, a.number) < std::tie(right, b.family, b.number);
    });
    const std::int32_t quarter = (last - first) / 4;
    std::int32_t middle = first + (last - first) / 2;
    const auto gap_before = [&](std::int32_t i) {
      return KeyOf(items_[static_cast<std::size_t>(i)], widest) -
             KeyOf(items_[static_cast<std::size_t>(i - 1)], widest);
    };
    for (std::int32_t i = first + quarter; i < last - quarter; ++i) {
      if (gap_before(i) > gap_before(middle)) middle = i;
    }
    return middle;
  }

  static double KeyOf(const Item& item, Index at) {
    return at < item.place.size() ? item.place[at] : item.radius;
  }

  static VectorXd KeyOf(const Item& item) {
    VectorXd key(item.place.size() + 1);
    key << item.place, item.radius;
    return key;
  }

  void AddBounds(std::int32_t first, std::int32_t last) {
    const Index size = items_.front().place.size();
    VectorXd lower = VectorXd::Constant(size, std::numeric_limits<double>::infinity());
    VectorXd upper = -lower, middle = VectorXd::Zero(size);
    for (std::int32_t i = first; i < last; ++i) {
      const Item& item = items_[static_cast<std::size_t>(i)];
      lower = lower.cwiseMin(item.place - item.half_size);
      upper = upper.cwiseMax(item.place + item.half_size);
      middle += item.place / (last - first);
    }
    double radius = 0;
    for (std::int32_t i = first; i < last; ++i) {
      const Item& item = items_[static_cast<std::size_t>(i)];
      radius = std::max(radius, (item.place - middle).norm() + item.radius);
    }
    const double slack = kSlack * (middle.norm() + radius);
    arrays_.balls.insert(arrays_.balls.end(), middle.begin(), middle.end());
    arrays_.balls.push_back(radius + slack);
    lower.array() -= slack;
    upper.array() += slack;
    arrays_.boxes.insert(arrays_.boxes.end(), lower.begin(), lower.end());
    arrays_.boxes.insert(arrays_.boxes.end(), upper.begin(), upper.end());
  }

  void WritePrimitives() {
    for (const Item& item : items_) {
      const Primitive& primitive = *item.primitive;
      arrays_.primitives.push_back(
          {.vectors = static_cast<std::int64_t>(arrays_.vectors.size()),
           .radii = static_cast<std::int64_t>(arrays_.radii.size()),
           .parameters = static_cast<std::int64_t>(arrays_.parameters.size()),
           .axes = static_cast<std::int32_t>(primitive.axes.cols()),
           .parameter_count = static_cast<std::int32_t>(primitive.parameters.size()),
           .family = item.family,
           .number = item.number,
           .structure = primitive.structure,
           .representative = item.representative});
      arrays_.drifts.push_back(item.drift);
      for (const double value : primitive.center) {
        arrays_.vectors.push_back(static_cast<float>(value));
      }
      for (const double value : primitive.axes.reshaped()) {
        arrays_.vectors.push_back(static_cast<float>(value));
      }
      arrays_.radii.insert(arrays_.radii.end(), primitive.radii.begin(), primitive.radii.end());
      arrays_.parameters.insert(arrays_.parameters.end(), primitive.parameters.begin(),
                                primitive.parameters.end());
      arrays_.places.insert(arrays_.places.end(), item.place.begin(), item.place.end());
      arrays_.places.push_back((1 + kSlack) * item.radius);
      WriteLeadingAxes(primitive);
    }
  }

  void WriteLeadingAxes(const Primitive& primitive) {
    for (Index i = 0; i < primitive.axes.cols(); ++i) {
      const VectorXd part = components_.transpose() * primitive.axes.col(i);
      const VectorXd rest = primitive.axes.col(i) - components_ * part;
      arrays_.leading_axes.insert(arrays_.leading_axes.end(), part.begin(), part.end());
      arrays_.leading_axes.push_back(rest.norm());
    }
  }

  void SetSizes() {
    const auto count = [](const auto& array) { return static_cast<std::int64_t>(array.size()); };
    arrays_.sizes = {.dimension = mean_.size(),
                     .leading = components_.cols(),
                     .families = count(arrays_.families),
                     .primitives = count(arrays_.primitives),
                     .nodes = count(arrays_.nodes),
                     .vectors = count(arrays_.vectors),
                     .radii = count(arrays_.radii),
                     .parameters = count(arrays_.parameters)};
  }

  std::vector<Item> items_;
  VectorXd mean_;        // N
  MatrixXd components_;  // N × d
  double extent_ = 0;    // of the collection: how far centres are from their mean, about
  OwnedArrays arrays_;
};

// Rounds centres and axes to what is kept, so that all bounds are of that.
void RoundToFloats(std::vector<FamilyCover>* covers) {
  for (FamilyCover& cover : *covers) {
    for (Primitive& primitive : cover.primitives) {
      primitive.center = primitive.center.cast<float>().cast<double>().eval();
      primitive.axes = primitive.axes.cast<float>().cast<double>().eval();
    }
  }
}

}  // namespace

absl::StatusOr<OwnedArrays> BuildArrays(std::vector<FamilyCover> covers) {
  std::sort(covers.begin(), covers.end(),
            [](const FamilyCover& a, const FamilyCover& b) { return a.family < b.family; });
  MORTISE_RETURN_IF_ERROR(Check(covers));
  RoundToFloats(&covers);
  return Builder(covers).Build();
}

}  // namespace mortise::retrieval
