// Finds the lines and arcs of profiles.
#include "common/templates/features/sketch_curves.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "absl/strings/str_cat.h"

namespace mortise::cad {
namespace {

using Eigen::Vector2d;

constexpr double kShortest = 1e-6;  // m

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// Where the circle through three points has its centre; nothing if they lie on a line.
std::optional<Vector2d> CenterThrough(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const double doubled = 2 * Cross(b - a, c - a);
  if (std::abs(doubled) < 1e-6 * (b - a).norm() * (c - a).norm()) return std::nullopt;
  const double u = (b - a).squaredNorm(), v = (c - a).squaredNorm();
  return a +
         Vector2d((c - a).y() * u - (b - a).y() * v, (b - a).x() * v - (c - a).x() * u) / doubled;
}

// A corner cut off by an arc that is tangent to both lines.
struct Rounding {
  Vector2d begin, middle, end;
};

// The rounding of the corner between a line from `before` and one to `after`; nothing if they are
// parallel.
std::optional<Rounding> RoundCorner(const Vector2d& before, const Vector2d& corner,
                                    const Vector2d& after, double radius) {
  const Vector2d back = (before - corner).normalized(), ahead = (after - corner).normalized();
  const double half = std::atan2(std::abs(Cross(back, ahead)), back.dot(ahead)) / 2;
  if (half < 1e-4 || half > std::numbers::pi / 2 - 1e-4) return std::nullopt;
  const double along = radius / std::tan(half);
  const Vector2d bisector = (back + ahead).normalized();
  return Rounding{corner + along * back, corner + (radius / std::sin(half) - radius) * bisector,
                  corner + along * ahead};
}

class ProfileResolver {
 public:
  ProfileResolver(const SketchProfile& profile, const Numbers& numbers, std::string place,
                  std::vector<FieldViolation>& findings)
      : profile_(profile), numbers_(numbers), place_(std::move(place)), findings_(findings) {}

  CurveLoop Resolve() {
    loop_.profile = profile_.name;
    loop_.hole_of = profile_.hole_of;
    std::visit(*this, profile_.shape);
    if (!loop_.open) loop_.counterclockwise = Area() > 0;
    return std::move(loop_);
  }

  void operator()(const SketchPath& path) {
    std::vector<Corner> corners;
    Vector2d from = numbers_(path.start);
    for (std::size_t i = 0; i < path.segments.size(); ++i) {
      const SketchSegment& segment = path.segments[i];
      Corner corner{segment.name,
                    from,
                    numbers_(segment.to),
                    std::nullopt,
                    numbers_(segment.round),
                    absl::StrCat("path.segments[", i, "]")};
      if (segment.through) corner.through = numbers_(*segment.through);
      from = corner.to;
      corners.push_back(std::move(corner));
    }
    loop_.open = path.open;
    if (!path.open && (from - numbers_(path.start)).norm() > kShortest) {
      Fail("path", "is not closed: it does not end where it starts");
    }
    Trace(corners);
  }

  void operator()(const SketchCircle& circle) {
    SketchCurve curve;
    curve.role = profile_.name;
    curve.kind = CurveKind::kCircle;
    curve.center = numbers_(circle.center);
    curve.radius = numbers_(circle.radius);
    loop_.curves.push_back(curve);
  }

  void operator()(const SketchRectangle& rectangle) {
    const Vector2d half(numbers_(rectangle.width) / 2, numbers_(rectangle.height) / 2);
    const Vector2d center = numbers_(rectangle.center);
    const double round = numbers_(rectangle.round);
    const std::array<const char*, 4> names = {"bottom", "right", "top", "left"};
    std::vector<Corner> corners;
    Vector2d from = center - half;
    for (std::size_t i = 0; i < 4; ++i) {
      const Vector2d to =
          center + Vector2d(i < 2 ? half.x() : -half.x(), i == 1 || i == 2 ? half.y() : -half.y());
      corners.push_back({names[i], from, to, std::nullopt, round, "rectangle"});
      from = to;
    }
    Trace(corners);
  }

  void operator()(const SketchPolygon& polygon) {
    const int sides = static_cast<int>(numbers_(polygon.sides));
    const double step = 2 * std::numbers::pi / sides;
    const double outer = numbers_(polygon.radius) / std::cos(step / 2);
    const Vector2d center = numbers_(polygon.center);
    const auto corner = [&](int i) -> Vector2d {
      const double angle = numbers_(polygon.angle) + (i - 0.5) * step;
      return center + outer * Vector2d(std::cos(angle), std::sin(angle));
    };
    std::vector<Corner> corners;
    for (int i = 0; i < sides; ++i) {
      corners.push_back(
          {absl::StrCat(i), corner(i), corner((i + 1) % sides), std::nullopt, 0, "polygon"});
    }
    Trace(corners);
  }

 private:
  // A segment and how the corner at its end is rounded.
  struct Corner {
    std::string name;
    Vector2d from, to;
    std::optional<Vector2d> through;
    double round = 0;
    std::string field;
  };

  void Fail(const std::string& field, const std::string& message) {
    findings_.push_back({place_ + "." + field, message});
  }

