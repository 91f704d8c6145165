#include "services/catalog/exchange/part_gaps.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace mortise::catalog {
namespace {

constexpr double kSame = 1e-2;  // of the contact: gaps that differ by no more are the same

enum Side { kBelow = 0, kAbove = 1 };  // of a box, along an axis

// What a box lacks on one side to meet another.
struct Lack {
  std::size_t box = 0, other = 0;
  int axis = 0;
  Side side = kBelow;
  double length = 0;
};

class GapClosing {
 public:
  GapClosing(double contact, const std::vector<int>& first_alike,
             const std::vector<Eigen::AlignedBox3d>& boxes)
      : contact_(contact), first_alike_(first_alike), boxes_(boxes), like_(boxes.size(), 0) {
    for (const int first : first_alike_) ++like_[static_cast<std::size_t>(first)];
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t j = i + 1; j < boxes.size(); ++j) AddLacks(i, j);
    }
  }

  std::vector<Eigen::AlignedBox3d> Closed() const {
    // How far each box and all that are like it are stretched, below and above.
    std::vector<Eigen::Matrix<double, 3, 2>> growth(boxes_.size(),
                                                    Eigen::Matrix<double, 3, 2>::Zero());
    for (std::size_t i = 0; i < lacks_.size(); i += 2) {
      const Lack& stretched = ToStretch(lacks_[i], lacks_[i + 1]);
      double& length = growth[FirstLike(stretched.box)](stretched.axis, stretched.side);
      length = std::max(length, stretched.length);
    }
    std::vector<Eigen::AlignedBox3d> closed = boxes_;
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      const std::size_t first = FirstLike(i);
      closed[i].min() -= growth[first].col(kBelow);
      closed[i].max() += growth[first].col(kAbove);
      // Alike to the last digit.
      if (i != first) closed[i].max() = closed[i].min() + closed[first].sizes();
    }
    return closed;
  }

 private:
  std::size_t FirstLike(std::size_t box) const {
    return static_cast<std::size_t>(first_alike_[box]);
  }

  int HowManyLike(std::size_t box) const { return like_[FirstLike(box)]; }

  // Of two boxes that are near each other: two lacks for each axis along which they are apart, the
  // one's and the other's.
  void AddLacks(std::size_t i, std::size_t j) {
    const Eigen::Vector3d below = boxes_[i].min() - boxes_[j].max(),
                          above = boxes_[j].min() - boxes_[i].max();
    if (below.cwiseMax(above).maxCoeff() > contact_) return;
    for (int axis = 0; axis < 3; ++axis) {
      const double length = std::max(below[axis], above[axis]);
      if (length <= 0) continue;
      const bool is_below = below[axis] > 0;
      lacks_.push_back({i, j, axis, is_below ? kBelow : kAbove, length});
      lacks_.push_back({j, i, axis, is_below ? kAbove : kBelow, length});
    }
  }

  // Whether every box that is like the one lacks the same on this side.
  bool IsShared(const Lack& lack) const {
    const auto has_it = [&](std::size_t box) {
      return std::any_of(lacks_.begin(), lacks_.end(), [&](const Lack& each) {
        return each.box == box && each.axis == lack.axis && each.side == lack.side &&
               std::abs(each.length - lack.length) <= kSame * contact_;
      });
    };
    for (std::size_t box = 0; box < boxes_.size(); ++box) {
      if (FirstLike(box) == FirstLike(lack.box) && !has_it(box)) return false;
    }
    return true;
  }

  const Lack& ToStretch(const Lack& a, const Lack& b) const {
    const auto size = [&](const Lack& lack) { return boxes_[lack.box].sizes().norm(); };
    const bool a_is_smaller = size(a) < size(b);
    const Lack& smaller = a_is_smaller ? a : b;
    const Lack& larger = a_is_smaller ? b : a;
    const bool has_more_like_it = HowManyLike(smaller.box) > HowManyLike(larger.box);
    return has_more_like_it && !IsShared(smaller) ? larger : smaller;
  }

  const double contact_;
  const std::vector<int>& first_alike_;
  const std::vector<Eigen::AlignedBox3d>& boxes_;
  std::vector<int> like_;  // at the first of those that are alike, how many they are
  std::vector<Lack> lacks_;
};

}  // namespace

void CloseGaps(double contact, const std::vector<int>& first_alike,
               std::vector<Eigen::AlignedBox3d>& boxes) {
  boxes = GapClosing(contact, first_alike, boxes).Closed();
}

}  // namespace mortise::catalog
