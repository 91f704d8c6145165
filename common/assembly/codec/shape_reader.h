// What parts look like: their own shapes or their items', and what follows from them for
// parametrisation. Private to part_reader.cpp.
#pragma once

#include <Eigen/Core>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/assembly/codec/shape_codec.h"
#include "common/assembly/model/assembly.h"
#include "common/design/template_definition.h"
#include "common/design/template_validation.h"

namespace mortise::v1 {
class AssemblyPart;
}

namespace mortise::parametric {

// Finds the shapes of parts. The shapes and findings must outlive it.
class ShapeReader {
 public:
  ShapeReader(const ShapesByName& shapes, std::vector<FieldViolation>& findings)
      : shapes_(shapes), findings_(findings) {}

  // Sets the part's own shape, or else its item's, turned as the item lies. `size`, m, of its box;
  // `field`: where the part is in the message. A finding for shapes that there are not, and those
  // that would be stretched along what the item fixes.
  void Read(const v1::AssemblyPart& message, const std::string& field, const Item* item,
            const Eigen::Vector3d& size, AssemblyPart& part);

 private:
  std::shared_ptr<const mesh::DrawnShape> TurnedAs(const mesh::DrawnShape& shape,
                                                   const std::array<Axis, 3>& axes);
  void CheckFixed(const Item& item, const Eigen::Vector3d& size, const std::string& field,
                  const AssemblyPart& part);

  const ShapesByName& shapes_;
  std::vector<FieldViolation>& findings_;
  std::map<std::pair<std::string, int>, std::shared_ptr<const mesh::DrawnShape>> turned_;
};

// Adds the large planar faces of the part's shape to its prominent planes, but for those that are
// annotated already. The part's box must be known.
void AddPlanesOfShape(AssemblyPart& part);

}  // namespace mortise::parametric
