#include "common/mesh/tetrahedra/mesher.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/mesh/element_faces.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/surface_check.h"
#include "common/mesh/tetrahedra/surface_remesh.h"
#include "common/mesh/tetrahedra/tetgen_process.h"

namespace mortise::mesh {
namespace {

constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

// Six times the volume over the longest edge cubed; the regular tetrahedron has 0.7. TetGen makes
// one flatter element in some hundred thousand, between points in one plane: nothing can be solved
// on it.
constexpr double kFlat = 2e-14;
// Degrees between triangles that TetGen may take for one plane, whose edges it may move. Its own,
// 179.9, changes the volume of finely drawn tubes by some millionths.
constexpr char kOnePlane[] = "179.99";

// A try at a mesh. Where TetGen makes flat elements, another size mostly does not; where it fails
// over needles on curved faces, rounder triangles help.
struct MeshAttempt {
  double size = 1;      // of that asked for
  bool redraw = false;  // whether curved faces get round triangles
  double turn = 0.5;    // rad, of these
};
constexpr std::array<MeshAttempt, 5> kAttempts{
    {{1}, {0.93}, {0.87}, {1, true, 0.5}, {1, true, 0.4}}};

// Volume of the regular tetrahedron of this edge.
double RegularVolume(double edge) { return edge * edge * edge / (6 * std::numbers::sqrt2); }

double TotalVolume(const AssemblySurface& assembly) {
  double volume = 0;
  for (int p = 0; p < static_cast<int>(assembly.part_names.size()); ++p) {
    volume += ComputeMassProperties(PartSurface(assembly, p)).volume;
  }
  return volume;
}

absl::Status CheckOptions(const MeshOptions& options) {
  if (!std::isfinite(options.element_size) || options.element_size < 0) {
    return InvalidField("element_size", "must be a positive length, or 0 for the default");
  }
  if (!(options.radius_edge_ratio >= 1.1 && options.radius_edge_ratio <= 100)) {
    return InvalidField("radius_edge_ratio", "must be within 1.1 to 100");
  }
  if (!(options.minimum_dihedral >= 0 && options.minimum_dihedral <= 0.35)) {
    return InvalidField("minimum_dihedral", "must be within 0 to 0.35 rad");
  }
  if (options.element_limit < 1) return InvalidField("element_limit", "must be positive");
  return absl::OkStatus();
}

// Copies the surface into TetGen's input: one facet a triangle, marked with its face (TetGen merges
// coplanar neighbours of equal mark), one region a part.
void FillInput(const AssemblySurface& assembly, double maximum_volume, tetgenio& input) {
  input.firstnumber = 0;
  input.numberofpoints = static_cast<int>(assembly.vertices.cols());
  input.pointlist = new REAL[3 * input.numberofpoints];
  std::copy_n(assembly.vertices.data(), assembly.vertices.size(), input.pointlist);
  input.numberoffacets = static_cast<int>(assembly.triangles.cols());
  input.facetlist = new tetgenio::facet[input.numberoffacets];
  input.facetmarkerlist = new int[input.numberoffacets];
  for (int t = 0; t < input.numberoffacets; ++t) {
    tetgenio::facet& facet = input.facetlist[t];
    tetgenio::init(&facet);
    facet.numberofpolygons = 1;
    facet.polygonlist = new tetgenio::polygon[1];
    tetgenio::init(&facet.polygonlist[0]);
    facet.polygonlist[0].numberofvertices = 3;
    facet.polygonlist[0].vertexlist = new int[3];
    std::copy_n(assembly.triangles.col(t).data(), 3, facet.polygonlist[0].vertexlist);
    input.facetmarkerlist[t] = assembly.triangle_face[t] + 1;
  }
  const int parts = static_cast<int>(assembly.part_names.size());
  input.numberofregions = parts;
  input.regionlist = new REAL[5 * parts];
  for (int p = 0; p < parts; ++p) {
    std::copy_n(assembly.part_interior.col(p).data(), 3, input.regionlist + 5 * p);
    input.regionlist[5 * p + 3] = p + 1;
    input.regionlist[5 * p + 4] = maximum_volume;
  }
}

// INVALID_ARGUMENT naming the parts and the place where surfaces cross. Searched before meshing,
// since TetGen ends the process on some of them.
absl::Status CheckCrossings(const AssemblySurface& assembly) {
  const auto crossings = FindIntersections(assembly.vertices, assembly.triangles, 1);
  if (crossings.empty()) return absl::OkStatus();
  const auto owner = [&](int triangle) {
    const AssemblyFace& face = assembly.faces[assembly.triangle_face[triangle]];
    const int part = face.back_part >= 0 ? face.back_part : face.front_part;
    return part >= 0 ? assembly.part_names[part] : std::string("?");
  };
  const Intersection& crossing = crossings[0];
  const Eigen::Vector3d place = 1e3 * crossing.place;
  return InvalidField(
      "triangles",
      absl::StrFormat("the surfaces of parts '%s' and '%s' cross at (%.4g, %.4g, %.4g) mm",
                      owner(crossing.first), owner(crossing.second), place.x(), place.y(),
                      place.z()));
}

// q: quality; S: at most so many extra points, which ends runaway refinement.
std::string QualitySwitches(const MeshOptions& options) {
  return absl::StrFormat("q%.4f/%.4fS%d", options.radius_edge_ratio,
                         options.minimum_dihedral * kDegreesPerRadian,
                         std::max(1000, options.element_limit / 3));
}

// Keeps the elements that lie in a part (TetGen also fills enclosed voids) and the nodes they use.
TetrahedralMesh TakeElements(const tetgenio& output, int parts) {
  TetrahedralMesh mesh;
  std::vector<int> kept;
  for (int e = 0; e < output.numberoftetrahedra; ++e) {
    const long region = std::lround(output.tetrahedronattributelist[e]);
    if (region >= 1 && region <= parts) kept.push_back(e);
  }
  std::vector<int> node(output.numberofpoints, -1);
  std::vector<int> used;
  mesh.tetrahedra.resize(4, kept.size());
  mesh.part.resize(kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const int* corners = output.tetrahedronlist + output.numberofcorners * kept[i];
    for (int k = 0; k < 4; ++k) {
      int& mapped = node[corners[k]];
      if (mapped < 0) {
        mapped = static_cast<int>(used.size());
        used.push_back(corners[k]);
      }
      mesh.tetrahedra(k, i) = mapped;
    }
    mesh.part[i] = static_cast<int>(std::lround(output.tetrahedronattributelist[kept[i]])) - 1;
  }
  mesh.nodes.resize(3, used.size());
  for (std::size_t v = 0; v < used.size(); ++v) {
    mesh.nodes.col(v) = Eigen::Map<const Eigen::Vector3d>(output.pointlist + 3 * used[v]);
  }
  // TetGen orders corners left-handed by this library's convention.
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const Eigen::Vector3d a = mesh.nodes.col(mesh.tetrahedra(0, e));
    const Eigen::Vector3d b = mesh.nodes.col(mesh.tetrahedra(1, e)) - a;
    const Eigen::Vector3d c = mesh.nodes.col(mesh.tetrahedra(2, e)) - a;
    const Eigen::Vector3d d = mesh.nodes.col(mesh.tetrahedra(3, e)) - a;
    if (b.dot(c.cross(d)) < 0) std::swap(mesh.tetrahedra(2, e), mesh.tetrahedra(3, e));
  }
  for (int f = 0; f < output.numberoftrifaces; ++f) {
    for (int k = 0; k < 3; ++k) {
      int& corner = output.trifacelist[3 * f + k];
      corner = node[corner];
    }
  }
  return mesh;
}

// Takes over the marked triangles, oriented as the header promises.
void TakeFaces(const tetgenio& output, std::vector<AssemblyFace> faces, TetrahedralMesh& mesh) {
  mesh.faces = std::move(faces);
  for (AssemblyFace& face : mesh.faces) {
    if (face.back_part < 0) std::swap(face.front_part, face.back_part);
  }
  const ElementFaces sides(mesh);
  std::vector<Eigen::Vector3i> triangles;
  std::vector<int> owners;
  for (int f = 0; f < output.numberoftrifaces; ++f) {
    const int face = output.trifacemarkerlist[f] - 1;
    if (face < 0 || face >= static_cast<int>(mesh.faces.size())) continue;
    const int back = mesh.faces[face].back_part;
    const auto triangle =
        sides.FaceSeenFrom(Eigen::Map<Eigen::Vector3i>(output.trifacelist + 3 * f), back);
    if (!triangle) continue;
    triangles.push_back(*triangle);
    owners.push_back(face);
  }
  mesh.face_triangles.resize(3, triangles.size());
  mesh.face_triangle_face.resize(owners.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    mesh.face_triangles.col(i) = triangles[i];
    mesh.face_triangle_face[i] = owners[i];
  }
}

// What TetGen made, checked. Errors as MeshAssembly's.
absl::StatusOr<TetrahedralMesh> TakeMesh(const tetgenio& output, std::vector<AssemblyFace> faces,
                                         const std::vector<std::string>& part_names,
                                         const MeshOptions& options) {
  const int parts = static_cast<int>(part_names.size());
  TetrahedralMesh mesh = TakeElements(output, parts);
  if (mesh.tetrahedra.cols() > options.element_limit) {
    return TooLarge(absl::StrCat("a mesh of ", mesh.tetrahedra.cols(), " elements"),
                    absl::StrCat(options.element_limit, " elements"));
  }
  TakeFaces(output, std::move(faces), mesh);
  mesh.part_names = part_names;
  for (int p = 0; p < parts; ++p) {
    if ((mesh.part.array() == p).any()) continue;
    return absl::InternalError(
        absl::StrCat("meshing failed: part '", part_names[p], "' got no elements"));
  }
  return options.quadratic ? MakeQuadratic(std::move(mesh)) : mesh;
}

// Processor time that TetGen gets: it makes 30,000 elements a second, or comes to no end.
int SecondsFor(double elements) { return 30 + static_cast<int>(1e-3 * elements); }

// Six times the volume over the longest edge cubed, of the flattest element.
double LeastThickness(const TetrahedralMesh& mesh) {
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    std::array<Eigen::Vector3d, 4> corners;
    for (int k = 0; k < 4; ++k) corners[k] = mesh.nodes.col(mesh.tetrahedra(k, e));
    double longest = 0;
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < i; ++j) {
        longest = std::max(longest, (corners[i] - corners[j]).squaredNorm());
      }
    }
    const double volume =
        (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(corners[3] - corners[0]);
    least = std::min(least, longest > 0 ? volume / std::pow(longest, 1.5) : 0);
  }
  return least;
}

