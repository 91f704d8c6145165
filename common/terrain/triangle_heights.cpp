// Heights as triangles: flat each, found by an R-tree of their boxes.
#include <algorithm>
#include <array>
#include <boost/geometry.hpp>
#include <boost/geometry/index/rtree.hpp>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/terrain/facet.h"
#include "common/terrain/height_field.h"
#include "common/terrain/place_faults.h"

namespace mortise::terrain {
namespace {

using Eigen::Vector2d;
using Eigen::Vector4d;
using Findings = std::vector<FieldViolation>;
using TreePoint = boost::geometry::model::point<double, 2, boost::geometry::cs::cartesian>;
using TreeBox = boost::geometry::model::box<TreePoint>;
using TreeEntry = std::pair<TreeBox, int>;
using Tree = boost::geometry::index::rtree<TreeEntry, boost::geometry::index::quadratic<16>>;

constexpr std::size_t kMostTold = 20;
constexpr double kUncovered = 1e-8;  // of a rectangle's area, which rounding explains
constexpr double kInset = 1e-8;      // m
constexpr int kHoleLevels = 20;      // quarters of a rectangle until a hole is found well enough

TreeBox BoxAround(const Rectangle& rectangle) {
  constexpr double kSlack = HeightField::kBorder;
  return {TreePoint(rectangle.from_x - kSlack, rectangle.from_y - kSlack),
          TreePoint(rectangle.to_x + kSlack, rectangle.to_y + kSlack)};
}

TreeBox BoxOf(const Facet& facet) {
  const Vector2d least = facet.corners[0].cwiseMin(facet.corners[1]).cwiseMin(facet.corners[2]);
  const Vector2d most = facet.corners[0].cwiseMax(facet.corners[1]).cwiseMax(facet.corners[2]);
  return {TreePoint(least.x(), least.y()), TreePoint(most.x(), most.y())};
}

Tree TreeOf(const std::vector<Facet>& facets) {
  std::vector<TreeEntry> entries;
  entries.reserve(facets.size());
  for (std::size_t i = 0; i < facets.size(); ++i) {
    entries.emplace_back(BoxOf(facets[i]), static_cast<int>(i));
  }
  return Tree(entries);
}

// ---- The field ----------------------------------------------------------------------------------

double WidthOf(const Rectangle& rectangle) { return rectangle.to_x - rectangle.from_x; }
double DepthOf(const Rectangle& rectangle) { return rectangle.to_y - rectangle.from_y; }

class TriangleHeights final : public HeightField {
 public:
  TriangleHeights(HeightTriangles given, std::vector<Facet> facets, Tree tree)
      : given_(std::move(given)), facets_(std::move(facets)), tree_(std::move(tree)) {}

  absl::StatusOr<PlaceValue> HeightAt(double x, double y) const override {
    MORTISE_ASSIGN_OR_RETURN(const Facet* const facet, FacetAt({x, y}));
    return PlaceValue{facet->HeightAt({x, y}), facet->gradient};
  }

  absl::StatusOr<PlaceValue> SlopeAt(double x, double y) const override {
    MORTISE_ASSIGN_OR_RETURN(const Facet* const facet, FacetAt({x, y}));
    return PlaceValue{facet->gradient.norm()};
  }

  GivenHeights Given() const override { return given_; }

  std::size_t MemoryUse() const override {
    return facets_.size() * (sizeof(Facet) + 2 * sizeof(TreeEntry)) +
           static_cast<std::size_t>(given_.vertices.size()) * sizeof(double) +
           static_cast<std::size_t>(given_.triangles.size()) * sizeof(int);
  }

 private:
  Rectangle Known() const {
    const TreeBox all = tree_.bounds();
    return {all.min_corner().get<0>(), all.max_corner().get<0>(), all.min_corner().get<1>(),
            all.max_corner().get<1>()};
  }

  std::vector<const Facet*> FacetsNear(const Rectangle& rectangle) const {
    std::vector<TreeEntry> found;
    tree_.query(boost::geometry::index::intersects(BoxAround(rectangle)),
                std::back_inserter(found));
    // The order of the tree's own making may be another in the next version of the library.
    std::sort(found.begin(), found.end(),
              [](const TreeEntry& a, const TreeEntry& b) { return a.second < b.second; });
    std::vector<const Facet*> near;
    for (const TreeEntry& entry : found) {
      near.push_back(&facets_[static_cast<std::size_t>(entry.second)]);
    }
    return near;
  }

