#include "services/catalog/records/shape_records.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/codec/shape_codec.h"
#include "common/base/errors.h"
#include "common/files/message_checks.h"
#include "services/catalog/records/record_access.h"

namespace mortise::catalog {
namespace {

constexpr std::size_t kDigest = 64;               // characters
constexpr std::size_t kMaxTogether = 64'000'000;  // bytes of arrays
constexpr std::size_t kMaxInMessage = 3'000'000;  // bytes of arrays
// Writing again what was written just now is spared; far less than kUnusedShapeLife.
constexpr absl::Duration kFresh = absl::Minutes(5);

absl::StatusOr<std::string> KeyOf(const std::string& name) {
  const std::string prefix = absl::StrCat(kShapes, "/");
  const std::string key = name.starts_with(prefix) ? name.substr(prefix.size()) : "";
  const bool is_digest = std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
  });
  if (key.size() == kDigest && is_digest) return key;
  return InvalidField("name", "must be 'shapes/' and 64 lower-case hexadecimal digits");
}

}  // namespace

v1::Shape NamedShape(const mesh::DrawnShape& shape) {
  v1::Shape message = parametric::ToProto(shape);
  message.set_name(parametric::NameOf(message));
  return message;
}

v1::Shape ShownShape(v1::Shape shape) {
  shape.clear_brep();
  return shape;
}

absl::StatusOr<v1::Shape> GetShape(store::ReadTransaction& transaction, const std::string& name) {
  MORTISE_ASSIGN_OR_RETURN(const std::string key, KeyOf(name));
  const absl::StatusOr<store::Record> record = transaction.Get(kShapes, key);
  if (absl::IsNotFound(record.status())) return ResourceNotFound(name);
  MORTISE_RETURN_IF_ERROR(record.status());
  v1::Shape shape;
  if (!shape.ParseFromString(record->payload)) {
    return StorageFailed(name, "the record cannot be read");
  }
  // The kernel may crash over damaged surfaces.
  if (parametric::NameOf(shape) != name) return StorageFailed(name, "the record is damaged");
  return shape;
}

absl::StatusOr<bool> PutShape(store::Transaction& transaction, const v1::Shape& shape) {
  MORTISE_ASSIGN_OR_RETURN(const std::string key, KeyOf(shape.name()));
  const absl::StatusOr<store::Record> present = transaction.Get(kShapes, key);
  if (!present.ok() && !absl::IsNotFound(present.status())) return present.status();
  if (present.ok() && present->updated_at >= transaction.Now() - kFresh) return false;
  MORTISE_RETURN_IF_ERROR(
      transaction.Put(kShapes, key, shape.SerializeAsString(), {.keep_history = false}).status());
  return !present.ok();
}

absl::StatusOr<v1::Shape> ImportShape(store::Transaction& transaction, v1::Shape shape,
                                      const resources::Author& author) {
  const auto notes = std::move(*shape.mutable_notes());
  shape.clear_notes();
  MORTISE_ASSIGN_OR_RETURN(const bool is_new, PutShape(transaction, shape));
  if (is_new) {
    MORTISE_RETURN_IF_ERROR(AppendEvent(transaction, "shape.imported", shape.name(),
                                        {{"volume", shape.volume()},
                                         {"triangles", shape.triangle_count()},
                                         {"exact", shape.exact()}},
                                        author));
  }
  v1::Shape summary = ShownShape(std::move(shape));
  *summary.mutable_notes() = notes;
  summary.clear_vertices();
  summary.clear_triangles();
  summary.clear_triangle_faces();
  return summary;
}

std::set<std::string> MissingShapes(const v1::Assembly& assembly,
                                    const google::protobuf::RepeatedPtrField<v1::Item>& items,
                                    const google::protobuf::RepeatedPtrField<v1::Shape>& shapes) {
  std::set<std::string> names;
  for (const v1::AssemblyPart& part : assembly.parts()) names.insert(part.shape());
  for (const v1::Item& item : items) names.insert(item.shape());
  names.erase("");
  for (const v1::Shape& shape : shapes) names.erase(shape.name());
  return names;
}

absl::Status AddShapes(store::ReadTransaction& transaction, const v1::Assembly& assembly,
                       const google::protobuf::RepeatedPtrField<v1::Item>& items,
                       google::protobuf::RepeatedPtrField<v1::Shape>& shapes) {
  for (const std::string& name : MissingShapes(assembly, items, shapes)) {
    absl::StatusOr<v1::Shape> shape = GetShape(transaction, name);
    // What is not there is told with everything else that is wrong.
    if (absl::IsNotFound(shape.status()) || absl::IsInvalidArgument(shape.status())) continue;
    MORTISE_RETURN_IF_ERROR(shape.status());
    *shapes.Add() = *std::move(shape);
  }
  return absl::OkStatus();
}

void DropExact(google::protobuf::RepeatedPtrField<v1::Shape>& shapes) {
  for (v1::Shape& shape : shapes) shape.clear_brep();
}

void NameWhatDoesNotFit(v1::TemplateBundle& bundle) {
  google::protobuf::RepeatedPtrField<v1::Shape> fitting;
  std::size_t bytes = 0;
  for (v1::Shape& shape : *bundle.mutable_shapes()) {
    const std::size_t more = shape.ByteSizeLong();
    if (bytes + more > kMaxInMessage) {
      bundle.add_more_shapes(shape.name());
      continue;
    }
    bytes += more;
    *fitting.Add() = std::move(shape);
  }
  *bundle.mutable_shapes() = std::move(fitting);
}

absl::Status CheckShapesTogether(const google::protobuf::RepeatedPtrField<v1::Shape>& shapes) {
  std::size_t bytes = 0;
  for (const v1::Shape& shape : shapes) bytes += shape.ByteSizeLong() - shape.brep().size();
  if (bytes <= kMaxTogether) return absl::OkStatus();
  return InvalidField(
      "parts", absl::StrCat("the triangles of all ", shapes.size(), " shapes together take ", bytes,
                            " bytes, more than ", kMaxTogether));
}

absl::StatusOr<std::vector<FieldViolation>> CheckItemShape(store::ReadTransaction& transaction,
                                                           const v1::Item& item) {
  using Findings = std::vector<FieldViolation>;
  if (item.shape().empty()) return Findings();
  const absl::StatusOr<v1::Shape> shape = GetShape(transaction, item.shape());
  if (absl::IsNotFound(shape.status()) || absl::IsInvalidArgument(shape.status())) {
    return Findings{parametric::MissingShape(item)};
  }
  MORTISE_RETURN_IF_ERROR(shape.status());
  return parametric::CheckShapeOfItem(item, *shape);
}

}  // namespace mortise::catalog
