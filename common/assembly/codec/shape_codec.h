// Shapes of parts and items from and to their messages (mortise/v1/item.proto). Target
// mortise_assembly_codec.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "common/files/shape_name.h"
#include "common/mesh/shapes/drawn_shape.h"

namespace google::protobuf {
template <typename Element>
class RepeatedPtrField;
}
namespace mortise::v1 {
class Shape;
}

namespace mortise::parametric {

using ShapesByName = std::map<std::string, std::shared_ptr<const mesh::DrawnShape>>;

// INVALID_ARGUMENT naming the field of the message that does not fit the others.
absl::StatusOr<mesh::DrawnShape> FromProto(const v1::Shape& message);

// With triangles, and exact surfaces if it has some.
v1::Shape ToProto(const mesh::DrawnShape& shape);

// INVALID_ARGUMENT naming "shapes[i]" as above.
absl::StatusOr<ShapesByName> FromProto(const google::protobuf::RepeatedPtrField<v1::Shape>& shapes);

}  // namespace mortise::parametric