  absl::StatusOr<const Facet*> FacetAt(const Vector2d& place) const {
    const Rectangle point = {place.x(), place.x(), place.y(), place.y()};
    for (const Facet* const facet : FacetsNear(point)) {
      if (LeastInside(*facet, place) >= -kBorder) return facet;
    }
    const Rectangle known = Known();
    const bool amid = place.x() >= known.from_x && place.x() <= known.to_x &&
                      place.y() >= known.from_y && place.y() <= known.to_y;
    return amid ? HoleAt(place.x(), place.y()) : NotKnownAt(known, place.x(), place.y());
  }

  absl::StatusOr<RectangleValue> LargestUnder(const Rectangle& rectangle,
                                              double sign) const override {
    const Rectangle known = Known();
    if (rectangle.from_x < known.from_x - kBorder || rectangle.to_x > known.to_x + kBorder ||
        rectangle.from_y < known.from_y - kBorder || rectangle.to_y > known.to_y + kBorder) {
      return NotKnownUnder(known, rectangle);
    }
    const bool is_thin = WidthOf(rectangle) <= 4 * kInset || DepthOf(rectangle) <= 4 * kInset;
    return is_thin ? LargestAlong(rectangle, sign) : LargestIn(rectangle, sign);
  }

  // An edge may run where the rectangle begins: it is taken a little smaller, so that derivatives
  // are those of what it covers. What that changes is taken back, exactly, as all of it is linear.
  absl::StatusOr<RectangleValue> LargestIn(const Rectangle& rectangle, double sign) const {
    const Rectangle inner = {rectangle.from_x + kInset, rectangle.to_x - kInset,
                             rectangle.from_y + kInset, rectangle.to_y - kInset};
    RectangleValue largest{-std::numeric_limits<double>::infinity()};
    double covered = 0;  // m²
    FacetCutter cutter;
    for (const Facet* const facet : FacetsNear(inner)) {
      const Cut& cut = cutter.Of(*facet, inner);
      covered += AreaOf(cut);
      for (const CutCorner& corner : cut) Raise(*facet, corner, sign, largest);
    }
    if (!IsAll(covered, inner)) return HoleIn(inner);
    largest.value -= largest.gradient.dot(Vector4d(kInset, -kInset, kInset, -kInset));
    return largest;
  }

  static void Raise(const Facet& facet, const CutCorner& corner, double sign,
                    RectangleValue& largest) {
    const double height = sign * facet.HeightAt(corner.place);
    if (height <= largest.value) return;
    largest = {height, sign * corner.derivatives.transpose() * facet.gradient};
  }

  // Whether that area is a rectangle's but for what rounding and the border explain.
  static bool IsAll(double covered, const Rectangle& rectangle) {
    const double area = WidthOf(rectangle) * DepthOf(rectangle);
    const double border = 2 * kBorder * (WidthOf(rectangle) + DepthOf(rectangle));
    return covered >= area * (1 - kUncovered) - border;
  }

  double CoveredArea(const Rectangle& rectangle) const {
    double covered = 0;
    FacetCutter cutter;
    for (const Facet* const facet : FacetsNear(rectangle)) {
      covered += AreaOf(cutter.Of(*facet, rectangle));
    }
    return covered;
  }

  // Told of the middle of the quarter of a quarter … that is covered least.
  absl::Status HoleIn(Rectangle rectangle) const {
    for (int level = 0; level < kHoleLevels; ++level) {
      const double middle_x = (rectangle.from_x + rectangle.to_x) / 2;
      const double middle_y = (rectangle.from_y + rectangle.to_y) / 2;
      const std::array<Rectangle, 4> quarters = {
          Rectangle{rectangle.from_x, middle_x, rectangle.from_y, middle_y},
          Rectangle{middle_x, rectangle.to_x, rectangle.from_y, middle_y},
          Rectangle{rectangle.from_x, middle_x, middle_y, rectangle.to_y},
          Rectangle{middle_x, rectangle.to_x, middle_y, rectangle.to_y}};
      double least = std::numeric_limits<double>::infinity();
      for (const Rectangle& quarter : quarters) {
        const double covered = CoveredArea(quarter);
        if (covered >= least) continue;
        least = covered;
        rectangle = quarter;
      }
      if (least <= 0) break;
    }
    return HoleAt((rectangle.from_x + rectangle.to_x) / 2, (rectangle.from_y + rectangle.to_y) / 2);
  }

