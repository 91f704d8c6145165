#include "tools/boat/boat_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

namespace mortise::parametric {
namespace {

using Eigen::Vector3d;

// Lengths in m.
constexpr double kLength = 0.32;
constexpr double kHalfBeam = 0.06;
constexpr double kDepth = 0.065;          // keel to gunwale amidships
constexpr double kRake = 0.16 * kLength;  // by which the stem leans over the keel
constexpr double kBowRise = 0.022;        // of the gunwale, from amidships to the bow
constexpr double kSternRise = 0.007;      // of the gunwale, to the stern
constexpr double kKeelRise = 0.007;       // of the keel, to both ends
constexpr double kWidest = 0.45;          // station where the hull is widest
constexpr double kTransomWidth = 0.8;     // of the beam
constexpr double kRim = 0.0045;           // thickness of the bulwark
constexpr double kWell = 0.011;           // height of the bulwark over the deck
constexpr double kHouseHeight = 0.018;
constexpr double kBridgeHeight = 0.024;
constexpr double kFunnelHeight = 0.030;
constexpr double kFunnelRadius = 0.0125;

// Sections of the hull, from the transom (0) to the stem (1), and the fractions of the half beam
// that divide the deck.
constexpr std::array<double, 20> kStations = {0,    0.035,  0.1,   0.17, 0.22,  0.265, 0.2875,
                                              0.31, 0.3325, 0.355, 0.41, 0.47,  0.53,  0.59,
                                              0.65, 0.72,   0.8,   0.88, 0.945, 1};
constexpr int kBow = static_cast<int>(kStations.size()) - 1;
constexpr std::array<double, 5> kColumns = {0, 0.2, 0.42, 0.64, 1};
constexpr int kInner = static_cast<int>(kColumns.size()) - 1;  // inside of the bulwark
constexpr int kOuter = kInner + 1;                             // outside of it
constexpr int kLevels = 5;                                     // of the hull's sides

// Cells from `first_station` to `last_station`, from the middle to `columns`.
struct Region {
  int first_station, last_station, columns;
  bool Has(int station, int column) const {
    return station >= first_station && station < last_station && column < columns;
  }
};
constexpr Region kWellRegion = {1, kBow - 1, kInner};
constexpr Region kHouseRegion = {4, 15, 3};
constexpr Region kFunnelRegion = {5, 9, 2};
constexpr Region kBridgeRegion = {11, 14, 2};

double HalfBreadth(double t) {
  const double aft = std::max(0.0, (kWidest - t) / kWidest);
  const double fore = std::max(0.0, (t - kWidest) / (1 - kWidest));
  return kHalfBeam * (1 - (1 - kTransomWidth) * aft * aft) * (1 - std::pow(fore, 2.3));
}

double KeelHeight(double t) {
  const double end = (t - 0.5) / 0.5;
  return kKeelRise * end * end;
}

double GunwaleHeight(double t) {
  const double aft = std::max(0.0, (kWidest - t) / kWidest);
  const double fore = std::max(0.0, (t - kWidest) / (1 - kWidest));
  return kDepth + kSternRise * aft * aft + kBowRise * fore * fore;
}

// Sections are quarters of superellipses: round boxes amidships, nearly wedges at the bow.
double Exponent(double t) { return 3.2 - 1.9 * std::pow(std::max(0.0, (t - 0.4) / 0.6), 1.2); }

// x of station t at the height z.
double Forward(double t, double z) {
  const double height = (z - KeelHeight(t)) / (GunwaleHeight(t) - KeelHeight(t));
  return t * (kLength - kRake * (1 - height));
}

// Half the breadth of the hull's outside at the height z.
double BreadthAt(double t, double z) {
  const double height = (z - KeelHeight(t)) / (GunwaleHeight(t) - KeelHeight(t));
  const double n = Exponent(t);
  return HalfBreadth(t) * std::pow(1 - std::pow(1 - height, n), 1 / n);
}

// A point of the starboard half (y >= 0) and where on the deck's grid it belongs.
struct Vertex {
  Vector3d at;
  int station = 0;
  int column = 0;
};

struct Polygon {
  std::string face;
  std::vector<int> corners;  // counter-clockwise from outside
};

// The half at y >= 0, open along the middle plane.
class HalfBoat {
 public:
  HalfBoat() {
    DrawHull();
    DrawTransom();
    DrawTop();
  }

