#include "services/fabplanner/documents/part_drawing.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "common/mesh/halfedge_mesh.h"
#include "services/fabplanner/documents/part_mesh.h"
#include "services/fabplanner/documents/svg_drawing.h"
#include "services/fabplanner/plan/dimension_text.h"

namespace mortise::fabplanner {
namespace {

constexpr double kSharp = 0.866;       // cosine of the angle from which an edge is drawn
constexpr double kDrawingWidth = 900;  // px
constexpr double kMargin = 70;         // px, around each view

// "Left side 1" becomes "left-side-1".
std::string FileStem(const std::string& name) {
  std::string stem;
  for (char c : name) {
    const bool kept = absl::ascii_isalnum(static_cast<unsigned char>(c));
    if (kept) stem += absl::ascii_tolower(static_cast<unsigned char>(c));
    if (!kept && !stem.empty() && stem.back() != '-') stem += '-';
  }
  while (!stem.empty() && stem.back() == '-') stem.pop_back();
  return stem.empty() ? "part" : stem;
}

bool AreAlike(const Part& a, const Part& b) {
  if (a.family.empty() || a.family != b.family || a.triangles.cols() != b.triangles.cols() ||
      a.vertices.cols() != b.vertices.cols() || a.outline.size() != b.outline.size()) {
    return false;
  }
  const Eigen::Vector3d from_a = BoundsOf(a).min(), from_b = BoundsOf(b).min();
  if (!BoundsOf(a).sizes().isApprox(BoundsOf(b).sizes(), 1e-6)) return false;
  if (!IsShaped(a)) return true;
  return a.triangles == b.triangles &&
         ((a.vertices.colwise() - from_a) - (b.vertices.colwise() - from_b)).cwiseAbs().maxCoeff() <
             1e-6;
}

// Where the view's axes lie in the design: to the right, up, and towards the viewer.
struct View {
  const char* title;
  Eigen::Vector3d right, up, towards;
};

struct Segment {
  Eigen::Vector3d from, to;
  bool front = false;  // at the border of a face that is seen
};

// The edges to draw of a view.
std::vector<Segment> EdgesOf(const render::Shape& shape, const View& view) {
  const mesh::CutSurface surface(shape.vertices, shape.triangles);
  const auto normal_of = [&shape](int triangle) -> Eigen::Vector3d {
    const Eigen::Matrix3d corners = shape.vertices(Eigen::all, shape.triangles.col(triangle));
    return (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).normalized();
  };
  std::vector<Segment> edges;
  for (const mesh::SurfaceEdge& edge : surface.edges()) {
    std::vector<Eigen::Vector3d> normals;
    int seen = 0;
    for (int i = 0; i < edge.triangles(); ++i) {
      normals.push_back(normal_of(surface.TriangleAt(edge, i)));
      seen += normals.back().dot(view.towards) > 1e-6 ? 1 : 0;
    }
    const bool outline = normals.size() == 2 && seen == 1;
    const bool sharp = normals.size() != 2 || normals[0].dot(normals[1]) < kSharp;
    if (!outline && !sharp) continue;
    edges.push_back({shape.vertices.col(edge.low), shape.vertices.col(edge.high), seen > 0});
  }
  return edges;
}

// Draws a view with the lower left corner of its box at (x, y) px.
void DrawView(const render::Shape& shape, const Eigen::AlignedBox3d& box, const View& view,
              double x, double y, double scale, SvgDrawing* svg) {
  const auto lowest = [&](const Eigen::Vector3d& axis) {
    return std::min(axis.dot(box.min()), axis.dot(box.max()));
  };
  const auto extent = [&](const Eigen::Vector3d& axis) { return std::abs(axis.dot(box.sizes())); };
  const double left = lowest(view.right), bottom = lowest(view.up);
  const auto place = [&](const Eigen::Vector3d& point) {
    return Eigen::Vector2d(x + scale * (view.right.dot(point) - left),
                           y - scale * (view.up.dot(point) - bottom));
  };
  std::vector<Segment> edges = EdgesOf(shape, view);
  std::stable_partition(edges.begin(), edges.end(),
                        [](const Segment& edge) { return !edge.front; });
  for (const Segment& edge : edges) {
    const Eigen::Vector2d from = place(edge.from), to = place(edge.to);
    if ((from - to).norm() < 0.05) continue;
    svg->Line(from.x(), from.y(), to.x(), to.y(), edge.front ? "visible" : "behind");
  }
  const double width = scale * extent(view.right), height = scale * extent(view.up);
  svg->Dimension(x, x + width, y - height - 12, Millimetres(extent(view.right)));
  svg->DimensionUpright(y, y - height, x - 14, Millimetres(extent(view.up)));
  svg->Text(x, y + 22, 13, TextAnchor::kStart, view.title);
}

}  // namespace

void NameDrawings(const Design& design, FabricationPlan* plan) {
  std::set<std::string> used;
  for (std::size_t i = 0; i < design.parts.size(); ++i) {
    if (!plan->parts[i].to_shape) continue;
    for (std::size_t j = 0; j < i && plan->parts[i].drawings.empty(); ++j) {
      if (plan->parts[j].to_shape && AreAlike(design.parts[i], design.parts[j])) {
        plan->parts[i].drawings = plan->parts[j].drawings;
      }
    }
    if (!plan->parts[i].drawings.empty()) continue;
    const std::string stem = FileStem(design.parts[i].name);
    std::string name = stem;
    for (int number = 2; !used.insert(name).second; ++number) {
      name = absl::StrCat(stem, "-", number);
    }
    plan->parts[i].drawings = {absl::StrCat("part-", name, ".svg"),
                               absl::StrCat("part-", name, ".stl")};
  }
}

bool HasDrawings(const FabricationPlan& plan) {
  return std::any_of(plan.parts.begin(), plan.parts.end(),
                     [](const PlannedPart& part) { return !part.drawings.empty(); });
}

void AddToDrawings(const std::string& file_name, FabricationPlan* plan) {
  for (PlannedPart& part : plan->parts) {
    if (!part.drawings.empty()) part.drawings.push_back(file_name);
  }
  for (BillLine& line : plan->bill.lines) {
    if (!line.drawings.empty()) line.drawings.push_back(file_name);
  }
}

std::string PartDrawingSvg(const Part& part, const std::string& note) {
  const render::Shape shape = PartShape(part, Eigen::Vector3d::Zero());
  const Eigen::AlignedBox3d box = BoundsOf(part);
  const Eigen::Vector3d size = box.sizes();
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  // Two columns, two rows: front and side, and the view from above under the front.
  const double scale =
      std::min((kDrawingWidth - 4 * kMargin) / (size.x() + size.y()), 900 / (size.y() + size.z()));
  SvgDrawing svg;
  const double left = kMargin, middle = 3 * kMargin + scale * size.x();
  const double upper = 90 + scale * size.z(), lower = upper + kMargin + scale * size.y();
  svg.Text(left, 26, 18, TextAnchor::kStart, TitleOf(part));
  svg.Text(left, 46, 13, TextAnchor::kStart, note, "quiet");
  DrawView(shape, box, {"from the front", x, z, -y}, left, upper, scale, &svg);
  DrawView(shape, box, {"from the left", -y, z, -x}, middle, upper, scale, &svg);
  DrawView(shape, box, {"from above", x, y, z}, left, lower, scale, &svg);
  return svg.Finish(kDrawingWidth, lower + 40, TitleOf(part));
}

}  // namespace mortise::fabplanner