  // Where the piece of a way that lies over a facet begins or ends.
  struct End {
    double share = 0;  // of the way
    int edge = -1;     // of the facet, that from this corner on; none where the way itself ends
  };

  // Nothing of a facet that the way does not cross: its begin comes after its end.
  static std::pair<End, End> PieceOver(const Facet& facet, const Vector2d& begin,
                                       const Vector2d& way) {
    End from{0}, to{1};
    for (std::size_t i = 0; i < 3; ++i) {
      const double at_begin = Inside(facet, i, begin) + kBorder;
      const double at_end = Inside(facet, i, begin + way) + kBorder;
      if (at_begin < 0 && at_end < 0) return {End{1}, End{0}};
      const End crossing{at_begin / (at_begin - at_end), static_cast<int>(i)};
      if (at_begin < 0 && crossing.share > from.share) from = crossing;
      if (at_end < 0 && crossing.share < to.share) to = crossing;
    }
    return {from, to};
  }

  // Of a line or a point. It is all known where the pieces over facets leave no gap.
  absl::StatusOr<RectangleValue> LargestAlong(const Rectangle& line, double sign) const {
    const bool is_across = WidthOf(line) >= DepthOf(line);
    const Vector2d begin(line.from_x, line.from_y);
    const Vector2d way = is_across ? Vector2d(std::max(0.0, WidthOf(line)), 0)
                                   : Vector2d(0, std::max(0.0, DepthOf(line)));
    if (way.norm() <= 2 * kBorder) return LargestAt(begin, sign);
    std::vector<std::pair<double, double>> pieces;
    RectangleValue largest{-std::numeric_limits<double>::infinity()};
    for (const Facet* const facet : FacetsNear(line)) {
      const auto [from, to] = PieceOver(*facet, begin, way);
      if (from.share > to.share) continue;
      pieces.emplace_back(from.share, to.share);
      for (const End& end : {from, to}) {
        const double height = sign * facet->HeightAt(begin + end.share * way);
        if (height <= largest.value) continue;
        largest = {height, sign * DerivativesAt(*facet, end, is_across)};
      }
    }
    const double slack = 2 * kBorder / way.norm();
    const double reached = ReachOf(pieces, slack);
    if (reached >= 1 - slack) return largest;
    const Vector2d gap = begin + std::min(1.0, reached + 2 * slack) * way;
    return HoleAt(gap.x(), gap.y());
  }

  // How far pieces go on from 0 without a gap.
  static double ReachOf(std::vector<std::pair<double, double>>& pieces, double slack) {
    std::sort(pieces.begin(), pieces.end());
    double reached = 0;
    for (const auto& [from, to] : pieces) {
      if (from > reached + slack) break;
      reached = std::max(reached, to);
    }
    return reached;
  }

  // Of the height at an end of a piece. An end of the line moves along it; where an edge crosses,
  // the place moves along the edge as the line moves sideways.
  static Vector4d DerivativesAt(const Facet& facet, const End& end, bool is_across) {
    const int along = is_across ? 0 : 1, sideways = 1 - along;
    Vector4d derivatives = Vector4d::Zero();
    if (end.edge < 0) {
      derivatives(2 * along + (end.share == 0 ? 0 : 1)) = facet.gradient(along);
      derivatives(2 * sideways) = facet.gradient(sideways);
      return derivatives;
    }
    const auto corner = static_cast<std::size_t>(end.edge);
    const Vector2d edge = facet.corners[(corner + 1) % 3] - facet.corners[corner];
    derivatives(2 * sideways) = facet.gradient.dot(edge) / edge(sideways);
    return derivatives;
  }

  absl::StatusOr<RectangleValue> LargestAt(const Vector2d& place, double sign) const {
    MORTISE_ASSIGN_OR_RETURN(const Facet* const facet, FacetAt(place));
    RectangleValue value{sign * facet->HeightAt(place)};
    value.gradient(0) = sign * facet->gradient.x();
    value.gradient(2) = sign * facet->gradient.y();
    return value;
  }