  // Moves the cells of `face` in a region, which are then called `cap`, and closes the gap round
  // them by walls, except in the middle plane.
  void Extrude(const Region& region, const std::string& face, const std::string& wall,
               const std::string& cap, const std::function<Vector3d(const Vertex&)>& move) {
    std::vector<std::size_t> inside;
    std::set<std::pair<int, int>> edges;
    for (std::size_t p = 0; p < polygons_.size(); ++p) {
      if (polygons_[p].face != face || !Within(region, polygons_[p])) continue;
      inside.push_back(p);
      ForEdges(polygons_[p].corners, [&](int a, int b) { edges.emplace(a, b); });
    }
    std::map<int, int> moved;
    const auto move_vertex = [&](int v) {
      const auto [found, is_new] = moved.emplace(v, static_cast<int>(vertices_.size()));
      if (is_new) {
        Vertex copy = vertices_[static_cast<std::size_t>(v)];
        copy.at = move(copy);
        vertices_.push_back(copy);
      }
      return found->second;
    };
    for (const auto& [a, b] : edges) {
      if (edges.contains({b, a}) || (IsMiddle(a) && IsMiddle(b))) continue;
      polygons_.push_back({wall, {a, b, move_vertex(b), move_vertex(a)}});
    }
    for (const std::size_t p : inside) {
      polygons_[p].face = cap;
      for (int& corner : polygons_[p].corners) corner = move_vertex(corner);
    }
  }

  // Sinks a pane into every wall of this name that is wide enough.
  void AddWindows(const std::string& wall, double least_width) {
    const std::vector<Polygon> before = std::exchange(polygons_, {});
    for (const Polygon& polygon : before) {
      if (polygon.face == wall && polygon.corners.size() == 4 &&
          (At(polygon.corners[1]) - At(polygon.corners[0])).norm() >= least_width) {
        AddWindow(polygon);
      } else {
        polygons_.push_back(polygon);
      }
    }
  }

  // Both halves, in triangles.
  CageSurface Mirrored() const {
    CageSurface surface;
    std::vector<Vector3d> points;
    std::vector<int> index(vertices_.size(), -1), mirror(vertices_.size(), -1);
    std::map<std::string, std::vector<Eigen::Vector3i>> triangles;
    std::vector<std::string> order;
    const auto add = [&](int v, bool port) {
      int& known = (port && !IsMiddle(v) ? mirror : index)[static_cast<std::size_t>(v)];
      if (known < 0) {
        known = static_cast<int>(points.size());
        points.push_back(At(v).cwiseProduct(Vector3d(1, port ? -1 : 1, 1)));
      }
      return known;
    };
    for (const Polygon& polygon : polygons_) {
      if (!triangles.contains(polygon.face)) order.push_back(polygon.face);
      for (std::size_t k = 2; k < polygon.corners.size(); ++k) {
        const int a = polygon.corners[0], b = polygon.corners[k - 1], c = polygon.corners[k];
        // Where the sections close at the stem, a triangle and its mirror image are the same.
        if (IsMiddle(a) && IsMiddle(b) && IsMiddle(c)) continue;
        triangles[polygon.face].emplace_back(add(a, false), add(b, false), add(c, false));
        triangles[polygon.face].emplace_back(add(a, true), add(c, true), add(b, true));
      }
    }
    surface.vertices.resize(3, static_cast<Eigen::Index>(points.size()));
    for (std::size_t v = 0; v < points.size(); ++v) {
      // The quotient is the double nearest to the decimal number in the file.
      surface.vertices.col(static_cast<Eigen::Index>(v)) = (1e5 * points[v]).array().round() / 1e5;
    }
    for (const std::string& face : order) {
      const auto& list = triangles.at(face);
      CageFace& entry = surface.faces.emplace_back();
      entry.name = face;
      entry.triangles.resize(3, static_cast<Eigen::Index>(list.size()));
      for (std::size_t t = 0; t < list.size(); ++t) {
        entry.triangles.col(static_cast<Eigen::Index>(t)) = list[t];
      }
    }
    return surface;
  }

 private:
  const Vector3d& At(int v) const { return vertices_[static_cast<std::size_t>(v)].at; }
  bool IsMiddle(int v) const { return At(v).y() == 0; }

  int Add(const Vector3d& at, int station, int column) {
    vertices_.push_back({at, station, column});
    return static_cast<int>(vertices_.size()) - 1;
  }

  // A polygon without repeated corners.
  void Fill(const std::string& face, std::vector<int> corners) {
    corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
    if (corners.front() == corners.back()) corners.pop_back();
    if (corners.size() >= 3) polygons_.push_back({face, std::move(corners)});
  }

  bool Within(const Region& region, const Polygon& polygon) const {
    int station = kBow, column = kOuter;
    for (const int v : polygon.corners) {
      station = std::min(station, vertices_[static_cast<std::size_t>(v)].station);
      column = std::min(column, vertices_[static_cast<std::size_t>(v)].column);
    }
    return region.Has(station, column);
  }

