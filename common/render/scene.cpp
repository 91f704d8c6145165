// Draws a scene: shapes, their feature edges, lines, then the flat layer of texts and colour bar.
#include "common/render/scene.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/shared_edges.h"
#include "common/render/axis_numbers.h"
#include "common/render/feature_edges.h"
#include "common/render/rasterizer.h"

namespace mortise::render {
namespace {

constexpr Color kInk{0.15, 0.16, 0.2};
constexpr double kTextHeight = 11;  // pixels
constexpr double kBarWidth = 18;    // pixels

absl::Status CheckShape(const Shape& shape, int index) {
  const std::string field = absl::StrCat("shapes[", index, "]");
  if (!shape.vertices.allFinite()) {
    return InvalidField(field + ".vertices", "a coordinate is not finite");
  }
  if (shape.triangles.size() > 0 &&
      (shape.triangles.minCoeff() < 0 || shape.triangles.maxCoeff() >= shape.vertices.cols())) {
    return InvalidField(field + ".triangles", "a triangle names a vertex that does not exist");
  }
  if (shape.scalars.size() != 0 && shape.scalars.size() != shape.vertices.cols()) {
    return InvalidField(field + ".scalars", "there must be one scalar for each vertex");
  }
  return absl::OkStatus();
}

absl::Status CheckScene(const Scene& scene, const RenderOptions& options) {
  if (options.width < 16 || options.width > 8192) {
    return InvalidField("options.width", "must be within 16 to 8192");
  }
  if (options.height < 16 || options.height > 8192) {
    return InvalidField("options.height", "must be within 16 to 8192");
  }
  if (options.supersample < 1 || options.supersample > 4) {
    return InvalidField("options.supersample", "must be within 1 to 4");
  }
  const Camera& camera = scene.camera;
  if (!camera.eye.allFinite() || !camera.target.allFinite() || !camera.up.allFinite() ||
      camera.eye == camera.target || !(camera.view_height > 0) || !(camera.view_angle > 0) ||
      camera.view_angle >= 3.1) {
    return InvalidField("camera", "must look somewhere, with a positive view");
  }
  for (int i = 0; i < static_cast<int>(scene.shapes.size()); ++i) {
    MORTISE_RETURN_IF_ERROR(CheckShape(scene.shapes[i], i));
    if (scene.shapes[i].scalars.size() > 0 && !scene.color_bar) {
      return InvalidField("color_bar", "shapes with scalars need a colour bar");
    }
  }
  for (int i = 0; i < static_cast<int>(scene.lines.size()); ++i) {
    if (!scene.lines[i].points.allFinite()) {
      return InvalidField(absl::StrCat("lines[", i, "].points"), "a coordinate is not finite");
    }
  }
  return absl::OkStatus();
}

// The parts of the picture, in pixels.
struct Layout {
  double left = 0, top = 0, width = 0, height = 0;  // of the view
  double bar_left = 0;
};

Layout LayOut(const Scene& scene, const RenderOptions& options) {
  Layout layout;
  layout.top = scene.title.empty() ? 0 : 2.6 * kTextHeight;
  const double bottom = scene.footnote.empty() ? 0 : 2.4 * kTextHeight;
  double right = 0;
  if (scene.color_bar) {
    const double numbers = TextWidth(kTextHeight, "-0.0000e-00");
    right =
        std::max(kBarWidth + 8 + numbers + 12, TextWidth(kTextHeight, scene.color_bar->title) + 12);
  }
  layout.width = std::max(8.0, options.width - right);
  layout.height = std::max(8.0, options.height - layout.top - bottom);
  layout.bar_left = options.width - right;
  return layout;
}

// Brightness of a surface with this normal: a light over the viewer's left shoulder, both sides
// lit.
double Light(const Projection& projection, const Eigen::Vector3d& centre, Eigen::Vector3d normal) {
  if (normal.dot(projection.TowardsEye(centre)) < 0) normal = -normal;
  const ViewBasis& basis = projection.basis();
  const Eigen::Vector3d source =
      (-0.3 * basis.right + 0.7 * basis.up - 1.0 * basis.forward).normalized();
  return 0.55 + 0.45 * std::max(0.0, normal.dot(source));
}

// Area-weighted normals at the vertices, for smooth shading.
Eigen::Matrix3Xd VertexNormals(const Shape& shape) {
  const std::vector<int> merged = MergeVertices(shape.vertices);
  Eigen::Matrix3Xd normals = Eigen::Matrix3Xd::Zero(3, shape.vertices.cols());
  for (Eigen::Index t = 0; t < shape.triangles.cols(); ++t) {
    const Eigen::Vector3d a = shape.vertices.col(shape.triangles(0, t));
    const Eigen::Vector3d b = shape.vertices.col(shape.triangles(1, t));
    const Eigen::Vector3d c = shape.vertices.col(shape.triangles(2, t));
    const Eigen::Vector3d area = (b - a).cross(c - a);
    for (int k = 0; k < 3; ++k) normals.col(merged[shape.triangles(k, t)]) += area;
  }
  for (Eigen::Index v = 0; v < normals.cols(); ++v) {
    if (merged[v] != v) normals.col(v) = normals.col(merged[v]);
  }
  for (Eigen::Index v = 0; v < normals.cols(); ++v) normals.col(v).stableNormalize();
  return normals;
}

void FillShape(const Shape& shape, const Scene& scene, const Projection& projection,
               Rasterizer& raster) {
  const Eigen::Matrix3Xd flat = mesh::TriangleNormals(shape.vertices, shape.triangles);
  const Eigen::Matrix3Xd round = shape.smooth ? VertexNormals(shape) : Eigen::Matrix3Xd();
  const bool by_scalar = shape.scalars.size() > 0;
  const double low = by_scalar ? scene.color_bar->minimum : 0;
  const double span = by_scalar ? scene.color_bar->maximum - low : 1;
  for (Eigen::Index t = 0; t < shape.triangles.cols(); ++t) {
    std::array<Corner, 3> corners;
    for (int k = 0; k < 3; ++k) {
      const int v = shape.triangles(k, t);
      const Eigen::Vector3d position = shape.vertices.col(v);
      corners[k].point = projection(position);
      corners[k].light = Light(projection, position, shape.smooth ? round.col(v) : flat.col(t));
      if (by_scalar) corners[k].scalar = span > 0 ? (shape.scalars[v] - low) / span : 0.0;
    }
    if (!shape.smooth) corners[1].light = corners[2].light = corners[0].light;
    // Colours carry the meaning of a field: shade it less.
    if (by_scalar) {
      for (Corner& corner : corners) corner.light = 0.35 + 0.65 * corner.light;
    }
    if (shape.backdrop) {
      for (Corner& corner : corners) corner.light = 1;
    }
    raster.FillTriangle(corners, by_scalar ? nullptr : &shape.color);
  }
}

void DrawEdges(const Shape& shape, const Projection& projection, int supersample,
               Rasterizer& raster) {
  const auto faces_eye = [&](const Eigen::Vector3d& centre, const Eigen::Vector3d& normal) {
    return normal.dot(projection.TowardsEye(centre)) > 0;
  };
  Stroke stroke;
  stroke.color = shape.edge_color;
  stroke.width = shape.edge_width * supersample;
  stroke.dash = 5.0 * supersample;
  stroke.dashed_where_hidden = shape.hidden_edges == HiddenEdges::kDashed;
  for (const FeatureEdge& edge :
       FindFeatureEdges(shape.vertices, shape.triangles, shape.feature_angle, faces_eye)) {
    raster.DrawLine(projection(edge.start), projection(edge.end), stroke);
  }
}

void DrawSpaceLine(const Line& line, const Projection& projection, int supersample,
                   Rasterizer& raster) {
  Stroke stroke;
  stroke.color = line.color;
  stroke.width = line.width * supersample;
  stroke.on_top = line.on_top;
  const Eigen::Index count = line.points.cols();
  for (Eigen::Index i = 0; i + 1 < count; ++i) {
    raster.DrawLine(projection(line.points.col(i)), projection(line.points.col(i + 1)), stroke);
  }
  if (!line.arrow || count < 2) return;
  const Projected tip = projection(line.points.col(count - 1));
  const Projected tail = projection(line.points.col(count - 2));
  const double length = std::hypot(tip.x - tail.x, tip.y - tail.y);
  if (!tip.visible || !tail.visible || length == 0) return;
  const double size = std::min(0.6 * length, (6 + 3 * line.width) * supersample);
  const double dx = (tip.x - tail.x) / length, dy = (tip.y - tail.y) / length;
  const double depth_step = (tip.depth - tail.depth) / length;
  // Filled by strokes from the tip to its base.
  const int strokes = std::max(2, static_cast<int>(size));
  for (int i = 0; i <= strokes; ++i) {
    const double across = 0.38 * size * (2.0 * i / strokes - 1);
    Projected base = tip;
    base.x = tip.x - size * dx - across * dy;
    base.y = tip.y - size * dy + across * dx;
    base.depth = tip.depth - size * depth_step;
    Stroke thin = stroke;
    thin.width = 1.5;
    raster.DrawLine(tip, base, thin);
  }
}

void DrawColorBar(const ColorBar& bar, const Layout& layout, const RenderOptions& options,
                  Image& image) {
  const double height = std::min(0.7 * options.height, 420.0);
  const int top = static_cast<int>(0.5 * (options.height - height) + kTextHeight);
  const int left = static_cast<int>(layout.bar_left) + 4;
  const int rows = static_cast<int>(height);
  for (int row = 0; row < rows; ++row) {
    const Color color = FieldColor(1 - (row + 0.5) / rows);
    for (int x = 0; x < static_cast<int>(kBarWidth); ++x) image.Set(left + x, top + row, color);
  }
  const auto line = [&](int y) {
    for (int x = 0; x < static_cast<int>(kBarWidth) + 5; ++x) image.Set(left + x, y, kInk);
  };
  const double span = bar.maximum - bar.minimum;
  const std::vector<double> ticks = NiceTicks(bar.minimum, bar.maximum, 6);
  const std::vector<std::string> texts = ShortNumbers(ticks, 3);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const double share = span > 0 ? (ticks[i] - bar.minimum) / span : 0;
    const int y = top + static_cast<int>(std::lround((1 - share) * (rows - 1)));
    line(y);
    DrawText(image, left + kBarWidth + 9, y - 0.5 * kTextHeight, kTextHeight, kInk, texts[i]);
  }
  DrawText(image, left, top - 2.2 * kTextHeight, kTextHeight, kInk, bar.title);
}

void DrawLabels(const Scene& scene, const Projection& projection, Image& image) {
  for (const Label& label : scene.labels) {
    const Projected point = projection(label.position);
    if (!point.visible) continue;
    const double width = TextWidth(kTextHeight, label.text);
    const double x = std::clamp(point.x + 6, 2.0, std::max(2.0, image.width - width - 4));
    const double y =
        std::clamp(point.y - kTextHeight - 5, 2.0, std::max(2.0, image.height - kTextHeight - 4));
    for (int v = static_cast<int>(y - 3); v <= static_cast<int>(y + kTextHeight + 3); ++v) {
      for (int u = static_cast<int>(x - 3); u <= static_cast<int>(x + width + 3); ++u) {
        if (u >= 0 && v >= 0 && u < image.width && v < image.height) {
          image.Set(u, v, Mix(image.Get(u, v), {1, 1, 1}, 0.85));
        }
      }
    }
    DrawText(image, x, y, kTextHeight, kInk, label.text);
  }
}

}  // namespace