  const HeightTriangles given_;
  const std::vector<Facet> facets_;
  const Tree tree_;
};

// ---- Checks -------------------------------------------------------------------------------------

void CheckVertices(const Eigen::Matrix3Xd& vertices, Findings& findings) {
  for (Eigen::Index i = 0; i < vertices.size() && findings.size() < kMostTold; ++i) {
    if (std::abs(vertices.data()[i]) <= HeightField::kMaxFromOrigin) continue;
    findings.push_back({absl::StrCat("vertices[", i, "]"),
                        absl::StrCat("must be within ", HeightField::kMaxFromOrigin, " m")});
  }
}

void CheckIndices(const HeightTriangles& triangles, Findings& findings) {
  const Eigen::Index count = triangles.vertices.cols();
  for (Eigen::Index i = 0; i < triangles.triangles.size() && findings.size() < kMostTold; ++i) {
    const int index = triangles.triangles.data()[i];
    if (index >= 0 && index < count) continue;
    findings.push_back({absl::StrCat("triangles[", i, "]"),
                        absl::StrCat("there is no vertex ", index, "; there are ", count)});
  }
}

// "triangles[3]", the first index of the triangle of this number.
std::string FieldOf(std::size_t triangle) { return absl::StrCat("triangles[", 3 * triangle, "]"); }

void CheckAreas(const std::vector<Facet>& facets, Findings& findings) {
  for (std::size_t i = 0; i < facets.size() && findings.size() < kMostTold; ++i) {
    const std::array<Vector2d, 3>& corners = facets[i].corners;
    const double longest =
        std::max({(corners[1] - corners[0]).norm(), (corners[2] - corners[1]).norm(),
                  (corners[0] - corners[2]).norm()});
    if (DoubleArea(facets[i]) > 2 * HeightField::kBorder * longest) continue;
    findings.push_back(
        {FieldOf(i), absl::StrCat("triangle ", i, " has no area, seen from above, at x = ",
                                  corners[0].x(), " m, y = ", corners[0].y(), " m")});
  }
}

// Whether an edge of the first has all of the other facet beyond it.
bool IsApart(const Facet& facet, const Facet& other) {
  for (std::size_t i = 0; i < 3; ++i) {
    const double deepest =
        std::max({Inside(facet, i, other.corners[0]), Inside(facet, i, other.corners[1]),
                  Inside(facet, i, other.corners[2])});
    if (deepest <= 10 * HeightField::kBorder) return true;
  }
  return false;
}

void CheckBeside(const std::vector<Facet>& facets, const Tree& tree, Findings& findings) {
  std::vector<TreeEntry> near;
  for (std::size_t i = 0; i < facets.size() && findings.size() < kMostTold; ++i) {
    near.clear();
    tree.query(boost::geometry::index::intersects(BoxOf(facets[i])), std::back_inserter(near));
    for (const TreeEntry& entry : near) {
      const auto other = static_cast<std::size_t>(entry.second);
      if (other <= i || IsApart(facets[i], facets[other]) || IsApart(facets[other], facets[i])) {
        continue;
      }
      const Vector2d middle =
          (facets[other].corners[0] + facets[other].corners[1] + facets[other].corners[2]) / 3;
      findings.push_back({FieldOf(other), absl::StrCat("triangle ", other, " lies over triangle ",
                                                       i, ", seen from above, near x = ",
                                                       middle.x(), " m, y = ", middle.y(), " m")});
      break;
    }
  }
}

absl::Status CheckCounts(const HeightTriangles& triangles) {
  const auto most = static_cast<Eigen::Index>(HeightField::kMaxHeights);
  const Eigen::Index vertices = triangles.vertices.cols();
  if (vertices < 3 || vertices > most) {
    return InvalidField("vertices",
                        absl::StrCat("are ", vertices, "; 3 to ", most, " are accepted"));
  }
  const Eigen::Index count = triangles.triangles.cols();
  if (count < 1 || count > 2 * most) {
    return InvalidField("triangles",
                        absl::StrCat("are ", count, "; 1 to ", 2 * most, " are accepted"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::shared_ptr<const HeightField>> HeightField::Create(HeightTriangles triangles) {
  MORTISE_RETURN_IF_ERROR(CheckCounts(triangles));
  Findings findings;
  CheckVertices(triangles.vertices, findings);
  CheckIndices(triangles, findings);
  if (!findings.empty()) return InvalidFields(findings);
  std::vector<Facet> facets;
  for (Eigen::Index i = 0; i < triangles.triangles.cols(); ++i) {
    facets.push_back(FacetOf(triangles, i));
  }
  CheckAreas(facets, findings);
  if (!findings.empty()) return InvalidFields(findings);
  Tree tree = TreeOf(facets);
  CheckBeside(facets, tree, findings);
  if (!findings.empty()) return InvalidFields(findings);
  return std::make_shared<const TriangleHeights>(std::move(triangles), std::move(facets),
                                                 std::move(tree));
}

}  // namespace mortise::terrain
