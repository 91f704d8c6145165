#include "tests/unit/common/fem/problems/curved_bodies.h"

#include <BRepAdaptor_Surface.hxx>
#include <BRepAlgoAPI_Common.hxx>
#include <BRepAlgoAPI_Cut.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include "common/base/errors.h"
#include "common/cad/surface/assembly_surface.h"
#include "common/fem/elements/shape_functions.h"
#include "common/fem/problems/elasticity.h"
#include "common/fem/stress/stress_recovery.h"
#include "common/mesh/element_faces.h"
#include "common/mesh/tetrahedra/mesher.h"
#include "tests/unit/common/fem/problems/published_targets.h"

namespace mortise::simulator {
namespace {

using Eigen::Vector3d;

constexpr double kInner = 0.01, kOuter = 0.02, kPressure = 1e6;

TopoDS_Shape Rod(double radius, double height) {
  return BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(0, 0, 1)), radius, height).Solid();
}

TopoDS_Shape Block(const Vector3d& size) {
  return BRepPrimAPI_MakeBox(size.x(), size.y(), size.z()).Solid();
}

Vector3d AlongHoop(const Vector3d& x) { return Vector3d(-x.y(), x.x(), 0).normalized(); }

CurvedBody BodyOf(std::string name, const TopoDS_Shape& shape, double inner_radius,
                  double element_size) {
  CurvedBody body;
  body.name = std::move(name);
  body.element_size = element_size;
  auto surface =
      cad::FuseAssembly({NamedSolid(shape, inner_radius)}, {.element_size = element_size});
  if (surface.ok()) body.model.surface = *std::move(surface);
  body.model.analysis.materials = {{"steel", 7800, 200e9, 0.3, 250e6}};
  body.direction = AlongHoop;
  body.normal = [](const Vector3d& x) -> Vector3d {
    return -Vector3d(x.x(), x.y(), 0).normalized();
  };
  body.traction = [](const Vector3d&) -> Vector3d { return Vector3d::Zero(); };
  return body;
}

void HoldPlanes(CurvedBody& body, std::initializer_list<const char*> planes) {
  for (const char* plane : planes) {
    Support support{{0, plane}};
    support.symmetric = true;
    body.model.analysis.supports.push_back(support);
  }
}

std::vector<int> RimOf(const mesh::TetrahedralMesh& mesh) {
  std::set<int> rim;
  for (const int t : TrianglesOn(mesh, {0, "inside"}, true)) {
    for (const int node : mesh.face_triangles.col(t)) rim.insert(node);
  }
  return {rim.begin(), rim.end()};
}

}  // namespace

cad::Solid NamedSolid(const TopoDS_Shape& shape, double inner_radius) {
  auto kernel = std::make_shared<cad::Solid::Kernel>();
  kernel->name = "body";
  kernel->shape = TopExp_Explorer(shape, TopAbs_SOLID).Current();
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(kernel->shape, TopAbs_FACE, faces);
  for (int i = 1; i <= faces.Extent(); ++i) {
    const TopoDS_Face face = TopoDS::Face(faces(i));
    const BRepAdaptor_Surface surface(face);
    std::string name;
    if (surface.GetType() != GeomAbs_Plane) {
      const double radius = surface.GetType() == GeomAbs_Cylinder ? surface.Cylinder().Radius()
                                                                  : surface.Sphere().Radius();
      name = radius < 1.01 * inner_radius ? "inside" : "outside";
    } else {
      gp_Dir normal = surface.Plane().Axis().Direction();
      if (!surface.Plane().Direct()) normal.Reverse();
      if (face.Orientation() == TopAbs_REVERSED) normal.Reverse();
      for (int axis = 0; axis < 3; ++axis) {
        const double along = normal.XYZ().Coord(axis + 1);
        if (std::abs(along) > 0.9) {
          name = std::string(1, "xyz"[axis]) + (along > 0 ? "_max" : "_min");
        }
      }
    }
    kernel->faces.push_back(face);
    kernel->face_names.push_back(name);
  }
  return cad::Solid(std::move(kernel));
}

