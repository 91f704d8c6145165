// A bar of 0.4 x 0.04 x 0.04 m along x, as a template of each kind, for tests of its conditions.
// Its parameter "length" is that along x, 0.2 to 0.6 m. Its material has round numbers.
#pragma once

#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/unit/common/templates/shipped_collection.h"

namespace mortise::templates {

struct BarMaterial {
  double density = 1000;
  double youngs_modulus = 1e10;
  double poissons_ratio = 0;
  double thermal_expansion = 1e-5;
  double thermal_conductivity = 0.5;
};

inline void SetMaterial(const BarMaterial& values, v1::TemplateBundle& bundle) {
  for (v1::Material& material : *bundle.mutable_materials()) {
    if (material.name() != "materials/spruce") continue;
    material.clear_orthotropic();
    material.set_density(values.density);
    material.set_youngs_modulus(values.youngs_modulus);
    material.set_poissons_ratio(values.poissons_ratio);
    material.set_thermal_expansion(values.thermal_expansion);
    material.set_thermal_conductivity(values.thermal_conductivity);
  }
}

inline v1::TemplateBundle BarOf(const std::string& text, const BarMaterial& material) {
  v1::TemplateBundle bundle = ShippedTemplate("");
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(text, bundle.mutable_template_()));
  bundle.mutable_template_()->set_name("templates/bar");
  SetMaterial(material, bundle);
  return bundle;
}

inline const char* const kLength =
    "parameters { name: 'length' unit: 'm' minimum: 0.2 maximum: 0.6 default_value: 0.4 } ";

// A part called "bar"; `conditions` are text of a Template, faces those of a box.
inline v1::TemplateBundle PartsBar(const std::string& conditions,
                                   const BarMaterial& material = {}) {
  return BarOf(std::string(kLength) +
                   "title: 'Bar' parts { name: 'bar' item: 'items/spruce-planed-2400' "
                   "length_axis: X thickness_axis: Z box { x { from: '0' to: 'length' } "
                   "y { from: '0' to: '0.04' } z { from: '0' to: '0.04' } } } " +
                   conditions,
               material);
}

// An assembly of a part called "bar"; `conditions` are text of a Template, faces those of a box.
inline v1::TemplateBundle AssemblyBar(const std::string& conditions,
                                      const BarMaterial& material = {}) {
  v1::TemplateBundle bundle = BarOf(
      "assembly { assembly: 'assemblies/bar' handles { parameter: 'length' measure { element: "
      "'bar' "
      "axis: X } minimum: 0.2 maximum: 0.6 } } " +
          conditions,
      material);
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(
      "name: 'assemblies/bar' parts { name: 'bar' item: 'items/spruce-planed-2400' "
      "size { x: 0.4 y: 0.04 z: 0.04 } }",
      bundle.mutable_assembly()));
  return bundle;
}

// `conditions` are text of a CadTemplate; the ends are "bar.start" and "bar.end", the sides
// "bar.section.bottom" (z = 0), "top", "left" (y = 0) and "right".
inline v1::TemplateBundle CadBar(const std::string& conditions, const BarMaterial& material = {}) {
  return BarOf("cad { title: 'Bar' material: 'materials/spruce' " + std::string(kLength) +
                   "features { name: 'sketch' sketch { plane { normal { x: '1' } } "
                   "profiles { name: 'section' rectangle { center { x: '0.02' y: '0.02' } "
                   "width: '0.04' height: '0.04' } } } } "
                   "features { name: 'bar' extrude { sketch: 'sketch' to: 'length' } } " +
                   conditions + " }",
               material);
}

// `conditions` are text of a CageTemplate; faces: x_min, x_max, y_min, y_max, z_min, z_max.
inline v1::TemplateBundle CageBar(const std::string& conditions, const BarMaterial& material = {}) {
  return BarOf(
      "cage { title: 'Bar' material: 'materials/spruce' " + std::string(kLength) +
          "surface { vertices: [0, 0, 0, 0.4, 0, 0, 0.4, 0.04, 0, 0, 0.04, 0, "
          "0, 0, 0.04, 0.4, 0, 0.04, 0.4, 0.04, 0.04, 0, 0.04, 0.04] "
          "faces { name: 'z_min' triangles: [0, 2, 1, 0, 3, 2] } "
          "faces { name: 'z_max' triangles: [4, 5, 6, 4, 6, 7] } "
          "faces { name: 'y_min' triangles: [0, 1, 5, 0, 5, 4] } "
          "faces { name: 'x_max' triangles: [1, 2, 6, 1, 6, 5] } "
          "faces { name: 'y_max' triangles: [2, 3, 7, 2, 7, 6] } "
          "faces { name: 'x_min' triangles: [3, 0, 4, 3, 4, 7] } } "
          "cage { vertices { x: '0' y: '-0.01' z: '-0.01' } "
          "vertices { x: 'length' y: '-0.01' z: '-0.01' } "
          "vertices { x: 'length' y: '0.05' z: '-0.01' } vertices { y: '0.05' z: '-0.01' } "
          "vertices { y: '-0.01' z: '0.05' } vertices { x: 'length' y: '-0.01' z: '0.05' } "
          "vertices { x: 'length' y: '0.05' z: '0.05' } vertices { y: '0.05' z: '0.05' } "
          "triangles: [0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7, 0, 1, 5, 0, 5, 4, "
          "1, 2, 6, 1, 6, 5, 2, 3, 7, 2, 7, 6, 3, 0, 4, 3, 4, 7] } " +
          conditions + " }",
      material);
}

}  // namespace mortise::templates