absl::StatusOr<Image> Render(const Scene& scene, const RenderOptions& options) {
  MORTISE_RETURN_IF_ERROR(CheckScene(scene, options));
  const int factor = options.supersample;
  const Layout layout = LayOut(scene, options);
  const auto projection_at = [&](double scale) {
    return Projection(scene.camera, options.width, options.height, scale * layout.left,
                      scale * layout.top, scale * layout.width, scale * layout.height);
  };
  const Projection samples = projection_at(factor);
  Rasterizer raster(options.width * factor, options.height * factor, scene.background);
  for (const bool backdrop : {true, false}) {
    for (const Shape& shape : scene.shapes) {
      if (shape.filled && shape.backdrop == backdrop) FillShape(shape, scene, samples, raster);
    }
    for (const Shape& shape : scene.shapes) {
      if (shape.edges && shape.backdrop == backdrop) DrawEdges(shape, samples, factor, raster);
    }
    if (backdrop) raster.ClearDepth();
  }
  for (const Line& line : scene.lines) DrawSpaceLine(line, samples, factor, raster);
  Image image = raster.Reduce(factor);
  DrawLabels(scene, projection_at(1), image);
  if (scene.color_bar) DrawColorBar(*scene.color_bar, layout, options, image);
  DrawText(image, 12, 0.9 * kTextHeight, 1.2 * kTextHeight, kInk, scene.title);
  DrawText(image, 12, options.height - 1.8 * kTextHeight, kTextHeight, kInk, scene.footnote);
  return image;
}

}  // namespace mortise::render