CurvedBody PressedRing(double element_size) {
  constexpr double kHeight = 0.004;
  const TopoDS_Shape ring = BRepAlgoAPI_Cut(Rod(kOuter, kHeight), Rod(kInner, kHeight)).Shape();
  CurvedBody body =
      BodyOf("thick cylinder", BRepAlgoAPI_Common(ring, Block({kOuter, kOuter, kHeight})).Shape(),
             kInner, element_size);
  HoldPlanes(body, {"x_min", "y_min", "z_min", "z_max"});
  body.model.analysis.pressures.push_back({{0, "inside"}, kPressure});
  const double a2 = kInner * kInner, b2 = kOuter * kOuter;
  body.largest = kPressure * (a2 + b2) / (b2 - a2);
  body.stress = [hoop = body.largest](const Vector3d&) { return hoop; };
  body.traction = [](const Vector3d& x) -> Vector3d {
    return kPressure * Vector3d(x.x(), x.y(), 0).normalized();
  };
  return body;
}

CurvedBody PressedBall(double element_size) {
  const TopoDS_Shape shell = BRepAlgoAPI_Cut(BRepPrimAPI_MakeSphere(kOuter).Solid(),
                                             BRepPrimAPI_MakeSphere(kInner).Solid())
                                 .Shape();
  CurvedBody body =
      BodyOf("hollow ball", BRepAlgoAPI_Common(shell, Block({kOuter, kOuter, kOuter})).Shape(),
             kInner, element_size);
  HoldPlanes(body, {"x_min", "y_min", "z_min"});
  body.model.analysis.pressures.push_back({{0, "inside"}, kPressure});
  const double a3 = std::pow(kInner, 3), b3 = std::pow(kOuter, 3);
  body.largest = kPressure * (a3 + b3 / 2) / (b3 - a3);
  body.stress = [tangential = body.largest](const Vector3d&) { return tangential; };
  // At the pole every direction is one of a circle.
  body.direction = [](const Vector3d& x) -> Vector3d {
    return x.head<2>().norm() > 1e-6 * kInner ? AlongHoop(x) : Vector3d::UnitX();
  };
  body.normal = [](const Vector3d& x) -> Vector3d { return -x.normalized(); };
  body.traction = [](const Vector3d& x) -> Vector3d { return kPressure * x.normalized(); };
  return body;
}

CurvedBody PlateWithAHole(double element_size) {
  constexpr double kSide = 0.04, kThickness = 0.004, kPull = 1e6;
  CurvedBody body =
      BodyOf("plate with a hole",
             BRepAlgoAPI_Cut(Block({kSide, kSide, kThickness}), Rod(kInner, kThickness)).Shape(),
             kInner, element_size);
  HoldPlanes(body, {"x_min", "y_min", "z_min", "z_max"});
  for (const char* side : {"x_max", "y_max"}) {
    body.model.analysis.tractions.push_back({{0, side}, [](const Vector3d& x, const Vector3d& n) {
                                               return KirschTraction(kInner, kPull, x, n);
                                             }});
  }
  body.largest = 3 * kPull;
  body.stress = [](const Vector3d& x) {
    return kPull * (1 - 2 * std::cos(2 * std::atan2(x.y(), x.x())));
  };
  return body;
}

CurvedBody BoredPlate(double element_size) {
  constexpr double kRadius = 0.009, kHalf = 0.04, kThickness = 0.012;
  const gp_Pnt corner(-kHalf, -kHalf, 0);
  CurvedBody body =
      BodyOf("bored plate",
             BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(corner, 2 * kHalf, 2 * kHalf, kThickness).Solid(),
                             Rod(kRadius, kThickness))
                 .Shape(),
             kRadius, element_size);
  body.model.analysis.materials = {{"steel", 7850, 210e9, 0.3, 250e6}};
  body.model.analysis.supports.push_back({{0, "x_min"}});
  body.model.analysis.tractions.push_back(
      {{0, "x_max"},
       [](const Vector3d&, const Vector3d&) -> Vector3d { return 100e6 * Vector3d::UnitX(); }});
  body.largest = 343.8e6;
  body.edges = {0, kThickness};
  body.stress = [](const Vector3d& x) {
    // MPa: of cos kθ, k = 0 … 5, times the even powers 0 … 6 of the distance from the middle plane
    // over half the thickness; within 1 MPa, 0.2 in the root of the mean of squares.
    constexpr double kTerms[6][4] = {
        {106.361, -0.023, 0.056, -0.042}, {0.141, -0.008, 0.030, -0.022},
        {-234.995, 18.940, 7.645, 7.849}, {-8.941, 0.472, 0.339, 0.829},
        {2.089, -0.047, 0.022, -0.380},   {-0.470, -0.014, -0.006, 0.094}};
    const double angle = std::atan2(x.y(), x.x());
    const double high = std::pow(2 * x.z() / kThickness - 1, 2);
    double sum = 0;
    for (int k = 0; k < 6; ++k) {
      double power = 1;
      for (const double term : kTerms[k]) {
        sum += 1e6 * term * power * std::cos(k * angle);
        power *= high;
      }
    }
    return sum;
  };
  return body;
}