absl::Status FlatElements() {
  return absl::InternalError("meshing failed: it made elements without volume");
}

// One try at the mesh of a surface, whose elements have volumes.
absl::StatusOr<TetrahedralMesh> MeshOnce(const AssemblySurface& assembly, double size,
                                         const MeshOptions& options) {
  tetgenio input, output;
  FillInput(assembly, RegularVolume(size), input);
  // p: a surface; z: from 0; Q: quiet; A: region attributes; a: region volumes; Y: triangles of the
  // surface stay whole.
  const double expected =
      std::max<double>(EstimateElements(assembly, size), 10.0 * assembly.triangles.cols());
  const std::string switches = absl::StrCat(
      "p", kOnePlane, "zQAa", options.keep_triangles ? "Y" : "", QualitySwitches(options));
  MORTISE_RETURN_IF_ERROR(RunTetGen(switches, SecondsFor(expected), input, output));
  MORTISE_ASSIGN_OR_RETURN(TetrahedralMesh mesh,
                           TakeMesh(output, assembly.faces, assembly.part_names, options));
  if (LeastThickness(mesh) < kFlat) return FlatElements();
  return mesh;
}

absl::Status CheckSizes(const TetrahedralMesh& mesh, const Eigen::VectorXd& sizes) {
  if (sizes.size() != mesh.tetrahedra.cols()) {
    return InvalidField("sizes", "there must be one for each element");
  }
  if (!(sizes.array() > 0).all()) return InvalidField("sizes", "must be positive");
  return absl::OkStatus();
}

