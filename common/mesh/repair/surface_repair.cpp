#include "common/mesh/repair/surface_repair.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
// Before the half-edge mesh.
#include <CGAL/boost/graph/graph_traits_TriMesh_ArrayKernelT.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <boost/pending/disjoint_sets.hpp>
#include <cmath>
#include <exception>
#include <iterator>
#include <unordered_map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/mesh/halfedge_mesh.h"
#include "common/mesh/repair/triangle_soup.h"
#include "common/mesh/surface_check.h"

namespace mortise::mesh {
namespace {

namespace processing = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Kind = SurfaceFault::Kind;
using Triangles = std::vector<Eigen::Vector3i>;

constexpr double kNoVolume = 1e-12;  // of a piece's area to the power of 3/2
constexpr int kMaxFaults = 5;        // told of one surface
constexpr int kMaxRounds = 20;       // of dividing triangles
constexpr std::size_t kCubic = 100;  // edges of a hole that all triangulations may be tried of

Kernel::Point_3 ToPoint(const Eigen::Vector3d& vertex) {
  return {vertex.x(), vertex.y(), vertex.z()};
}

absl::Status Refusal(const std::vector<SurfaceFault>& faults) {
  if (faults.empty()) return absl::OkStatus();
  std::vector<FieldViolation> violations;
  for (const SurfaceFault& fault : faults) violations.push_back({"surface", fault.message});
  return InvalidFields(violations);
}

void AddFault(const SurfaceFault& fault, std::vector<SurfaceFault>& faults) {
  if (static_cast<int>(faults.size()) < kMaxFaults) faults.push_back(fault);
}

absl::Status CheckOptions(const RepairOptions& options) {
  if (!(options.tolerance >= 1e-9 && options.tolerance <= 1e-2)) {
    return InvalidField("tolerance", "must be within 1e-9 to 1e-2");
  }
  if (!(options.largest_hole >= 0 && options.largest_hole <= 1)) {
    return InvalidField("largest_hole", "must be within 0 to 1");
  }
  return absl::OkStatus();
}

// Triangles at places: each with an area, drawn once, and ending where its neighbours do.
absl::StatusOr<SurfaceMesh> Clean(TriangleSoup soup, SurfaceRepairs& repairs) {
  repairs.merged_vertices = soup.merged_vertices();
  for (int round = 0; round < kMaxRounds; ++round) {
    repairs.without_area += soup.DropDegenerate();
    repairs.drawn_twice += soup.DropRepeated();
    MORTISE_ASSIGN_OR_RETURN(const int split, soup.SplitAtVertices());
    if (split == 0) break;
    repairs.split_triangles += split;
  }
  SurfaceMesh cleaned = soup.Surface();
  if (cleaned.triangles.cols() == 0) {
    return InvalidField("surface", "has no triangles with an area");
  }
  return cleaned;
}

// Turns neighbours alike. Which side is the outside is not known yet.
absl::Status TurnAlike(SurfaceMesh& surface) {
  std::vector<Kernel::Point_3> points;
  for (const auto& vertex : surface.vertices.colwise()) points.push_back(ToPoint(vertex));
  std::vector<std::array<std::size_t, 3>> polygons;
  for (const auto& triangle : surface.triangles.colwise()) {
    polygons.push_back({static_cast<std::size_t>(triangle[0]),
                        static_cast<std::size_t>(triangle[1]),
                        static_cast<std::size_t>(triangle[2])});
  }
  // It may put copies of points in place of points, but at the same places.
  processing::orient_polygon_soup(points, polygons);
  for (std::size_t t = 0; t < polygons.size(); ++t) {
    auto triangle = surface.triangles.col(static_cast<Eigen::Index>(t));
    if (points[polygons[t][0]] != ToPoint(surface.vertices.col(triangle[0]))) {
      std::swap(triangle[0], triangle[2]);
    }
  }
  std::vector<SurfaceFault> faults;
  const CutSurface cut(surface.vertices, surface.triangles);
  for (const SurfaceEdge& edge : cut.edges()) {
    if (edge.triangles() != 2 || edge.IsJoined()) continue;
    AddFault(FaultAt(Kind::kFlippedEdge, surface.vertices.col(edge.low),
                     "the surface turns over: it has one side only, no inside and no outside,"),
             faults);
    break;  // it may be said of any edge across
  }
  return Refusal(faults);
}

// Where triangles are missing: the vertices around, none of them twice, with the missing triangles
// on the left, and the triangles beyond.
struct Hole {
  std::vector<int> vertices;
  std::vector<int> triangles;  // at the edge from each vertex to the next
};

// Takes what comes from `first` on off the path.
Hole TakeHole(std::size_t first, Hole& path) {
  const auto from = static_cast<std::ptrdiff_t>(first);
  Hole hole{{path.vertices.begin() + from, path.vertices.end()},
            {path.triangles.begin() + from, path.triangles.end()}};
  path.vertices.resize(first);
  path.triangles.resize(first);
  return hole;
}

std::vector<Hole> HolesOf(const CutSurface& surface) {
  const HalfedgeMesh& mesh = surface.mesh();
  std::vector<Hole> holes;
  std::vector<bool> seen(mesh.n_halfedges(), false);
  for (const OpenMesh::HalfedgeHandle start : mesh.all_halfedges()) {
    if (!mesh.is_boundary(start) || seen[static_cast<std::size_t>(start.idx())]) continue;
    Hole path;
    std::unordered_map<int, std::size_t> places;  // of vertices in the path
    for (auto halfedge = start; !seen[static_cast<std::size_t>(halfedge.idx())];
         halfedge = mesh.next_halfedge_handle(halfedge)) {
      seen[static_cast<std::size_t>(halfedge.idx())] = true;
      const int corner = surface.CornerOf(halfedge);
      // Holes that share a vertex have one border: where it returns to a vertex it has been round
      // one of them.
      if (const auto known = places.find(corner); known != places.end()) {
        holes.push_back(TakeHole(known->second, path));
        for (const int vertex : holes.back().vertices) places.erase(vertex);
      }
      places[corner] = path.vertices.size();
      path.vertices.push_back(corner);
      path.triangles.push_back(mesh.face_handle(mesh.opposite_halfedge_handle(halfedge)).idx());
    }
    if (!path.vertices.empty()) holes.push_back(std::move(path));
  }
  return holes;
}

double AreaOf(const Eigen::Matrix3Xd& vertices, const Eigen::Vector3i& triangle) {
  const Eigen::Vector3d a = vertices.col(triangle[0]);
  return (vertices.col(triangle[1]) - a).cross(vertices.col(triangle[2]) - a).norm() / 2;
}

// The connected piece of a surface that a triangle is in.
struct Piece {
  double area = 0;    // m²
  double volume = 0;  // m³, enclosed if it is closed; negative where it is inside out
};

// That of each triangle.
std::vector<Piece> PiecesOf(const SurfaceMesh& surface, const CutSurface& connected) {
  const auto count = static_cast<std::size_t>(surface.triangles.cols());
  boost::disjoint_sets_with_storage<> sets(count);
  for (std::size_t t = 0; t < count; ++t) sets.make_set(t);
  for (const SurfaceEdge& edge : connected.edges()) {
    if (edge.IsJoined()) {
      sets.union_set(connected.TriangleAt(edge, 0), connected.TriangleAt(edge, 1));
    }
  }
  std::vector<Piece> sums(count), pieces;
  for (std::size_t t = 0; t < count; ++t) {
    const auto root = static_cast<Eigen::Index>(sets.find_set(t));
    Piece& sum = sums[static_cast<std::size_t>(root)];
    const Eigen::Vector3i triangle = surface.triangles.col(static_cast<Eigen::Index>(t));
    sum.area += AreaOf(surface.vertices, triangle);
    // About a corner of the piece: far away from it, rounding would outweigh it.
    Eigen::Matrix3d corners = surface.vertices(Eigen::all, triangle);
    corners.colwise() -= surface.vertices.col(surface.triangles(0, root));
    sum.volume += corners.determinant() / 6;
  }
  for (std::size_t t = 0; t < count; ++t) pieces.push_back(sums[sets.find_set(t)]);
  return pieces;
}

// Triangles that fill a hole; none if there is no way to.
Triangles PatchOf(const Eigen::Matrix3Xd& vertices, const std::vector<int>& hole) {
  if (hole.size() == 3) return {{hole[0], hole[1], hole[2]}};
  std::vector<Kernel::Point_3> points;
  for (const int vertex : hole) points.push_back(ToPoint(vertices.col(vertex)));
  std::vector<CGAL::Triple<int, int, int>> found;
  processing::triangulate_hole_polyline(
      points, std::back_inserter(found),
      processing::parameters::do_not_use_cubic_algorithm(hole.size() > kCubic));
  Triangles patch;
  const auto vertex_of = [&hole](int i) { return hole[static_cast<std::size_t>(i)]; };
  for (const auto& t : found) {
    patch.emplace_back(vertex_of(t.first), vertex_of(t.second), vertex_of(t.third));
  }
  return patch;
}

// Why a hole is not filled; nullptr if it is. `largest`: m², that it may take.
const char* WhyNot(const Hole& hole, const Eigen::Matrix3Xd& vertices, const Triangles& patch,
                   double largest) {
  if (hole.vertices.size() == 3) {
    const bool is_around_one =
        hole.triangles[0] == hole.triangles[1] && hole.triangles[1] == hole.triangles[2];
    return is_around_one ? "is all around a single triangle" : nullptr;
  }
  if (patch.empty()) return "is too ragged to be filled";
  double area = 0;
  for (const Eigen::Vector3i& triangle : patch) area += AreaOf(vertices, triangle);
  return area > largest ? "is too large to be filled" : nullptr;
}

absl::Status FillHoles(const RepairOptions& options, SurfaceMesh& surface,
                       SurfaceRepairs& repairs) {
  const CutSurface connected(surface.vertices, surface.triangles);
  const std::vector<Piece> pieces = PiecesOf(surface, connected);
  Triangles triangles(surface.triangles.colwise().begin(), surface.triangles.colwise().end());
  std::vector<SurfaceFault> faults;
  for (const Hole& hole : HolesOf(connected)) {
    Eigen::AlignedBox3d box;
    for (const int vertex : hole.vertices) box.extend(surface.vertices.col(vertex).eval());
    const double width = box.diagonal().norm();
    const Triangles patch = PatchOf(surface.vertices, hole.vertices);
    const double largest =
        options.largest_hole * pieces[static_cast<std::size_t>(hole.triangles[0])].area;
    if (const char* reason = WhyNot(hole, surface.vertices, patch, largest)) {
      AddFault(FaultAt(Kind::kOpenEdge, box.center(),
                       absl::StrFormat("a hole of %d edges, %.4g mm across, %s,",
                                       hole.vertices.size(), 1e3 * width, reason)),
               faults);
      continue;
    }
    triangles.insert(triangles.end(), patch.begin(), patch.end());
    ++repairs.filled_holes;
    repairs.widest_hole = std::max(repairs.widest_hole, width);
  }
  surface.triangles = ToMatrix(triangles);
  return Refusal(faults);
}

// Turns each piece of a closed surface outwards, or inwards where it lies within another.
absl::Status TurnOutwards(SurfaceMesh& surface) {
  std::vector<SurfaceFault> faults = CheckSurface(surface, kMaxFaults);
  std::erase_if(faults, [](const SurfaceFault& fault) { return fault.kind == Kind::kInsideOut; });
  MORTISE_RETURN_IF_ERROR(Refusal(faults));
  const std::vector<Piece> pieces =
      PiecesOf(surface, CutSurface(surface.vertices, surface.triangles));
  const auto flat = std::find_if(pieces.begin(), pieces.end(), [](const Piece& piece) {
    return std::abs(piece.volume) <= kNoVolume * std::pow(piece.area, 1.5);
  });
  if (flat != pieces.end()) {
    const int corner = surface.triangles(0, flat - pieces.begin());
    return Refusal(
        {FaultAt(Kind::kInsideOut, surface.vertices.col(corner), "the surface encloses nothing")});
  }
  MORTISE_ASSIGN_OR_RETURN(HalfedgeMesh mesh, ToHalfedgeMesh(surface));
  processing::orient_to_bound_a_volume(mesh);
  surface = ToSurfaceMesh(mesh);
  return Refusal(CheckSurface(surface, kMaxFaults));
}

// Whether one of two triangles with the same corners is the other turned over.
bool IsTurned(const Eigen::Vector3i& a, const Eigen::Vector3i& b) {
  for (int k = 0; k < 3; ++k) {
    if (a[0] == b[k]) return a[1] != b[(k + 1) % 3];
  }
  return false;
}

absl::StatusOr<RepairedSurface> Repair(const SurfaceMesh& surface, double tolerance,
                                       const RepairOptions& options) {
  RepairedSurface repaired;
  repaired.repairs.tolerance = tolerance;
  MORTISE_ASSIGN_OR_RETURN(const SurfaceMesh cleaned,
                           Clean(TriangleSoup(surface, tolerance), repaired.repairs));
  std::vector<SurfaceFault> faults;
  const CutSurface cut(cleaned.vertices, cleaned.triangles);
  for (const SurfaceEdge& edge : cut.edges()) {
    if (edge.triangles() > 2) AddFault(*FaultAt(edge, cleaned.vertices), faults);
  }
  MORTISE_RETURN_IF_ERROR(Refusal(faults));
  repaired.surface = cleaned;
  MORTISE_RETURN_IF_ERROR(TurnAlike(repaired.surface));
  MORTISE_RETURN_IF_ERROR(FillHoles(options, repaired.surface, repaired.repairs));
  MORTISE_RETURN_IF_ERROR(TurnOutwards(repaired.surface));
  for (Eigen::Index t = 0; t < cleaned.triangles.cols(); ++t) {
    if (IsTurned(cleaned.triangles.col(t), repaired.surface.triangles.col(t))) {
      ++repaired.repairs.turned_triangles;
    }
  }
  return repaired;
}

std::string Counted(int count, const std::string& one, const std::string& many) {
  return absl::StrCat(count, " ", count == 1 ? one : many);
}

}  // namespace

std::vector<std::string> Describe(const SurfaceRepairs& repairs) {
  std::vector<std::string> words;
  if (repairs.merged_vertices > 0) {
    words.push_back(absl::StrFormat(
        "merged %s within %.4g mm",
        Counted(repairs.merged_vertices, "vertex with another", "vertices with others"),
        1e3 * repairs.tolerance));
  }
  if (repairs.without_area > 0) {
    words.push_back(absl::StrCat("dropped ", Counted(repairs.without_area, "triangle", "triangles"),
                                 " without area"));
  }
  if (repairs.drawn_twice > 0) {
    words.push_back(absl::StrCat("dropped ", Counted(repairs.drawn_twice, "triangle", "triangles"),
                                 " drawn more than once"));
  }
  if (repairs.split_triangles > 0) {
    words.push_back(absl::StrCat("divided ",
                                 Counted(repairs.split_triangles, "triangle", "triangles"),
                                 " at vertices on their edges"));
  }
  if (repairs.turned_triangles > 0) {
    words.push_back(absl::StrCat(
        "turned ", Counted(repairs.turned_triangles, "triangle", "triangles"), " around"));
  }
  if (repairs.filled_holes > 0) {
    words.push_back(absl::StrFormat("filled %s, up to %.4g mm across",
                                    Counted(repairs.filled_holes, "hole", "holes"),
                                    1e3 * repairs.widest_hole));
  }
  return words;
}

absl::StatusOr<RepairedSurface> RepairSurface(const SurfaceMesh& surface,
                                              const RepairOptions& options) {
  MORTISE_RETURN_IF_ERROR(CheckOptions(options));
  MORTISE_RETURN_IF_ERROR(Refusal(CheckNumbers(surface.vertices, surface.triangles)));
  if (IsWatertight(surface)) return RepairedSurface{surface, {}};
  const double diagonal =
      (surface.vertices.rowwise().maxCoeff() - surface.vertices.rowwise().minCoeff()).norm();
  // Areas, volumes and their squares are computed.
  if (!(diagonal > 1e-30 && diagonal < 1e30)) {
    return InvalidField("surface", "is a point, or larger than anything");
  }
  try {
    return Repair(surface, options.tolerance * diagonal, options);
  } catch (const std::exception& error) {
    return InvalidField("surface", absl::StrCat("cannot be repaired: ", error.what()));
  }
}

}  // namespace mortise::mesh