  void Trace(const std::vector<Corner>& corners) {
    const std::size_t count = corners.size();
    std::vector<std::optional<Rounding>> rounds(count);
    for (std::size_t i = 0; i < count; ++i) {
      if (corners[i].round == 0) continue;
      const bool has_next = i + 1 < count || !loop_.open;
      const Corner& next = corners[(i + 1) % count];
      if (!has_next || corners[i].through || next.through) {
        Fail(corners[i].field + ".round", "is not at a corner between two lines");
        continue;
      }
      rounds[i] = RoundCorner(corners[i].from, corners[i].to, next.to, corners[i].round);
      if (!rounds[i]) Fail(corners[i].field + ".round", "is between lines that are parallel");
    }
    for (std::size_t i = 0; i < count; ++i) {
      const Corner& corner = corners[i];
      const std::size_t before = (i + count - 1) % count;
      const Vector2d from = rounds[before] ? rounds[before]->end : corner.from;
      const Vector2d to = rounds[i] ? rounds[i]->begin : corner.to;
      AddSegment(corner, from, to);
      if (!rounds[i]) continue;
      SketchCurve arc{absl::StrCat(profile_.name, ".", corner.name, "_round"),
                      CurveKind::kArc,
                      rounds[i]->begin,
                      rounds[i]->end,
                      rounds[i]->middle,
                      Vector2d::Zero(),
                      0};
      loop_.curves.push_back(std::move(arc));
    }
  }

  void AddSegment(const Corner& corner, const Vector2d& from, const Vector2d& to) {
    SketchCurve curve{absl::StrCat(profile_.name, ".", corner.name),
                      corner.through ? CurveKind::kArc : CurveKind::kLine,
                      from,
                      to,
                      corner.through.value_or(Vector2d::Zero()),
                      Vector2d::Zero(),
                      0};
    const Vector2d whole = corner.to - corner.from;
    if (curve.kind == CurveKind::kLine) {
      if (whole.norm() < kShortest) {
        Fail(corner.field, absl::StrCat("'", corner.name, "' has no length"));
      } else if ((to - from).dot(whole) < -kShortest * whole.norm()) {
        Fail(corner.field,
             absl::StrCat("the roundings at the ends of '", corner.name, "' do not fit"));
      } else if ((to - from).norm() >= kShortest) {
        loop_.curves.push_back(std::move(curve));
      }
      return;  // a line used up by its roundings is left out
    }
    if (!CenterThrough(from, curve.through, to)) {
      Fail(corner.field + ".through",
           absl::StrCat("the arc '", corner.name, "' has its three points on a line"));
      return;
    }
    loop_.curves.push_back(std::move(curve));
  }

  // Of the polygon of points along the loop.
  double Area() const {
    double doubled = 0;
    for (const SketchCurve& curve : loop_.curves) {
      const Eigen::Matrix2Xd points = PointsAlong(curve, 17);
      for (Eigen::Index i = 0; i + 1 < points.cols(); ++i) {
        doubled += Cross(points.col(i), points.col(i + 1));
      }
    }
    return doubled / 2;
  }

  const SketchProfile& profile_;
  const Numbers& numbers_;
  const std::string place_;
  std::vector<FieldViolation>& findings_;
  CurveLoop loop_;
};

}  // namespace

std::vector<CurveLoop> ResolveSketch(const Sketch& sketch, const Numbers& numbers,
                                     std::vector<FieldViolation>& findings) {
  std::vector<CurveLoop> loops;
  for (std::size_t i = 0; i < sketch.profiles.size(); ++i) {
    loops.push_back(
        ProfileResolver(sketch.profiles[i], numbers, absl::StrCat("profiles[", i, "]"), findings)
            .Resolve());
  }
  return loops;
}

Eigen::Matrix2Xd PointsAlong(const SketchCurve& curve, int count) {
  Vector2d center = curve.center;
  double radius = curve.radius, begin = 0, turn = 2 * std::numbers::pi;
  if (curve.kind == CurveKind::kArc) {
    center = CenterThrough(curve.from, curve.through, curve.to).value_or(curve.from);
    radius = (curve.from - center).norm();
    const auto angle_of = [&](const Vector2d& point) {
      return std::atan2((point - center).y(), (point - center).x());
    };
    const auto ahead = [](double angle) {  // in [0, a full turn)
      return angle < 0 ? angle + 2 * std::numbers::pi : angle;
    };
    begin = angle_of(curve.from);
    turn = ahead(angle_of(curve.to) - begin);
    // Clockwise if the point between lies beyond the end.
    if (ahead(angle_of(curve.through) - begin) > turn) turn -= 2 * std::numbers::pi;
  }
  Eigen::Matrix2Xd points(2, count);
  for (int i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / (count - 1);
    if (curve.kind == CurveKind::kLine) {
      points.col(i) = (1 - t) * curve.from + t * curve.to;
    } else {
      const double angle = begin + t * turn;
      points.col(i) = center + radius * Vector2d(std::cos(angle), std::sin(angle));
    }
  }
  return points;
}

}  // namespace mortise::cad
