#include "common/cad/solid_box.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <BRep_Tool.hxx>
#include <Eigen/LU>
#include <TColStd_Array1OfReal.hxx>
#include <TopExp.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <gp_Elips.hxx>
#include <gp_Sphere.hxx>
#include <gp_Torus.hxx>
#include <limits>
#include <memory>
#include <numbers>
#include <vector>

#include "common/cad/occt_vectors.h"

namespace mortise::cad {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kParallel = 1e-12;    // sine of an angle
constexpr double kInFace = 1e-9;       // of parameters
constexpr double kMeasurable = 1e-11;  // m, that a face may reach farther than its edges
constexpr int kLooks = 24;             // along each smooth piece of an edge
constexpr int kSurfaceLooks = 8;       // along either parameter of each smooth piece of a surface
constexpr int kMaxSurfaceLooks = 400;
constexpr int kRefinements = 60;  // of a place on a curve
constexpr int kNewtonSteps = 20;
constexpr int kMaxSteps = 400;
constexpr double kStill = 1e-9;  // step, of the range that is climbed

// The places up to `reach` from one of `count` in a row. What is between them is at most as much
// higher than the highest as that is than the lowest of those within two.
struct Span {
  Eigen::Index first, count;
};
Span SpanAround(Eigen::Index place, Eigen::Index reach, Eigen::Index count) {
  const Eigen::Index first = std::max<Eigen::Index>(place - reach, 0);
  return {first, std::min(place + reach, count - 1) - first + 1};
}

// How far along each of the three directions, and against them.
struct Reach {
  Eigen::Vector3d least = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d most = -least;
};

class Measurement {
 public:
  explicit Measurement(const Eigen::Matrix3d& rotation) : rotation_(rotation) {}

  void AddVertex(const TopoDS_Vertex& vertex) { Add(BRep_Tool::Pnt(vertex)); }

  void AddEdge(const TopoDS_Edge& edge) {
    if (BRep_Tool::Degenerated(edge) || !BRep_Tool::IsGeometric(edge)) return;
    const BRepAdaptor_Curve curve(edge);
    switch (curve.GetType()) {
      case GeomAbs_Line:
        return;
      case GeomAbs_Circle: {
        const double radius = curve.Circle().Radius();
        return AddConic(curve, radius * ToEigen(curve.Circle().XAxis().Direction().XYZ()),
                        radius * ToEigen(curve.Circle().YAxis().Direction().XYZ()));
      }
      case GeomAbs_Ellipse: {
        const gp_Elips ellipse = curve.Ellipse();
        return AddConic(curve, ellipse.MajorRadius() * ToEigen(ellipse.XAxis().Direction().XYZ()),
                        ellipse.MinorRadius() * ToEigen(ellipse.YAxis().Direction().XYZ()));
      }
      default:
        return AddCurve(curve);
    }
  }

  // Once all edges are added.
  void AddFace(const TopoDS_Face& face) {
    const BRepAdaptor_Surface surface(face, Standard_False);
    switch (surface.GetType()) {
      // Straight in one direction: they reach no farther than their edges.
      case GeomAbs_Plane:
      case GeomAbs_Cylinder:
      case GeomAbs_Cone:
      case GeomAbs_SurfaceOfExtrusion:
        return;
      case GeomAbs_Sphere:
        return AddBall(face, surface.Sphere());
      case GeomAbs_Torus:
        return AddTorus(face, surface.Torus());
      default:
        return AddSurface(face);
    }
  }

  SolidBox Box() const { return {reach_.least, reach_.most}; }

 private:
  Eigen::Vector3d Turned(const gp_Pnt& p) const { return rotation_ * ToEigen(p.XYZ()); }

  void Add(const gp_Pnt& p) {
    const Eigen::Vector3d turned = Turned(p);
    reach_.least = reach_.least.cwiseMin(turned);
    reach_.most = reach_.most.cwiseMax(turned);
  }

  // x cos t + y sin t from its middle runs across a direction at two opposite angles.
  void AddConic(const BRepAdaptor_Curve& curve, const Eigen::Vector3d& x,
                const Eigen::Vector3d& y) {
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d along = rotation_.row(axis).transpose();
      const double angle = std::atan2(along.dot(y), along.dot(x));
      for (const double t : {angle, angle + kPi}) {
        const double first = curve.FirstParameter();
        const double turns = std::ceil((first - t) / (2 * kPi));
        const double at = t + 2 * kPi * turns;
        if (at <= curve.LastParameter()) Add(curve.Value(at));
      }
    }
  }