Stresses MeanOfElements(const mesh::TetrahedralMesh& mesh, const Stresses& at_points) {
  const int places = static_cast<int>(mesh.tetrahedra.rows());
  Stresses sum = Stresses::Zero(6, mesh.nodes.cols());
  Eigen::VectorXd count = Eigen::VectorXd::Zero(mesh.nodes.cols());
  Eigen::Matrix4d points;  // barycentric coordinates of the four points
  for (int p = 0; p < 4; ++p) points.col(p) = TetrahedronRule(2)[p].barycentric;
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    Stresses own(6, places);
    if (places == 4) {
      own = at_points.col(e).replicate(1, 4);
    } else {
      own.leftCols(4) = at_points.middleCols(4 * e, 4) * points.inverse();
      for (int k = 0; k < 6; ++k) {
        const auto [a, b] = mesh::kTetrahedronEdges[k];
        own.col(4 + k) = (own.col(a) + own.col(b)) / 2;
      }
    }
    for (int k = 0; k < places; ++k) {
      sum.col(mesh.tetrahedra(k, e)) += own.col(k);
      count[mesh.tetrahedra(k, e)] += 1;
    }
  }
  for (Eigen::Index v = 0; v < sum.cols(); ++v) sum.col(v) /= std::max(count[v], 1.0);
  return sum;
}

RimErrors RimErrorsOf(const CurvedBody& body, const mesh::TetrahedralMesh& mesh,
                      const ElasticitySolution& solution, const std::vector<int>& rim) {
  ThreadTeam alone(1);
  const Stresses mean = MeanOfElements(
      mesh, StressAtPoints(mesh, body.model.analysis.materials, solution.displacement, {}, alone));
  RimErrors errors;
  errors.elements = static_cast<int>(mesh.tetrahedra.cols());
  errors.nodes = static_cast<int>(rim.size());
  int on_edges = 0;
  for (const int v : rim) {
    const Vector3d at = mesh.nodes.col(v);
    const bool on_edge =
        std::abs(at.z() - body.edges[0]) < 1e-9 || std::abs(at.z() - body.edges[1]) < 1e-9;
    on_edges += on_edge;
    const Vector3d along = body.direction(at), normal = body.normal(at);
    const auto add = [&](const Vector6d& stress, RimError& sum) {
      const Eigen::Matrix3d tensor = StressTensor(stress);
      const double here = along.dot(tensor * along), off = here - body.stress(at);
      sum.stress += off * off;
      sum.bias += off;
      if (on_edge) sum.at_edges += off * off;
      sum.traction += (tensor * normal - body.traction(at)).squaredNorm();
      sum.largest = std::max(sum.largest, here);
    };
    add(solution.stress.col(v), errors.recovered);
    add(mean.col(v), errors.mean);
  }
  for (RimError* error : {&errors.recovered, &errors.mean}) {
    const double nodes = std::max(errors.nodes, 1);
    error->stress = std::sqrt(error->stress / nodes);
    error->bias /= nodes;
    error->at_edges = std::sqrt(error->at_edges / std::max(on_edges, 1));
    error->traction = std::sqrt(error->traction / nodes);
  }
  return errors;
}

absl::StatusOr<RimErrors> MeasureRim(const CurvedBody& body, bool quadratic) {
  DesignAnalysisOptions options;
  options.mesh.element_size = body.element_size;
  options.mesh.quadratic = quadratic;
  MORTISE_ASSIGN_OR_RETURN(const DesignAnalysis analysis,
                           AnalyzeDesign(body.model, {"max_von_mises"}, false, options));
  return RimErrorsOf(body, *analysis.mesh, analysis.cases[0].solution, RimOf(*analysis.mesh));
}

absl::StatusOr<RimErrors> MeasureFacetedRim(const CurvedBody& body) {
  MORTISE_ASSIGN_OR_RETURN(
      const mesh::TetrahedralMesh mesh,
      mesh::MeshAssembly(body.model.surface, {.element_size = body.element_size}));
  MORTISE_ASSIGN_OR_RETURN(const ElasticitySolution solution,
                           SolveElasticity(mesh, body.model.analysis));
  return RimErrorsOf(body, mesh, solution, RimOf(mesh));
}

}  // namespace mortise::simulator
