#include <cmath>
#include <cstdlib>

#include "common/base/units.h"
#include "common/fem/problems/elasticity.h"
#include "tests/unit/common/fem/problems/published_targets.h"
#include "tests/unit/common/fem/problems/structured_mesh.h"

namespace mortise::simulator {
namespace {

using mesh::MappedBox;
using mesh::Ticks;

// m; see published_targets.h.
constexpr double kCantileverDeflection = 1.9065e-3;

// The direction at the angle v · 90° from x towards y, exact at both ends.
Eigen::Vector2d Quarter(double v) {
  if (v == 0) return {1, 0};
  if (v == 1) return {0, 1};
  return {std::cos(v * M_PI / 2), std::sin(v * M_PI / 2)};
}

Support Roller(const char* face, int axis) {
  Support support{{0, face}, {false, false, false}};
  support.fixed[axis] = true;
  return support;
}

struct Solved {
  mesh::TetrahedralMesh mesh;
  ElasticitySolution solution;
};

Solved Solve(const MappedBox& box, bool quadratic, AnalysisCase analysis) {
  Solved solved{mesh::MeshMappedBox(box, quadratic), {}};
  auto solution = SolveElasticity(solved.mesh, analysis);
  if (!solution.ok()) std::abort();
  solved.solution = *std::move(solution);
  return solved;
}

TargetAnswer Answer(const char* what, double target, double value, const Solved& solved) {
  const ElasticitySummary& summary = solved.solution.summary;
  return {what, target, value, summary.elements, summary.solver.unknowns, summary.seconds};
}

// The value furthest from the target.
class Worst {
 public:
  explicit Worst(double target) : target_(target), value_(target) {}
  void See(double value) {
    if (std::abs(value - target_) >= std::abs(value_ - target_)) value_ = value;
  }
  double value() const { return value_; }

