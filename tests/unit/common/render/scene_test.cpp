// What the renderer draws where, and what it refuses.
#include "common/render/scene.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstdlib>
#include <limits>

#include "common/base/errors.h"
#include "common/base/files.h"

namespace mortise::render {
namespace {

Shape Box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  Shape shape;
  shape.vertices.resize(3, 8);
  for (int i = 0; i < 8; ++i) {
    shape.vertices.col(i) << (i & 1 ? high : low).x(), (i & 2 ? high : low).y(),
        (i & 4 ? high : low).z();
  }
  shape.triangles.resize(3, 12);
  shape.triangles << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      2, 3, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7,                 //
      3, 1, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5;
  return shape;
}

// A small table, as an eye test: the picture is kept where MORTISE_PICTURES says.
Scene Table() {
  Scene scene;
  const auto add = [&](double x, double y, double z, double dx, double dy, double dz) {
    Shape box = Box({x, y, z}, {x + dx, y + dy, z + dz});
    box.color = PartColor(static_cast<int>(scene.shapes.size()));
    scene.shapes.push_back(box);
  };
  add(0, 0, 0.70, 1.4, 0.8, 0.03);
  for (const double x : {0.05, 1.29}) {
    for (const double y : {0.05, 0.69}) add(x, y, 0, 0.06, 0.06, 0.70);
  }
  add(0.11, 0.065, 0.6, 1.18, 0.03, 0.1);
  add(0.11, 0.705, 0.6, 1.18, 0.03, 0.1);
  scene.camera = FitCamera(BoundingBox(scene), kViewIsometric, 4.0 / 3);
  return scene;
}

void Keep(const char* name, const Image& image) {
  const char* folder = std::getenv("MORTISE_PICTURES");
  if (folder == nullptr) return;
  ASSERT_TRUE(WriteFile(std::filesystem::path(folder) / name, *EncodePng(image)).ok());
}

TEST(Render, FillsTheMiddleAndKeepsTheMargin) {
  Scene scene;
  scene.shapes.push_back(Box({0, 0, 0}, {1, 1, 1}));
  scene.shapes[0].color = {0.8, 0.2, 0.2};
  scene.camera = FitCamera(BoundingBox(scene), kViewFront, 1.0);
  const auto image = Render(scene, {.width = 100, .height = 100, .supersample = 2});
  ASSERT_TRUE(image.ok()) << image.status();
  EXPECT_GT(image->Get(50, 50).red, 2 * image->Get(50, 50).green);
  EXPECT_EQ(image->Get(2, 2), (Color{1, 1, 1}));
  EXPECT_EQ(image->Get(97, 97), (Color{1, 1, 1}));
}

TEST(Render, NearerSurfacesHideFartherOnes) {
  for (const bool orthographic : {true, false}) {
    Scene scene;
    scene.shapes.push_back(Box({0, 1, 0}, {1, 2, 1}));
    scene.shapes.push_back(Box({0, 0, 0}, {1, 0.9, 1}));
    scene.shapes[0].color = {1, 0, 0};
    scene.shapes[1].color = {0, 0, 1};
    scene.camera = FitCamera(BoundingBox(scene), kViewFront, 1.0, orthographic);
    const auto image = Render(scene, {.width = 64, .height = 64, .supersample = 1});
    ASSERT_TRUE(image.ok());
    EXPECT_EQ(image->Get(32, 32).red, 0);
    EXPECT_GT(image->Get(32, 32).blue, 0.4);
  }
}

TEST(Render, HiddenEdgesAreDashedOnlyWhenAsked) {
  Scene scene;
  scene.shapes.push_back(Box({0, 0, 0}, {1, 0.1, 1}));
  scene.shapes.push_back(Box({0.3, 0.5, 0.3}, {0.7, 0.8, 0.7}));
  scene.camera = FitCamera(BoundingBox(scene), kViewFront, 1.0);
  const auto plain = Render(scene, {.width = 120, .height = 120});
  scene.shapes[1].hidden_edges = HiddenEdges::kDashed;
  const auto dashed = Render(scene, {.width = 120, .height = 120});
  ASSERT_TRUE(plain.ok() && dashed.ok());
  int changed = 0;
  for (std::size_t i = 0; i < plain->pixels.size(); ++i) {
    changed += plain->pixels[i] != dashed->pixels[i];
  }
  EXPECT_GT(changed, 60);
  EXPECT_LT(changed, 3000);
}

TEST(Render, ScalarsTakeTheColoursOfTheBar) {
  Scene scene;
  Shape shape = Box({0, 0, 0}, {1, 1, 1});
  shape.scalars = shape.vertices.row(2).transpose();
  shape.edges = false;
  scene.shapes.push_back(shape);
  scene.camera = FitCamera(BoundingBox(scene), kViewFront, 1.0);
  EXPECT_FALSE(Render(scene).ok());
  scene.color_bar = ColorBar{0, 1, "height (m)"};
  const auto image = Render(scene, {.width = 400, .height = 300});
  ASSERT_TRUE(image.ok()) << image.status();
  Keep("bar.png", *image);
  // Brighter at the top than at the bottom of the box, as the map says.
  EXPECT_GT(image->Get(150, 80).green, image->Get(150, 220).green);
}

TEST(Render, DrawsTheTable) {
  Scene scene = Table();
  scene.title = "Table, 7 parts; load 400 N/m²";
  scene.footnote = "Deformation ×120";
  scene.labels.push_back({{1.4, 0, 0.73}, "top"});
  Line push;
  push.points.resize(3, 2);
  push.points << 0.7, 0.7, 0.4, 0.4, 1.0, 0.76;
  push.arrow = true;
  scene.lines.push_back(push);
  for (Shape& shape : scene.shapes) shape.hidden_edges = HiddenEdges::kDashed;
  const auto hidden = Render(scene, {.width = 640, .height = 480});
  ASSERT_TRUE(hidden.ok());
  Keep("table_hidden.png", *hidden);
  for (Shape& shape : scene.shapes) shape.hidden_edges = HiddenEdges::kOmit;
  scene.camera = FitCamera(BoundingBox(scene), kViewIsometric, 4.0 / 3, false);
  const auto perspective = Render(scene, {.width = 640, .height = 480});
  ASSERT_TRUE(perspective.ok());
  const auto sheet = ContactSheet({*hidden, *perspective}, {"hidden lines", "perspective"}, 2);
  ASSERT_TRUE(sheet.ok());
  Keep("sheet.png", *sheet);
}

TEST(Render, BackdropsStandBehindEverything) {
  Scene scene;
  scene.shapes.push_back(Box({0, 0, 0}, {1, 1, 1}));  // nearer, but a backdrop
  scene.shapes.push_back(Box({0, 2, 0}, {1, 3, 1}));
  scene.shapes[0].color = {1, 0, 0};
  scene.shapes[1].color = {0, 0, 1};
  scene.camera = FitCamera(BoundingBox(scene), kViewFront, 1.0);
  const RenderOptions small{.width = 64, .height = 64, .supersample = 1};
  EXPECT_EQ(Render(scene, small)->Get(32, 32).blue, 0);
  scene.shapes[0].backdrop = true;
  EXPECT_GT(Render(scene, small)->Get(32, 32).blue, 0.4);
}

TEST(Render, TheSameSceneGivesTheSamePicture) {
  const auto first = Render(Table(), {.width = 200, .height = 150});
  const auto second = Render(Table(), {.width = 200, .height = 150});
  ASSERT_TRUE(first.ok() && second.ok());
  EXPECT_EQ(first->pixels, second->pixels);
}

TEST(FitCameras, SeeEveryCornerFromEverySide) {
  const Eigen::AlignedBox3d box(Eigen::Vector3d(-1, 2, 3), Eigen::Vector3d(4, 3, 3.5));
  for (const bool orthographic : {true, false}) {
    for (const Eigen::Vector3d& direction :
         {kViewIsometric, kViewFront, kViewRight, kViewTop, Eigen::Vector3d(0, 0, 1)}) {
      Scene scene;
      scene.shapes.push_back(Box(box.min(), box.max()));
      scene.shapes[0].edges = false;
      scene.shapes[0].color = {0, 0, 0};
      scene.camera = FitCamera(box, direction, 1.5, orthographic, 0.05);
      const auto image = Render(scene, {.width = 150, .height = 100, .supersample = 1});
      ASSERT_TRUE(image.ok());
      int ink = 0;
      for (int y = 0; y < 100; ++y) {
        for (int x = 0; x < 150; ++x) {
          const bool dark = image->Get(x, y).red < 0.5;
          ink += dark;
          if (x < 3 || y < 3 || x >= 147 || y >= 97) {
            EXPECT_FALSE(dark) << x << " " << y;
          }
        }
      }
      EXPECT_GT(ink, 300);
    }
  }
}

TEST(Render, RefusesUnusableScenes) {
  const auto field = [](const Scene& scene, const RenderOptions& options) {
    const auto image = Render(scene, options);
    return image.ok() ? std::string() : DetailOf(image.status()).field;
  };
  const RenderOptions small{.width = 64, .height = 64, .supersample = 1};
  Scene scene = Table();
  EXPECT_EQ(field(scene, {.width = 0}), "options.width");
  EXPECT_EQ(field(scene, {.width = 64, .height = 100000}), "options.height");
  EXPECT_EQ(field(scene, {.width = 64, .height = 64, .supersample = 9}), "options.supersample");
  Scene broken = scene;
  broken.shapes[1].vertices(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(field(broken, small), "shapes[1].vertices");
  broken = scene;
  broken.shapes[2].triangles(0, 0) = 99;
  EXPECT_EQ(field(broken, small), "shapes[2].triangles");
  broken = scene;
  broken.camera.eye = broken.camera.target;
  EXPECT_EQ(field(broken, small), "camera");
  EXPECT_EQ(field(scene, small), "");
}

}  // namespace
}  // namespace mortise::render
