// What is in a picture, and the software renderer that draws it.
//
//   render::Scene scene;
//   for (int part = 0; part < parts; ++part) {
//     render::Shape shape;
//     shape.vertices = ...; shape.triangles = ...;
//     shape.color = render::PartColor(part);
//     scene.shapes.push_back(shape);
//   }
//   scene.camera = render::FitCamera(render::BoundingBox(scene), render::kViewIsometric, 4.0 / 3);
//   MORTISE_ASSIGN_OR_RETURN(render::Image image, render::Render(scene, {.width = 800}));
//   MORTISE_ASSIGN_OR_RETURN(std::string png, render::EncodePng(image));
//
// No window, no graphics card: a z-buffer rasteriser with supersampling, the same picture for the
// same scene on every machine.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/render/camera.h"
#include "common/render/image.h"

namespace mortise::render {

// How feature edges of a shape are drawn where something stands before them.
enum class HiddenEdges { kOmit, kDashed };

// A triangulated surface. Edges between triangles that meet at more than `feature_angle`, border
// edges and the outline are drawn as lines.
struct Shape {
  Eigen::Matrix3Xd vertices;   // 3 × V, m
  Eigen::Matrix3Xi triangles;  // 3 × T
  Color color{0.8, 0.8, 0.8};
  Eigen::VectorXd scalars;  // V values coloured by Scene::color_bar; empty for `color`
  bool smooth = false;      // shade by averaged normals instead of triangle by triangle
  bool filled = true;       // false: lines only, for a ghost of the undeformed shape
  bool backdrop = false;    // drawn first and unlit, covered by all that is not a backdrop: the
                            // shape before a deformation
  bool edges = true;
  double feature_angle = 0.5;  // rad; negative to draw all edges
  double edge_width = 1.2;     // pixels
  Color edge_color{0.15, 0.16, 0.2};
  HiddenEdges hidden_edges = HiddenEdges::kOmit;
};

// A line in space through the given points, e.g. an arrow along which a part is pushed in.
struct Line {
  Eigen::Matrix3Xd points;  // 3 × n, m
  Color color{0.8, 0.1, 0.1};
  double width = 2;     // pixels
  bool arrow = false;   // a head at the last point
  bool on_top = false;  // never hidden by shapes
};

// A text beside a point of space, always readable.
struct Label {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
  std::string text;
};

// The meaning of scalar colours, drawn as a bar with numbers at the right of the picture.
struct ColorBar {
  double minimum = 0;
  double maximum = 1;
  std::string title;  // with the unit, e.g. "von Mises stress (MPa)"
};

struct Scene {
  std::vector<Shape> shapes;
  std::vector<Line> lines;
  std::vector<Label> labels;
  Camera camera;
  std::optional<ColorBar> color_bar;  // needed as soon as a shape has scalars
  std::string title;                  // one line at the top left; may be empty
  std::string footnote;               // one line at the bottom left; may be empty
  Color background{1, 1, 1};
};

struct RenderOptions {
  int width = 1000;     // pixels, 16 to 8192
  int height = 750;     // pixels, 16 to 8192
  int supersample = 3;  // each pixel averages supersample² samples; 1 to 4
};

// Draws the scene. INVALID_ARGUMENT names the shape whose indices or numbers are unusable.
absl::StatusOr<Image> Render(const Scene& scene, const RenderOptions& options = {});

}  // namespace mortise::render
