// Makes of an assembly at given parameters a design like any other: parts with shapes, sizes and
// masses, which files, plans and pictures are made from.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/assembly/parametric_assembly.h"
#include "common/design/evaluated_design.h"
#include "common/design/structure.h"
#include "common/design/template_definition.h"

namespace mortise::parametric {

// Returns every part at q, in the pose the design is drawn in. A part looks as follows:
// - One with a shape is that shape stretched into its box. Its surface is faceted, but its volume
//   is exact.
// - One whose item is round, a rod or a wheel, is a prism of 24 sides that has the volume of the
//   cylinder in its box.
// - Any other is its box.
//
// Parts whose item or material is not given have no mass. The connecting parts are parts too, so
// there are no connectors, and there are no parameters.
EvaluatedDesign DesignAt(const ParametricAssembly& assembly, const Eigen::VectorXd& q,
                         const std::vector<Item>& items, const std::vector<Material>& materials);

// Returns how many parts each pattern of the assembly has along each of its directions at q, by the
// names of their elements and in the order of the elements. Everything else of a design is always
// there. Designs with the same structure have the same parts with the same vertices and triangles.
// O(patterns).
Structure StructureAt(const ParametricAssembly& assembly, const Eigen::VectorXd& q);

}  // namespace mortise::parametric