// Copies the corners of a mesh into TetGen's input, with its parts as regions and its faces as
// marked triangles, and the volume that each element may have.
void FillInput(const TetrahedralMesh& mesh, const Eigen::VectorXd& sizes, tetgenio& input) {
  std::vector<int> corner(static_cast<std::size_t>(mesh.nodes.cols()), -1);
  std::vector<int> used;
  const auto corner_of = [&](int node) {
    int& mapped = corner[static_cast<std::size_t>(node)];
    if (mapped < 0) {
      mapped = static_cast<int>(used.size());
      used.push_back(node);
    }
    return mapped;
  };
  input.firstnumber = 0;
  input.mesh_dim = 3;
  input.numberofcorners = 4;
  input.numberoftetrahedra = static_cast<int>(mesh.tetrahedra.cols());
  input.numberoftetrahedronattributes = 1;
  input.tetrahedronlist = new int[4 * input.numberoftetrahedra];
  input.tetrahedronattributelist = new REAL[input.numberoftetrahedra];
  input.tetrahedronvolumelist = new REAL[input.numberoftetrahedra];
  for (int e = 0; e < input.numberoftetrahedra; ++e) {
    int* const corners = input.tetrahedronlist + 4 * e;
    for (int k = 0; k < 4; ++k) corners[k] = corner_of(mesh.tetrahedra(k, e));
    std::swap(corners[2], corners[3]);  // left-handed, as TetGen writes them
    input.tetrahedronattributelist[e] = mesh.part[e] + 1;
    input.tetrahedronvolumelist[e] = RegularVolume(sizes[e]);
  }
  input.numberoftrifaces = static_cast<int>(mesh.face_triangles.cols());
  input.trifacelist = new int[3 * input.numberoftrifaces];
  input.trifacemarkerlist = new int[input.numberoftrifaces];
  for (int f = 0; f < input.numberoftrifaces; ++f) {
    for (int k = 0; k < 3; ++k) {
      input.trifacelist[3 * f + k] = corner_of(mesh.face_triangles(k, f));
    }
    input.trifacemarkerlist[f] = mesh.face_triangle_face[f] + 1;
  }
  input.numberofpoints = static_cast<int>(used.size());
  input.pointlist = new REAL[3 * used.size()];
  for (std::size_t v = 0; v < used.size(); ++v) {
    Eigen::Map<Eigen::Vector3d>(input.pointlist + 3 * v) = mesh.nodes.col(used[v]);
  }
}

}  // namespace