 private:
  double target_, value_;
};

Solved SolveThickCylinder(int n, bool quadratic) {
  MappedBox box;
  // Everything varies with the radius only.
  box.ticks = {Ticks(16 * n, 4), Ticks(6 * n), Ticks(n)};
  box.place = [](const Eigen::Vector3d& p) {
    const Eigen::Vector2d at = (1 + p.x()) * Quarter(p.y());
    return Eigen::Vector3d(at.x(), at.y(), 0.1 * p.z());
  };
  AnalysisCase analysis;
  analysis.materials = {{"steel", 7800, 200e9, 0.3, 0}};
  analysis.supports = {Roller("v_min", 1), Roller("v_max", 0), Roller("w_min", 2),
                       Roller("w_max", 2)};
  analysis.pressures = {{{0, "u_min"}, 1e6}};
  return Solve(box, quadratic, analysis);
}

}  // namespace

TargetAnswer ThickPlate(int n, bool quadratic) {
  MappedBox box;
  box.ticks = {Ticks(2 * n, 4), Ticks(3 * n, 4), Ticks(n)};
  box.place = [](const Eigen::Vector3d& p) {
    const Eigen::Vector2d direction = Quarter(p.y());
    const Eigen::Vector2d inner(2 * direction.x(), direction.y());
    const Eigen::Vector2d outer(3.25 * direction.x(), 2.75 * direction.y());
    const Eigen::Vector2d at = (1 - p.x()) * inner + p.x() * outer;
    return Eigen::Vector3d(at.x(), at.y(), 0.6 * p.z());
  };
  AnalysisCase analysis;
  analysis.materials = {{"steel", 7800, 210e9, 0.3, 0}};
  analysis.supports = {Roller("v_min", 1), Roller("v_max", 0), {{0, "u_max"}, {true, true, false}}};
  Support middle{{}, {false, false, true}};
  middle.nodes = mesh::NodesWhere(box, quadratic, [](const Eigen::Vector3d& p) {
    return p.x() == 1 && std::abs(p.z() - 0.5) < 1e-9;
  });
  analysis.supports.push_back(middle);
  analysis.pressures = {{{0, "w_max"}, 1e6}};
  const Solved solved = Solve(box, quadratic, analysis);
  const int d = mesh::NodesWhere(box, quadratic, [](const Eigen::Vector3d& p) {
    return p.x() == 0 && p.y() == 0 && p.z() == 1;
  })[0];
  return Answer("LE10: syy at D", -5.38 * kMegapascal, solved.solution.stress(1, d), solved);
}

Eigen::Vector3d KirschTraction(double radius, double pull, const Eigen::Vector3d& x,
                               const Eigen::Vector3d& normal) {
  const double r2 = radius * radius / x.head<2>().squaredNorm(), r4 = r2 * r2;
  const double angle = std::atan2(x.y(), x.x());
  const double c2 = std::cos(2 * angle), c4 = std::cos(4 * angle);
  const double s2 = std::sin(2 * angle), s4 = std::sin(4 * angle);
  const double xx = 1 - r2 * (1.5 * c2 + c4) + 1.5 * r4 * c4;
  const double yy = -r2 * (0.5 * c2 - c4) - 1.5 * r4 * c4;
  const double xy = -r2 * (0.5 * s2 + s4) + 1.5 * r4 * s4;
  return pull *
         Eigen::Vector3d(xx * normal.x() + xy * normal.y(), xy * normal.x() + yy * normal.y(), 0);
}

TargetAnswer PlateWithHole(int n, bool quadratic) {
  constexpr double kSide = 4, kPull = 1e6;
  MappedBox box;
  box.ticks = {Ticks(12 * n, 12), Ticks(12 * n), Ticks(n)};
  box.place = [](const Eigen::Vector3d& p) {
    const Eigen::Vector2d inner = Quarter(p.y());
    const Eigen::Vector2d outer(kSide * std::min(1.0, 2 - 2 * p.y()),
                                kSide * std::min(1.0, 2 * p.y()));
    const Eigen::Vector2d at = (1 - p.x()) * inner + p.x() * outer;
    return Eigen::Vector3d(at.x(), at.y(), 0.1 * p.z());
  };
  AnalysisCase analysis;
  analysis.materials = {{"steel", 7800, 200e9, 0.3, 0}};
  analysis.supports = {Roller("v_min", 1), Roller("v_max", 0), Roller("w_min", 2),
                       Roller("w_max", 2)};
  analysis.tractions = {{{0, "u_max"}, [](const Eigen::Vector3d& x, const Eigen::Vector3d& normal) {
                           return KirschTraction(1, kPull, x, normal);
                         }}};
  const Solved solved = Solve(box, quadratic, analysis);
  Worst worst(3 * kPull);
  for (const int v : mesh::NodesWhere(
           box, quadratic, [](const Eigen::Vector3d& p) { return p.x() == 0 && p.y() == 1; })) {
    worst.See(solved.solution.stress(0, v));
  }
  return Answer("hole: sxx at its edge", 3 * kPull, worst.value(), solved);
}

TargetAnswer ThickCylinder(int n, bool quadratic) {
  const Solved solved = SolveThickCylinder(n, quadratic);
  const double hoop = 5e6 / 3;
  Worst worst(hoop);
  for (Eigen::Index v = 0; v < solved.mesh.nodes.cols(); ++v) {
    const Eigen::Vector2d at = solved.mesh.nodes.col(v).head<2>();
    if (at.norm() > 1 + 1e-9) continue;
    const Eigen::Vector2d t = Eigen::Vector2d(-at.y(), at.x()).normalized();
    const auto stress = solved.solution.stress.col(v);
    worst.See(stress[0] * t.x() * t.x() + stress[1] * t.y() * t.y() +
              2 * stress[3] * t.x() * t.y());
  }
  return Answer("cylinder: hoop stress", hoop, worst.value(), solved);
}

TargetAnswer ThickCylinderWidening(int n, bool quadratic) {
  const Solved solved = SolveThickCylinder(n, quadratic);
  const double widening = 1e6 * 1.3 * (0.4 + 4) / (200e9 * 3);
  Worst worst(widening);
  for (Eigen::Index v = 0; v < solved.mesh.nodes.cols(); ++v) {
    const Eigen::Vector2d at = solved.mesh.nodes.col(v).head<2>();
    if (at.norm() > 1 + 1e-9) continue;
    worst.See(at.normalized().dot(solved.solution.displacement.col(v).head<2>()));
  }
  return Answer("cylinder: widening", widening, worst.value(), solved);
}

TargetAnswer Cantilever3d(int n, bool quadratic) {
  MappedBox box;
  box.ticks = {Ticks(8 * n, 4), Ticks(n), Ticks(n)};
  box.place = [](const Eigen::Vector3d& p) {
    return Eigen::Vector3d(p.x(), 0.1 * p.y(), 0.1 * p.z());
  };
  AnalysisCase analysis;
  analysis.materials = {{"steel", 7800, 210e9, 0.3, 0}};
  analysis.supports = {{{0, "u_min"}}};
  analysis.forces = {{{0, "u_max"}, {0, 0, -1e4}}};
  const Solved solved = Solve(box, quadratic, analysis);
  // An even load's work is the mean deflection of the face times the force.
  return Answer("cantilever: deflection", kCantileverDeflection,
                solved.solution.summary.compliance / 1e4, solved);
}

TargetAnswer TaperedSphere(int n, bool quadratic) {
  // The section at the ends of the four segments of v: (r, z) inside and outside.
  const auto inside = [](double v) -> Eigen::Vector2d {
    if (v <= 0.5) return {std::cos(v * M_PI / 2), std::sin(v * M_PI / 2)};
    return {std::sqrt(0.5), std::sqrt(0.5) + (1.79 - std::sqrt(0.5)) * (2 * v - 1)};
  };
  const auto outside = [](double v) -> Eigen::Vector2d {
    const Eigen::Vector2d d(1.4 * std::cos(M_PI / 6), 0.7), g(1, 1.39);
    if (v <= 0.25) return 1.4 * Eigen::Vector2d(std::cos(v * M_PI / 1.5), std::sin(v * M_PI / 1.5));
    if (v <= 0.75) return d + (g - d) * (2 * v - 0.5);
    return {1, 1.39 + 0.4 * (4 * v - 3)};
  };
  MappedBox box;
  // Along the section: its four segments, the first finest at A.
  std::vector<double> along{0};
  const auto divide = [&along](double end, const std::vector<double>& ticks) {
    const double begin = along.back();
    for (std::size_t k = 1; k < ticks.size(); ++k) {
      along.push_back(begin + (end - begin) * ticks[k]);
    }
  };
  divide(0.25, Ticks(4 * n, 6));
  for (const double end : {0.5, 0.75, 1.0}) divide(end, Ticks(n));
  box.ticks = {Ticks(3 * n, 6), along, Ticks(5 * n)};
  box.place = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector2d section = (1 - p.x()) * inside(p.y()) + p.x() * outside(p.y());
    const Eigen::Vector2d at = section.x() * Quarter(p.z());
    const double z = p.y() == 0 ? 0 : p.y() == 1 ? 1.79 : section.y();
    return Eigen::Vector3d(at.x(), at.y(), z);
  };
  Solved solved{mesh::MeshMappedBox(box, quadratic), {}};
  AnalysisCase analysis;
  analysis.materials = {{"steel", 7800, 210e9, 0.3, 0, 2.3e-4}};
  analysis.supports = {Roller("w_min", 1), Roller("w_max", 0), Roller("v_min", 2),
                       Roller("v_max", 2)};
  analysis.temperature =
      (solved.mesh.nodes.topRows<2>().colwise().norm() + solved.mesh.nodes.row(2)).transpose();
  auto solution = SolveElasticity(solved.mesh, analysis);
  if (!solution.ok()) std::abort();
  solved.solution = *std::move(solution);
  const int node = mesh::NodesWhere(
      box, quadratic, [](const Eigen::Vector3d& p) { return p == Eigen::Vector3d::Zero(); })[0];
  return Answer("LE11: szz at A", -105 * kMegapascal, solved.solution.stress(2, node), solved);
}

}  // namespace mortise::simulator