  void AddCurve(const BRepAdaptor_Curve& curve) {
    TColStd_Array1OfReal ends(1, curve.NbIntervals(GeomAbs_C1) + 1);
    curve.Intervals(ends, GeomAbs_C1);
    for (int i = 1; i < ends.Upper(); ++i) AddPiece(curve, ends(i), ends(i + 1));
  }

  void AddPiece(const BRepAdaptor_Curve& curve, double from, double to) {
    const auto place = [&](int look) { return from + (to - from) * look / kLooks; };
    Eigen::Matrix<double, 3, kLooks + 1> seen;
    for (int look = 0; look <= kLooks; ++look) {
      const gp_Pnt p = curve.Value(place(look));
      seen.col(look) = Turned(p);
      Add(p);
    }
    for (int axis = 0; axis < 3; ++axis) {
      for (const double way : {1.0, -1.0}) {
        const Eigen::RowVectorXd heights = way * seen.row(axis);
        for (int look = 0; look <= kLooks; ++look) {
          const Span near = SpanAround(look, 1, kLooks + 1), far = SpanAround(look, 2, kLooks + 1);
          if (heights[look] < heights.segment(near.first, near.count).maxCoeff()) continue;
          const double lower = heights.segment(far.first, far.count).minCoeff();
          if (!CanReach(axis, way, 2 * heights[look] - lower)) continue;
          Add(curve.Value(HighestOf([&](double t) { return way * Turned(curve.Value(t))[axis]; },
                                    place(static_cast<int>(near.first)),
                                    place(static_cast<int>(near.first + near.count - 1)))));
        }
      }
    }
  }

  // By the golden section: a maximum to half the digits of its place has all of its height.
  static double HighestOf(const std::function<double(double)>& height, double from, double to) {
    const double golden = (std::sqrt(5.0) - 1) / 2;
    double low = to - golden * (to - from), high = from + golden * (to - from);
    double at_low = height(low), at_high = height(high);
    for (int i = 0; i < kRefinements && std::abs(to - from) > 1e-10 * (1 + std::abs(from)); ++i) {
      if (at_low > at_high) {
        to = high;
        high = low;
        at_high = at_low;
        low = to - golden * (to - from);
        at_low = height(low);
      } else {
        from = low;
        low = high;
        at_low = at_high;
        high = from + golden * (to - from);
        at_high = height(high);
      }
    }
    return (from + to) / 2;
  }

  // Whether what comes up to `height` along an axis, or against it, would make the box larger.
  bool CanReach(int axis, double way, double height) const {
    return height > (way > 0 ? reach_.most[axis] : -reach_.least[axis]) + kMeasurable;
  }

  // Whether a point would.
  bool IsFarther(const gp_Pnt& p) const {
    const Eigen::Vector3d turned = Turned(p);
    return (turned - reach_.most).maxCoeff() > kMeasurable ||
           (reach_.least - turned).maxCoeff() > kMeasurable;
  }

  void AddIfIn(const TopoDS_Face& face, double u, double v, const gp_Pnt& p) {
    if (!IsFarther(p)) return;
    if (classified_.IsNull() || !classified_.IsSame(face)) {
      classifier_ = std::make_unique<BRepTopAdaptor_FClass2d>(face, kInFace);
      classified_ = face;
    }
    if (classifier_->Perform(gp_Pnt2d(u, v)) != TopAbs_OUT) Add(p);
  }

  void AddBall(const TopoDS_Face& face, const gp_Sphere& ball) {
    const gp_Ax3& position = ball.Position();
    for (int axis = 0; axis < 3; ++axis) {
      for (const double way : {1.0, -1.0}) {
        const Eigen::Vector3d n = way * rotation_.row(axis).transpose();
        const gp_XYZ along(n.x(), n.y(), n.z());
        const double x = along.Dot(position.XDirection().XYZ());
        const double y = along.Dot(position.YDirection().XYZ());
        const double z = along.Dot(position.Direction().XYZ());
        AddIfIn(face, std::atan2(y, x), std::atan2(z, std::hypot(x, y)),
                gp_Pnt(ball.Location().XYZ() + along * ball.Radius()));
      }
    }
  }