  static void ForEdges(const std::vector<int>& corners,
                       const std::function<void(int, int)>& visit) {
    for (std::size_t k = 0; k < corners.size(); ++k) {
      visit(corners[k], corners[(k + 1) % corners.size()]);
    }
  }

  void DrawHull() {
    for (int i = 0; i <= kBow; ++i) {
      const double t = kStations[static_cast<std::size_t>(i)];
      std::vector<int>& section = hull_.emplace_back();
      for (int k = 0; k <= kLevels; ++k) {
        const double angle = k * std::numbers::pi / (2 * kLevels);
        const double rise = k == kLevels ? 1 : 1 - std::pow(std::cos(angle), 2 / Exponent(t));
        const double z = KeelHeight(t) + rise * (GunwaleHeight(t) - KeelHeight(t));
        const double y =
            k == 0 || i == kBow ? 0 : HalfBreadth(t) * std::pow(std::sin(angle), 2 / Exponent(t));
        section.push_back(Add({Forward(t, z), y, z}, i, kOuter));
      }
    }
    for (std::size_t i = 0; i < kBow; ++i) {
      for (std::size_t k = 0; k < kLevels; ++k) {
        Fill("hull", {hull_[i][k], hull_[i][k + 1], hull_[i + 1][k + 1], hull_[i + 1][k]});
      }
    }
  }

  // y of a column of the deck at a station, at the height of the gunwale.
  static double ColumnOffset(int i, int column) {
    const double half = HalfBreadth(kStations[static_cast<std::size_t>(i)]);
    if (column == kOuter) return half;
    return std::max(half - kRim, 0.6 * half) * kColumns[static_cast<std::size_t>(column)];
  }

  // In strips from the middle outwards; the uppermost has the deck's columns at its upper edge.
  void DrawTransom() {
    const int edge = hull_[0][kLevels];
    std::vector<int> upper;
    for (int j = 0; j < kOuter; ++j) {
      upper.push_back(Add({At(edge).x(), ColumnOffset(0, j), At(edge).z()}, 0, j));
    }
    upper.push_back(edge);
    int middle = hull_[0][0];
    for (std::size_t k = 1; k < kLevels; ++k) {
      const int outer = hull_[0][k];
      const int above = Add({At(outer).x(), 0, At(outer).z()}, 0, 0);
      Fill("transom", {middle, above, outer, hull_[0][k - 1]});
      middle = above;
    }
    std::vector<int> corners = {middle};
    corners.insert(corners.end(), upper.begin(), upper.end());
    corners.push_back(hull_[0][kLevels - 1]);
    Fill("transom", std::move(corners));
    top_.push_back(std::move(upper));
  }

  // The top of the hull as if it were closed at the gunwale.
  void DrawTop() {
    for (int i = 1; i <= kBow; ++i) {
      const int outer = hull_[static_cast<std::size_t>(i)][kLevels];
      std::vector<int>& row = top_.emplace_back();
      for (int j = 0; j < kOuter && i < kBow; ++j) {
        row.push_back(Add({At(outer).x(), ColumnOffset(i, j), At(outer).z()}, i, j));
      }
      row.resize(static_cast<std::size_t>(kOuter) + 1, outer);
    }
    for (std::size_t i = 0; i < kBow; ++i) {
      for (std::size_t j = 0; j < kOuter; ++j) {
        const bool well = kWellRegion.Has(static_cast<int>(i), static_cast<int>(j));
        Fill(well ? "deck" : "rim",
             {top_[i][j], top_[i + 1][j], top_[i + 1][j + 1], top_[i][j + 1]});
      }
    }
  }

  void AddWindow(const Polygon& wall) {
    constexpr double kFrame = 0.72, kInset = 0.0015;
    Vector3d center = Vector3d::Zero();
    for (const int v : wall.corners) center += At(v) / 4;
    const Vector3d normal = (At(wall.corners[2]) - At(wall.corners[0]))
                                .cross(At(wall.corners[3]) - At(wall.corners[1]))
                                .normalized();
    std::vector<int> inner, pane;
    for (const int v : wall.corners) {
      const Vector3d at = center + kFrame * (At(v) - center);
      inner.push_back(Add(at, 0, 0));
      pane.push_back(Add(at - kInset * normal, 0, 0));
    }
    for (std::size_t k = 0; k < 4; ++k) {
      const std::size_t next = (k + 1) % 4;
      Fill(wall.face, {wall.corners[k], wall.corners[next], inner[next], inner[k]});
      Fill("windows", {inner[k], inner[next], pane[next], pane[k]});
    }
    Fill("windows", pane);
  }

