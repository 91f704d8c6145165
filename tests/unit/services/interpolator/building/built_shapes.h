// What a build with shapes made, for tests of it.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "common/maps/interpolation_map.h"
#include "common/maps/packed_weights.h"
#include "services/interpolator/building/map_building.h"
#include "services/interpolator/shapes/blend.h"
#include "services/interpolator/shapes/shape_file.h"
#include "tests/unit/services/interpolator/building/formula_blocks.h"

namespace mortise::interpolator {

// Both plan and options must outlive what is built.
inline std::unique_ptr<MapBuilding> Built(const MapPlan& plan, const BuildOptions& options,
                                          const KnownAnswers& known = {}, KnownShapes shapes = {}) {
  auto building = MapBuilding::Create(plan, options).value();
  const absl::Status status = building->Run(known, std::move(shapes));
  EXPECT_TRUE(status.ok()) << status;
  return building;
}

// Of its first structure.
inline ShapedStructure ShapesOf(const MapBuilding& building) {
  auto shapes = building.ShapesOf(0);
  EXPECT_TRUE(shapes.ok()) << shapes.status();
  return **shapes;
}

inline void ExpectSame(const Spread& a, const Spread& b) {
  EXPECT_EQ(a.largest, b.largest);
  EXPECT_EQ(a.of_99, b.of_99);
  EXPECT_EQ(a.mean, b.mean);
}

inline void ExpectSame(const ShapedStructure::Errors& a, const ShapedStructure::Errors& b) {
  ExpectSame(a.shape, b.shape);
  ASSERT_EQ(a.fields.size(), b.fields.size());
  for (std::size_t f = 0; f < a.fields.size(); ++f) ExpectSame(a.fields[f], b.fields[f]);
}

inline void ExpectSame(const MapBuilding& a, const MapBuilding& b) {
  const maps::MapContent first = a.structures()[0]->Content().value();
  const maps::MapContent second = b.structures()[0]->Content().value();
  EXPECT_EQ(first.splits, second.splits);
  EXPECT_EQ(first.values, second.values);
  EXPECT_EQ(first.errors, second.errors);
  EXPECT_EQ(first.cut_off, second.cut_off);
  const ShapedStructure shapes = ShapesOf(a), others = ShapesOf(b);
  EXPECT_EQ(shapes.element_mesh, others.element_mesh);
  ASSERT_EQ(shapes.meshes.size(), others.meshes.size());
  for (std::size_t m = 0; m < shapes.meshes.size(); ++m) {
    EXPECT_EQ(shapes.meshes[m].digest, others.meshes[m].digest);
  }
  ASSERT_EQ(shapes.shapes.size(), others.shapes.size());
  for (const auto& [key, shape] : shapes.shapes) {
    EXPECT_EQ(shape.digest, others.shapes.at(key).digest);
  }
  ASSERT_EQ(shapes.element_errors.size(), others.element_errors.size());
  for (std::size_t e = 0; e < shapes.element_errors.size(); ++e) {
    ExpectSame(shapes.element_errors[e], others.element_errors[e]);
  }
  ExpectSame(shapes.largest, others.largest);
  ExpectSame(shapes.mean, others.mean);
  EXPECT_EQ(shapes.unmapped, others.unmapped);
}

// What a build hands over to be kept, each thing once.
struct Keeper {
  KnownAnswers answers;
  KnownShapes shapes;

  void KeepFor(BuildOptions& options) {
    options.keep = [this](const KnownAnswers& fresh) {
      for (const auto& [key, answer] : fresh) EXPECT_TRUE(answers.emplace(key, answer).second);
      return absl::OkStatus();
    };
    options.shapes->keep = [this](const KnownShapes& fresh) {
      for (const auto& each : fresh.meshes) EXPECT_TRUE(shapes.meshes.insert(each).second);
      for (const auto& each : fresh.shapes) EXPECT_TRUE(shapes.shapes.insert(each).second);
      for (const auto& each : fresh.differences) {
        EXPECT_TRUE(shapes.differences.insert(each).second);
      }
      return absl::OkStatus();
    };
  }
};

// A map as it is served.
class ServedShapes {
 public:
  ServedShapes(const MapBuilding& building, const FileShelf& shelf)
      : map_(*maps::InterpolationMap::Create(*building.structures()[0]->Content())),
        weights_(map_.tree()),
        structure_(ShapesOf(building)) {
    for (const ShapedStructure::Mesh& mesh : structure_.meshes) {
      meshes_.push_back(ReadMesh(shelf.Get(mesh.digest).value()).value());
    }
    for (const auto& [key, shape] : structure_.shapes) {
      shapes_[key] = ReadShape(shelf.Get(shape.digest).value(), meshes_[key.first]).value();
    }
    int order = 0;
    for (const int element : map_.tree().Elements()) order_[element] = order++;
  }

  int MeshAt(const Eigen::VectorXd& point) const {
    return structure_.element_mesh[order_.at(map_.tree().Locate(point))];
  }
  const CanonicalMesh& mesh(int number) const { return meshes_[number]; }
  const ShapedStructure& structure() const { return structure_; }

  BlendedShape At(const Eigen::VectorXd& point) const {
    std::vector<maps::SampleWeight> weights;
    weights_.At(point.data(), weights);
    const int mesh = MeshAt(point);
    std::vector<WeightedShape> shapes;
    for (const maps::SampleWeight& each : weights) {
      shapes.push_back({&shapes_.at({mesh, each.sample}), each.weight});
    }
    BlendedShape blended;
    EXPECT_TRUE(
        Blend(shapes, meshes_[mesh], {.surface_only = false, .fields = {0, 1}}, blended).ok());
    return blended;
  }

 private:
  maps::InterpolationMap map_;
  maps::PackedWeights weights_;
  ShapedStructure structure_;
  std::vector<CanonicalMesh> meshes_;
  std::map<std::pair<int, int>, PackedShape> shapes_;
  std::map<int, std::size_t> order_;
};

}  // namespace mortise::interpolator