  // Looks along a direction at one or the other side of the ring, outside or inside.
  void AddTorus(const TopoDS_Face& face, const gp_Torus& torus) {
    const gp_Ax3& position = torus.Position();
    const gp_XYZ x_axis = position.XDirection().XYZ(), y_axis = position.YDirection().XYZ();
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d n = rotation_.row(axis).transpose();
      const gp_XYZ along(n.x(), n.y(), n.z());
      const double x = along.Dot(x_axis), y = along.Dot(y_axis);
      const double z = along.Dot(position.Direction().XYZ()), across = std::hypot(x, y);
      // Along the axis the whole circle is the highest: all of it is in the face, nothing of it is,
      // or an edge crosses it.
      const double side = across <= kParallel ? 0 : std::atan2(y, x);
      for (const double u : {side, side + kPi}) {
        const double out = u == side ? across : -across;
        for (const double v : {std::atan2(z, out), std::atan2(-z, -out)}) {
          const gp_XYZ ring = x_axis * std::cos(u) + y_axis * std::sin(u);
          const gp_XYZ p = torus.Location().XYZ() +
                           ring * (torus.MajorRadius() + torus.MinorRadius() * std::cos(v)) +
                           position.Direction().XYZ() * (torus.MinorRadius() * std::sin(v));
          AddIfIn(face, u, v, gp_Pnt(p));
        }
      }
    }
  }

  // Places along either parameter to look at.
  static std::vector<double> LooksBetween(const std::vector<double>& breaks, double from,
                                          double to) {
    std::vector<double> ends{from};
    for (const double at : breaks) {
      if (at > from && at < to) ends.push_back(at);
    }
    ends.push_back(to);
    const auto pieces = static_cast<int>(ends.size()) - 1;
    const int looks = std::clamp(kMaxSurfaceLooks / pieces, 2, kSurfaceLooks);
    std::vector<double> places{from};
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      for (int k = 1; k <= looks; ++k) {
        places.push_back(ends[i] + (ends[i + 1] - ends[i]) * k / looks);
      }
    }
    return places;
  }

  static std::vector<double> BreaksOf(const BRepAdaptor_Surface& surface, bool along_u) {
    TColStd_Array1OfReal ends(
        1, (along_u ? surface.NbUIntervals(GeomAbs_C2) : surface.NbVIntervals(GeomAbs_C2)) + 1);
    along_u ? surface.UIntervals(ends, GeomAbs_C2) : surface.VIntervals(ends, GeomAbs_C2);
    return {ends.begin(), ends.end()};
  }

  void AddSurface(const TopoDS_Face& face) {
    const BRepAdaptor_Surface surface(face);
    const std::vector<double> us =
        LooksBetween(BreaksOf(surface, true), surface.FirstUParameter(), surface.LastUParameter());
    const std::vector<double> vs =
        LooksBetween(BreaksOf(surface, false), surface.FirstVParameter(), surface.LastVParameter());
    std::array<Eigen::MatrixXd, 3> seen;
    for (Eigen::MatrixXd& heights : seen) {
      heights.resize(static_cast<Eigen::Index>(us.size()), static_cast<Eigen::Index>(vs.size()));
    }
    for (Eigen::Index i = 0; i < seen[0].rows(); ++i) {
      for (Eigen::Index j = 0; j < seen[0].cols(); ++j) {
        const Eigen::Vector3d turned = Turned(surface.Value(us[At(i)], vs[At(j)]));
        for (int axis = 0; axis < 3; ++axis) seen[At(axis)](i, j) = turned[axis];
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      for (const double way : {1.0, -1.0}) {
        ClimbAll(face, surface, us, vs, axis, way, way * seen[At(axis)]);
      }
    }
  }

  // Climbs from each of the places looked at that is higher than those beside it.
  void ClimbAll(const TopoDS_Face& face, const BRepAdaptor_Surface& surface,
                const std::vector<double>& us, const std::vector<double>& vs, int axis, double way,
                const Eigen::MatrixXd& heights) {
    const Eigen::Vector3d along = way * rotation_.row(axis).transpose();
    const auto around = [&](const Span& rows, const Span& columns) {
      return heights.block(rows.first, columns.first, rows.count, columns.count);
    };
    for (Eigen::Index i = 0; i < heights.rows(); ++i) {
      const Span rows = SpanAround(i, 1, heights.rows());
      for (Eigen::Index j = 0; j < heights.cols(); ++j) {
        const Span columns = SpanAround(j, 1, heights.cols());
        if (heights(i, j) < around(rows, columns).maxCoeff()) continue;
        const double lower =
            around(SpanAround(i, 2, heights.rows()), SpanAround(j, 2, heights.cols())).minCoeff();
        if (!CanReach(axis, way, 2 * heights(i, j) - lower)) continue;
        Climb(face, surface, along, {us[At(i)], vs[At(j)]},
              {us[At(rows.first)], vs[At(columns.first)]},
              {us[At(rows.first + rows.count - 1)], vs[At(columns.first + columns.count - 1)]});
      }
    }
  }

  static std::size_t At(Eigen::Index index) { return static_cast<std::size_t>(index); }

  // By Newton's method to where the surface runs across the direction, between `least` and `most`,
  // and on from there by shorter and shorter steps up: at poles, and where the surface is flat or
  // has a crease, the former leads nowhere.
  void Climb(const TopoDS_Face& face, const BRepAdaptor_Surface& surface,
             const Eigen::Vector3d& along, const Eigen::Vector2d& start,
             const Eigen::Vector2d& least, const Eigen::Vector2d& most) {
    const auto height = [&](const Eigen::Vector2d& at) {
      return along.dot(ToEigen(surface.Value(at.x(), at.y()).XYZ()));
    };
    Eigen::Vector2d at = start;
    for (int i = 0; i < kNewtonSteps; ++i) {
      gp_Pnt p;
      gp_Vec du, dv, duu, dvv, duv;
      surface.D2(at.x(), at.y(), p, du, dv, duu, dvv, duv);
      const auto up = [&](const gp_Vec& change) { return along.dot(ToEigen(change.XYZ())); };
      Eigen::Matrix2d second;
      second << up(duu), up(duv), up(duv), up(dvv);
      const Eigen::Vector2d step = -second.fullPivLu().solve(Eigen::Vector2d(up(du), up(dv)));
      if (!step.allFinite()) break;
      const Eigen::Vector2d moved = (at + step).cwiseMax(least).cwiseMin(most);
      const double change = (moved - at).norm();
      at = moved;
      if (change <= kStill * (most - least).norm()) break;
    }
    if (!(height(at) >= height(start))) at = start;
    at = Stepwise(height, at, least, most);
    AddIfIn(face, at.x(), at.y(), surface.Value(at.x(), at.y()));
  }

  static Eigen::Vector2d Stepwise(const std::function<double(const Eigen::Vector2d&)>& height,
                                  Eigen::Vector2d at, const Eigen::Vector2d& least,
                                  const Eigen::Vector2d& most) {
    Eigen::Vector2d step = (most - least) / 4;
    double highest = height(at);
    for (int i = 0; i < kMaxSteps && step.norm() > kStill * (most - least).norm(); ++i) {
      bool has_moved = false;
      for (const Eigen::Vector2d& way : {Eigen::Vector2d(1, 0), Eigen::Vector2d(-1, 0),
                                         Eigen::Vector2d(0, 1), Eigen::Vector2d(0, -1)}) {
        const Eigen::Vector2d moved = (at + way.cwiseProduct(step)).cwiseMax(least).cwiseMin(most);
        const double there = height(moved);
        if (!(there > highest)) continue;
        at = moved;
        highest = there;
        has_moved = true;
      }
      if (!has_moved) step /= 2;
    }
    return at;
  }

  const Eigen::Matrix3d rotation_;
  Reach reach_;
  TopoDS_Face classified_;
  std::unique_ptr<BRepTopAdaptor_FClass2d> classifier_;
};

std::vector<TopoDS_Shape> Of(const TopoDS_Shape& solid, TopAbs_ShapeEnum kind) {
  TopTools_IndexedMapOfShape found;
  TopExp::MapShapes(solid, kind, found);
  std::vector<TopoDS_Shape> shapes;
  for (int i = 1; i <= found.Extent(); ++i) shapes.push_back(found(i));
  return shapes;
}

}  // namespace

SolidBox BoxOf(const TopoDS_Shape& solid, const Eigen::Matrix3d& rotation) {
  Measurement measurement(rotation);
  for (const TopoDS_Shape& vertex : Of(solid, TopAbs_VERTEX)) {
    measurement.AddVertex(TopoDS::Vertex(vertex));
  }
  for (const TopoDS_Shape& edge : Of(solid, TopAbs_EDGE)) {
    measurement.AddEdge(TopoDS::Edge(edge));
  }
  for (const TopoDS_Shape& face : Of(solid, TopAbs_FACE)) {
    measurement.AddFace(TopoDS::Face(face));
  }
  return measurement.Box();
}

}  // namespace mortise::cad
