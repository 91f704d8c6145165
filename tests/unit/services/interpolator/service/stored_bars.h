// A map of bars in a store of its own, as a build leaves it.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>

#include "common/maps/map_sampling.h"
#include "common/store/store.h"
#include "mortise/v1/interpolator.pb.h"
#include "services/interpolator/records/loaded_shapes.h"
#include "services/interpolator/records/stored_map.h"
#include "services/interpolator/service/loaded_maps.h"
#include "services/interpolator/service/map_records.h"
#include "services/interpolator/shapes/bring_into.h"
#include "services/interpolator/shapes/packed_shape.h"
#include "services/interpolator/shapes/shape_file.h"
#include "tests/support/bar_design.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/services/interpolator/shapes/brought_design.h"

namespace mortise::interpolator::testing {

using mortise::testing::BarDesign;
using mortise::testing::BarStress;

// maps/bars, over x in [0, 1] and y in [10, 12], of one element: its metric "mass" is 3 + x, unless
// it has no shapes, or nothing at all. How far it is off is made up.
class StoredBars {
 public:
  enum class Has { kAll, kMetrics, kNothing };

  explicit StoredBars(int cells = 3, Has has = Has::kAll) {
    store_ = store::OpenStore({.url = "sqlite:" + (folder_.path() / "store.db").string(),
                               .blob_folder = folder_.path() / "blobs"})
                 .value();
    blobs_ = store_->Blobs().value();
    maps::MapContent content;
    content.dimension = 2;
    content.errors = Eigen::MatrixXd::Constant(1, 1, 0.25);
    content.cut_off = {static_cast<std::uint8_t>(has == Has::kNothing ? 1 : 0)};
    const auto tree = maps::RefinementTree::Create(2, maps::Basis::kLinear).value();
    content.values.resize(1, tree.sample_count());
    StoredShapes shapes;
    shapes.element_meshes = {has == Has::kAll ? 0 : -1};
    shapes.shape_errors = Eigen::VectorXd::Constant(1, 0.125);
    shapes.field_errors = Eigen::Vector2d(2e4, 0.5);
    mesh_ = std::make_shared<const CanonicalMesh>(
        CanonicalMesh::Create(BarDesign(0.5, 11, cells)).value());
    shapes.meshes = {{blobs_->Put(WriteMesh(*mesh_).value()).value(), {}}};
    for (int sample = 0; sample < tree.sample_count(); ++sample) {
      const Eigen::VectorXd place = tree.SamplePosition(sample);
      content.values(0, sample) = 3 + place[0];
      const auto brought = Brought(BarDesign(place[0], 10 + 2 * place[1], cells), *mesh_);
      const PackedShape packed = Pack(brought.value().shape, *mesh_).value();
      shapes.meshes[0].shapes[sample] = blobs_->Put(WriteShape(packed, *mesh_).value()).value();
    }
    stored_ = shapes;
    Put(blobs_->Put(SerializeMap({content}, {shapes})).value());
    loaded_ = std::make_unique<LoadedMaps>(store_.get(), blobs_);
    shapes_ = std::make_unique<LoadedShapes>(blobs_);
  }

  std::shared_ptr<const LoadedMap> map() { return loaded_->Get("maps/bars").value(); }
  LoadedShapes& shapes() { return *shapes_; }
  store::BlobFolder& blobs() { return *blobs_; }
  const CanonicalMesh& mesh() const { return *mesh_; }
  const StoredShapes& stored() const { return stored_; }

 private:
  void Put(const std::string& digest) {
    v1::DesignMap map;
    map.set_name("maps/bars");
    map.set_sha256(digest);
    map.add_structures();
    map.add_metrics()->set_name("mass");
    for (const bool is_x : {true, false}) {
      v1::MapParameter& parameter = *map.add_parameters();
      parameter.set_name(is_x ? "x" : "y");
      parameter.set_minimum(is_x ? 0 : 10);
      parameter.set_maximum(is_x ? 1 : 12);
    }
    map.mutable_shapes()->set_geometry(v1::TETRAHEDRA);
    v1::MapShapes::Field& stress = *map.mutable_shapes()->add_fields();
    stress.set_name("stress");
    stress.set_load_case("pull");
    stress.set_maximum(4e6);
    v1::MapShapes::Field& heat = *map.mutable_shapes()->add_fields();
    heat.set_name("heat");
    heat.set_of_elements(true);
    heat.set_maximum(1);
    const absl::Status put = store_->Transact([&](store::Transaction& transaction) {
      return transaction.Put(kMaps.kind, "bars", map.SerializeAsString()).status();
    });
    EXPECT_TRUE(put.ok()) << put;
  }

  const mortise::testing::TemporaryFolder folder_;
  std::unique_ptr<store::Store> store_;
  store::BlobFolder* blobs_ = nullptr;
  std::shared_ptr<const CanonicalMesh> mesh_;
  StoredShapes stored_;
  std::unique_ptr<LoadedMaps> loaded_;
  std::unique_ptr<LoadedShapes> shapes_;
};

}  // namespace mortise::interpolator::testing
