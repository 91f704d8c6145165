// Shapes of parts and items in the store: each kept once, under the digest of its content, for as
// long as any revision of anything refers to it (shape_sweep.h).
#pragma once

#include <google/protobuf/repeated_ptr_field.h>

#include <set>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/design/template_validation.h"
#include "common/mesh/shapes/drawn_shape.h"
#include "common/resources/author.h"
#include "common/store/store.h"
#include "mortise/v1/assembly.pb.h"
#include "mortise/v1/catalog.pb.h"

namespace mortise::catalog {

// The kind of their records.
inline constexpr const char* kShapes = "shapes";

// Returns the message of a shape, named by its content.
v1::Shape NamedShape(const mesh::DrawnShape& shape);

// Returns what a stranger is shown: without exact surfaces.
v1::Shape ShownShape(v1::Shape shape);

// With exact surfaces. INVALID_ARGUMENT, "name"; NOT_FOUND; INTERNAL for a record that is not what
// its name says.
absl::StatusOr<v1::Shape> GetShape(store::ReadTransaction& transaction, const std::string& name);

// Writes a named shape unless it is there; true if it was not. In either case it is as if it had
// just been imported.
absl::StatusOr<bool> PutShape(store::Transaction& transaction, const v1::Shape& shape);

// Writes a shape that was read from a file ("shape.imported"), and gives it without its arrays. Its
// notes are of the file, so the answer has them and the record does not.
absl::StatusOr<v1::Shape> ImportShape(store::Transaction& transaction, v1::Shape shape,
                                      const resources::Author& author);

// Returns the shapes that the assembly's parts and the items name and that `shapes` does not have.
std::set<std::string> MissingShapes(const v1::Assembly& assembly,
                                    const google::protobuf::RepeatedPtrField<v1::Item>& items,
                                    const google::protobuf::RepeatedPtrField<v1::Shape>& shapes);

// Adds those shapes of the assembly's parts and of the items that exist and that `shapes` does not
// have, by name.
absl::Status AddShapes(store::ReadTransaction& transaction, const v1::Assembly& assembly,
                       const google::protobuf::RepeatedPtrField<v1::Item>& items,
                       google::protobuf::RepeatedPtrField<v1::Shape>& shapes);

// Leaves out exact surfaces, which only files need.
void DropExact(google::protobuf::RepeatedPtrField<v1::Shape>& shapes);

// Leaves in place of the shapes that do not fit into one message, 3 MB, their names.
void NameWhatDoesNotFit(v1::TemplateBundle& bundle);

// Fails with INVALID_ARGUMENT, "parts": shapes that together are more than whoever evaluates the
// design takes.
absl::Status CheckShapesTogether(const google::protobuf::RepeatedPtrField<v1::Shape>& shapes);

// Returns what is wrong with an item's shape, given the shapes there are: none of this name, or
// another size than the item fixes.
absl::StatusOr<std::vector<FieldViolation>> CheckItemShape(store::ReadTransaction& transaction,
                                                           const v1::Item& item);

}  // namespace mortise::catalog
