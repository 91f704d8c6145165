// A vase of two parameters, as the service would give away a map of it: its
// shapes follow from formulas, so that what a page shows can be foretold.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <numbers>
#include <string>
#include <vector>

#include "cli/explore/exported_structure.h"
#include "mortise/v1/interpolator.pb.h"

namespace mortise::cli {

// Numbers one after another, little-endian.
template <typename Number>
std::string BytesOf(const std::vector<Number>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), sizeof(Number) * numbers.size()};
}

inline constexpr int kAround = 48;  // nodes of a ring of the vase
inline constexpr int kRings = 40;

// A surface around the z-axis with closed ends, of kAround · kRings + 2 nodes.
inline v1::MapMesh VaseMesh() {
  std::vector<std::uint32_t> triangles;
  const auto node = [](int ring, int around) {
    return static_cast<std::uint32_t>(ring * kAround + around % kAround);
  };
  for (int ring = 0; ring + 1 < kRings; ++ring) {
    for (int a = 0; a < kAround; ++a) {
      for (const std::uint32_t corner : {node(ring, a), node(ring, a + 1), node(ring + 1, a + 1),
                                         node(ring, a), node(ring + 1, a + 1), node(ring + 1, a)}) {
        triangles.push_back(corner);
      }
    }
  }
  const std::uint32_t bottom = kRings * kAround, top = bottom + 1;
  for (int a = 0; a < kAround; ++a) {
    for (const std::uint32_t corner :
         {bottom, node(0, a + 1), node(0, a), top, node(kRings - 1, a), node(kRings - 1, a + 1)}) {
      triangles.push_back(corner);
    }
  }
  v1::MapMesh mesh;
  mesh.set_nodes(top + 1);
  mesh.set_triangles(BytesOf(triangles));
  mesh.set_parts(BytesOf(std::vector<std::uint32_t>(triangles.size() / 3, 0)));
  mesh.add_part_names("vase");
  return mesh;
}

// A field of the vase in one load case.
inline v1::MapFieldValues Values(const char* name, const char* load_case,
                                 const std::vector<float>& numbers) {
  v1::MapFieldValues values;
  values.set_name(name);
  values.set_load_case(load_case);
  values.set_values(BytesOf(numbers));
  return values;
}

// The vase at a place (height, waist) of the unit box, with its fields. All of it is linear in
// either number.
inline v1::MapExportPart::Sample VaseAt(int sample, double height, double waist) {
  std::vector<float> positions, displacement, stress, temperature;
  const auto add = [&](double z, double radius, double angle) {
    const double length = 0.2 + 0.2 * height;
    const double x = radius * std::cos(angle), y = radius * std::sin(angle);
    for (const double p : {x, y, z * length}) positions.push_back(static_cast<float>(p));
    for (const double d : {1e-3 * z * z * (1 + height), 0.0, -1e-4 * z}) {
      displacement.push_back(static_cast<float>(d));
    }
    stress.push_back(static_cast<float>(2e7 * (1 - z) * (1.2 + std::cos(angle)) * (1 + height)));
    temperature.push_back(static_cast<float>(293 + 40 * z - 60 * waist * std::sin(4 * z)));
  };
  for (int ring = 0; ring < kRings; ++ring) {
    const double z = ring / (kRings - 1.0);
    const double radius = 0.05 + 0.02 * std::sin(5 * z + 0.6) + 0.03 * waist * std::sin(9 * z);
    for (int a = 0; a < kAround; ++a) add(z, radius, 2 * std::numbers::pi * a / kAround);
  }
  add(0, 0, 0);
  add(1, 0, 0);
  v1::MapExportPart::Sample shape;
  shape.set_sample(sample);
  shape.set_positions(BytesOf(positions));
  *shape.add_fields() = Values("displacement", "push", displacement);
  *shape.add_fields() = Values("von_mises", "push", stress);
  *shape.add_fields() = Values("temperature", "sun", temperature);
  return shape;
}

// What the map says of its shapes.
inline v1::MapShapes VaseShapes() {
  v1::MapShapes shapes;
  shapes.set_geometry(v1::SURFACE);
  const auto add = [&](const char* name, const char* unit, const char* load_case, int components,
                       double minimum, double maximum) {
    v1::MapShapes::Field& field = *shapes.add_fields();
    field.set_name(name);
    field.set_unit(unit);
    field.set_load_case(load_case);
    field.set_components(components);
    field.set_minimum(minimum);
    field.set_maximum(maximum);
  };
  add("displacement", "m", "push", 3, -1e-4, 2e-3);
  add("von_mises", "Pa", "push", 1, 0, 8.8e7);
  add("temperature", "K", "sun", 1, 230, 400);
  shapes.set_meshes(1);
  shapes.set_size(0.45);
  shapes.set_largest_error(2e-4);
  shapes.set_rounding(3e-6);
  return shapes;
}

// The shapes of all samples of an exported tree of two numbers.
inline void AddVases(ExportedStructure& structure) {
  structure.meshes.push_back(VaseMesh());
  for (int i = 0; 2 * i < structure.tree.positions_size(); ++i) {
    structure.samples.push_back(
        VaseAt(i, structure.tree.positions(2 * i), structure.tree.positions(2 * i + 1)));
  }
  for (int e = 0; e < structure.tree.cut_off_size(); ++e) {
    structure.tree.add_meshes(0);
    structure.tree.add_shape_errors(1.5e-4);
    for (const double error : {2e-6, 1.5e6, 3.0}) structure.tree.add_field_errors(error);
  }
}

// A map of one metric over the vase's two numbers, without its shapes.
inline v1::DesignMap VaseMap() {
  v1::DesignMap map;
  map.set_name("maps/vase");
  map.mutable_specification()->set_subject("templates/vase");
  for (const char* const name : {"height", "waist"}) {
    v1::MapParameter& parameter = *map.add_parameters();
    parameter.set_name(name);
    parameter.set_unit("m");
    parameter.set_maximum(2);
  }
  v1::MapMetric& metric = *map.add_metrics();
  metric.set_name("mass");
  metric.set_unit("kg");
  metric.set_maximum(3);
  map.add_structures();
  return map;
}

// Its only element: four B-splines, each of the sample at its centre.
inline ExportedStructure OneElement() {
  ExportedStructure structure;
  v1::MapTree& tree = structure.tree;
  tree.set_dimension(2);
  tree.add_directions(-1);
  tree.add_children(0);
  tree.add_coarsest_levels(0);
  tree.add_finest_levels(0);
  tree.add_cut_off(false);
  tree.add_errors(0.01);
  for (int corner = 0; corner < 4; ++corner) {
    tree.add_levels(0);
    tree.add_sample_counts(1);
    tree.add_samples(corner);
    tree.add_weights(1);
    tree.add_values(corner);
    for (const int coordinate : {corner & 1, corner >> 1}) {
      tree.add_centres(coordinate);
      tree.add_positions(coordinate);
    }
  }
  return structure;
}

}  // namespace mortise::cli
