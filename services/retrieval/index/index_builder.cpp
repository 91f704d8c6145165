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

constexpr Index kMostLeading = 16;          // d
constexpr Index kMostForCovariance = 4096;  // centres, evenly spread over the collection
constexpr int kLeafSize = 8;
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
  if (primitive.radii.size() != axes || (axes > 0 && !(primitive.radii.minCoeff() > 0)))
    return InvalidField(Named(cover, at), "needs a radius above 0 for each axis");
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
    if (i > 0 && sorted[i].family == sorted[i - 1].family)
      return InvalidField(name, "this family is there twice");
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
};

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
    const Index used = std::min(total, kMostForCovariance);
    MatrixXd centers(size, used);
    for (Index i = 0; i < used; ++i)
      centers.col(i) = items_[static_cast<std::size_t>(i * total / used)].primitive->center;
    mean_ = centers.rowwise().mean();
    centers.colwise() -= mean_;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(centers * centers.transpose());
    components_ = solver.eigenvectors().rightCols(std::min(size, kMostLeading)).rowwise().reverse();
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
    if (std::all_of(begin, end, [&](const Item& item) { return item.family == family; }))
      node.family = family;
    arrays_.nodes.push_back(node);
    AddBounds(first, last);
    if (last - first <= kLeafSize) {
      std::sort(begin, end, [](const Item& a, const Item& b) {
        return std::pair(a.family, a.number) < std::pair(b.family, b.number);
      });
      return number;
    }
    const std::int32_t middle = Halve(first, last);
    const std::int32_t left = Divide(first, middle);
    const std::int32_t right = Divide(middle, last);
    arrays_.nodes[static_cast<std::size_t>(number)].left = left;
    arrays_.nodes[static_cast<std::size_t>(number)].right = right;
    return number;
  }

  // Puts the smaller half first, by the coordinate with the largest spread; sizes count as one, so
  // that large ellipsoids do not widen the bounds of small ones.
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
    const std::int32_t middle = first + (last - first) / 2;
    std::nth_element(items_.begin() + first, items_.begin() + middle, items_.begin() + last,
                     [&](const Item& a, const Item& b) {
                       const double left = KeyOf(a, widest), right = KeyOf(b, widest);
                       return std::tie(left, a.family, a.number) <
                              std::tie(right, b.family, b.number);
                     });
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
           .structure = primitive.structure});
      for (const double value : primitive.center)
        arrays_.vectors.push_back(static_cast<float>(value));
      for (const double value : primitive.axes.reshaped())
        arrays_.vectors.push_back(static_cast<float>(value));
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