double EstimateRefinement(const TetrahedralMesh& mesh, const Eigen::VectorXd& sizes) {
  double elements = 0;
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    const Eigen::Vector3d a = mesh.nodes.col(mesh.tetrahedra(0, e));
    const Eigen::Vector3d b = mesh.nodes.col(mesh.tetrahedra(1, e)) - a;
    const Eigen::Vector3d c = mesh.nodes.col(mesh.tetrahedra(2, e)) - a;
    const Eigen::Vector3d d = mesh.nodes.col(mesh.tetrahedra(3, e)) - a;
    elements += std::max(1.0, b.cross(c).dot(d) / 6 / RegularVolume(sizes[e]));
  }
  return elements;
}

double DefaultElementSize(const AssemblySurface& assembly) {
  Eigen::AlignedBox3d box;
  for (Eigen::Index v = 0; v < assembly.vertices.cols(); ++v) box.extend(assembly.vertices.col(v));
  const double by_extent = box.diagonal().norm() / 12;
  const double by_volume = std::cbrt(TotalVolume(assembly) * 6 * std::numbers::sqrt2 / 20000);
  return std::max(by_extent, by_volume);
}

double EstimateElements(const AssemblySurface& assembly, double element_size) {
  return TotalVolume(assembly) / RegularVolume(element_size);
}