  std::vector<Vertex> vertices_;
  std::vector<Polygon> polygons_;
  std::vector<std::vector<int>> hull_, top_;  // vertices by station, then level or column
};

// A point of the funnel's foot or top: the cells of its region, which are a square of 4 x 4, as a
// disc.
Vector3d OnDisc(const Vertex& vertex, const Vector3d& center, double radius) {
  const int a = vertex.station - (kFunnelRegion.first_station + kFunnelRegion.last_station) / 2;
  const int b = vertex.column;
  const int ring = std::max(std::abs(a), b);
  if (ring == 0) return center;
  const int step = a == ring ? b : b == ring ? 2 * ring - a : 4 * ring - b;
  const double angle = step * std::numbers::pi / (4 * ring);
  const bool middle = b == 0;
  return center + radius * ring / 2 * Vector3d(std::cos(angle), middle ? 0 : std::sin(angle), 0);
}

// A tube, a little raked and narrower at the top, with a hollow.
void DrawFunnel(HalfBoat& boat, const Vector3d& foot) {
  const Vector3d top = foot + Vector3d(-0.005, 0, kFunnelHeight);
  boat.Extrude(kFunnelRegion, "house_roof", "funnel", "funnel_top",
               [&](const Vertex& vertex) { return OnDisc(vertex, top, 0.9 * kFunnelRadius); });
  boat.Extrude(kFunnelRegion, "funnel_top", "funnel", "funnel_mouth",
               [&](const Vertex& vertex) { return OnDisc(vertex, top, 0.68 * kFunnelRadius); });
  boat.Extrude(kFunnelRegion, "funnel_mouth", "funnel", "funnel", [&](const Vertex& vertex) {
    return OnDisc(vertex, top - Vector3d(0, 0, 0.004), 0.68 * kFunnelRadius);
  });
}

// A box that leans in, with windows, under a roof that reaches over them.
void DrawBridge(HalfBoat& boat, double house_roof) {
  constexpr double kLean = 0.004, kEaves = 0.003, kRoofThickness = 0.0035;
  const double top = house_roof + kBridgeHeight;
  boat.Extrude(kBridgeRegion, "house_roof", "bridge", "bridge_roof", [&](const Vertex& vertex) {
    const bool front = vertex.station == kBridgeRegion.last_station;
    return Vector3d(vertex.at.x() - (front ? kLean : 0), 0.94 * vertex.at.y(), top);
  });
  boat.AddWindows("bridge", 0.009);
  const auto eaves = [&](const Vertex& vertex) {
    const double x = vertex.station == kBridgeRegion.first_station  ? -kEaves
                     : vertex.station == kBridgeRegion.last_station ? kEaves
                                                                    : 0;
    const double y = vertex.column == kBridgeRegion.columns ? kEaves : 0;
    return Vector3d(vertex.at + Vector3d(x, y, 0));
  };
  boat.Extrude(kBridgeRegion, "bridge_roof", "bridge_roof", "bridge_eaves", eaves);
  boat.Extrude(
      kBridgeRegion, "bridge_eaves", "bridge_roof", "bridge_roof",
      [&](const Vertex& vertex) { return Vector3d(vertex.at + Vector3d(0, 0, kRoofThickness)); });
}

bool IsFunnel(const Vertex& vertex) {
  return vertex.station >= kFunnelRegion.first_station &&
         vertex.station <= kFunnelRegion.last_station && vertex.column <= kFunnelRegion.columns;
}

}  // namespace

CageSurface DrawBoat() {
  HalfBoat boat;
  boat.Extrude(kWellRegion, "deck", "bulwark", "deck", [](const Vertex& vertex) {
    const double t = kStations[static_cast<std::size_t>(vertex.station)];
    const double z = vertex.at.z() - kWell;
    // Where the hull narrows below, the bulwark stays as thick.
    const double widest = std::min(HalfBreadth(t), BreadthAt(t, z)) - kRim;
    const double half = std::max(HalfBreadth(t) - kRim, 0.6 * HalfBreadth(t));
    return Vector3d(Forward(t, z), vertex.at.y() * std::min(1.0, widest / half), z);
  });
  const double roof = kDepth - kWell + kHouseHeight;
  const Vector3d foot(0.089, 0, roof);
  boat.Extrude(kHouseRegion, "deck", "house", "house_roof", [&](const Vertex& vertex) {
    return IsFunnel(vertex) ? OnDisc(vertex, foot, kFunnelRadius)
                            : Vector3d(vertex.at.x(), 0.97 * vertex.at.y(), roof);
  });
  DrawFunnel(boat, foot);
  DrawBridge(boat, roof);
  return boat.Mirrored();
}

}  // namespace mortise::parametric