absl::StatusOr<TetrahedralMesh> MeshAssembly(const AssemblySurface& assembly,
                                             const MeshOptions& options) {
  MORTISE_RETURN_IF_ERROR(CheckOptions(options));
  MORTISE_RETURN_IF_ERROR(CheckAssembly(assembly));
  const double size =
      options.element_size > 0 ? options.element_size : DefaultElementSize(assembly);
  const double expected =
      std::max<double>(EstimateElements(assembly, size), 0.5 * assembly.triangles.cols());
  const std::string limit = absl::StrCat(options.element_limit, " elements");
  if (!(expected <= options.element_limit)) {
    return TooLarge(
        absl::StrFormat("a mesh of about %.2g elements of %.4g mm", expected, 1e3 * size), limit);
  }
  MORTISE_RETURN_IF_ERROR(CheckCrossings(assembly));
  absl::StatusOr<TetrahedralMesh> mesh = absl::InternalError("no attempt was made");
  bool is_flat = true;  // whether all that failed were flat elements
  for (const MeshAttempt& attempt : kAttempts) {
    if (attempt.size < 1 && !is_flat) continue;
    absl::StatusOr<TetrahedralMesh> made = absl::InternalError("");
    if (attempt.redraw) {
      const auto redrawn = WithRoundTriangles(assembly, size, attempt.turn);
      if (!redrawn.ok() || !CheckAssembly(*redrawn).ok() || !CheckCrossings(*redrawn).ok()) {
        continue;
      }
      made = MeshOnce(*redrawn, size, options);
    } else {
      made = MeshOnce(assembly, attempt.size * size, options);
    }
    mesh = std::move(made);
    if (!absl::IsInternal(mesh.status())) return mesh;
    is_flat = is_flat && mesh.status() == FlatElements();
  }
  return mesh;
}

absl::StatusOr<TetrahedralMesh> RefineMesh(const TetrahedralMesh& mesh,
                                           const Eigen::VectorXd& sizes,
                                           const MeshOptions& options) {
  MORTISE_RETURN_IF_ERROR(CheckOptions(options));
  MORTISE_RETURN_IF_ERROR(CheckSizes(mesh, sizes));
  const double expected = EstimateRefinement(mesh, sizes);
  if (!(expected <= options.element_limit)) {
    return TooLarge(absl::StrFormat("a refined mesh of about %.2g elements", expected),
                    absl::StrCat(options.element_limit, " elements"));
  }
  absl::StatusOr<TetrahedralMesh> refined = absl::InternalError("no attempt was made");
  for (const MeshAttempt& attempt : kAttempts) {
    if (attempt.redraw) break;
    tetgenio input, output;
    FillInput(mesh, attempt.size * sizes, input);
    // r: a mesh; z: from 0; Q: quiet; a: a volume for each element.
    MORTISE_RETURN_IF_ERROR(RunTetGen(absl::StrCat("rzQa", QualitySwitches(options)),
                                      SecondsFor(10 * expected), input, output));
    MORTISE_ASSIGN_OR_RETURN(refined, TakeMesh(output, mesh.faces, mesh.part_names, options));
    if (LeastThickness(*refined) >= kFlat) return refined;
    refined = FlatElements();
  }
  return refined;
}

}  // namespace mortise::mesh
