#include "services/interpolator/records/kept_shapes.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "services/interpolator/records/kept_records.h"
#include "stored_map.pb.h"

namespace mortise::interpolator {
namespace {

constexpr char kShapeKind[] = "mapShapes";

void Write(const Spread& spread, stored::Spread& to) {
  to.set_largest(spread.largest);
  to.set_of_99(spread.of_99);
  to.set_mean(spread.mean);
}

Spread Read(const stored::Spread& spread) {
  return {spread.largest(), spread.of_99(), spread.mean()};
}

void Write(const MeshKey& key, const KnownMesh& mesh, stored::KnownMesh& to) {
  to.set_structure(key.structure);
  to.set_mesh(key.mesh);
  to.set_number(mesh.number);
  if (!mesh.status.ok()) *to.mutable_error() = rpc::ToProto(mesh.status);
  to.set_file(mesh.digest);
  to.set_bytes(mesh.bytes);
}

void Read(const stored::KnownMesh& mesh, KnownShapes& known) {
  KnownMesh& to = known.meshes[{mesh.structure(), mesh.mesh()}];
  to.number = mesh.number();
  if (mesh.has_error()) to.status = rpc::FromProto(mesh.error());
  to.digest = mesh.file();
  to.bytes = mesh.bytes();
}

void Write(const ShapeKey& key, const KnownShape& shape, stored::KnownShape& to) {
  to.set_structure(key.mesh.structure);
  to.set_mesh(key.mesh.mesh);
  to.set_number(key.number);
  if (!shape.status.ok()) *to.mutable_error() = rpc::ToProto(shape.status);
  to.set_file(shape.digest);
  to.set_bytes(shape.bytes);
  to.set_inverted(shape.inverted);
  to.set_size(shape.size);
  to.set_rounding(shape.rounding);
  for (const FieldRange& range : shape.ranges) {
    to.add_ranges(range.minimum);
    to.add_ranges(range.maximum);
  }
  to.mutable_traits()->Add(shape.traits.begin(), shape.traits.end());
}

absl::Status Read(const stored::KnownShape& shape, KnownShapes& known) {
  if (shape.ranges_size() % 2 != 0) return absl::DataLossError("a range has no end");
  KnownShape& to = known.shapes[{{shape.structure(), shape.mesh()}, shape.number()}];
  if (shape.has_error()) to.status = rpc::FromProto(shape.error());
  to.digest = shape.file();
  to.bytes = shape.bytes();
  to.inverted = shape.inverted();
  to.size = shape.size();
  to.rounding = shape.rounding();
  for (int i = 0; i < shape.ranges_size(); i += 2) {
    to.ranges.push_back({shape.ranges(i), shape.ranges(i + 1)});
  }
  to.traits.assign(shape.traits().begin(), shape.traits().end());
  return absl::OkStatus();
}

void Write(const DifferenceKey& key, const KnownDifference& difference,
           stored::KnownDifference& to) {
  to.set_structure(key.shape.mesh.structure);
  to.set_mesh(key.shape.mesh.mesh);
  to.set_number(key.shape.number);
  to.set_weights(key.weights);
  to.set_size(difference.size);
  Write(difference.shape, *to.mutable_shape());
  for (const Spread& field : difference.fields) Write(field, *to.add_fields());
}

void Read(const stored::KnownDifference& difference, KnownShapes& known) {
  KnownDifference& to = known.differences[{
      {{difference.structure(), difference.mesh()}, difference.number()}, difference.weights()}];
  to.size = difference.size();
  to.shape = Read(difference.shape());
  for (const stored::Spread& field : difference.fields()) to.fields.push_back(Read(field));
}

absl::Status Read(const store::Record& record, KnownShapes& known) {
  const absl::Status unreadable =
      absl::DataLossError(absl::StrCat("shapes of ", record.key, " cannot be read"));
  stored::KnownShapes shapes;
  if (!shapes.ParseFromString(record.payload)) return unreadable;
  for (const stored::KnownMesh& mesh : shapes.meshes()) Read(mesh, known);
  for (const stored::KnownShape& shape : shapes.shapes()) {
    if (!Read(shape, known).ok()) return unreadable;
  }
  for (const stored::KnownDifference& difference : shapes.differences()) Read(difference, known);
  return absl::OkStatus();
}

// A key that no other record of the build has: of the first thing that is in it.
std::string KeyOf(const KnownShapes& known) {
  if (!known.meshes.empty()) {
    const MeshKey& key = known.meshes.begin()->first;
    return absl::StrFormat("mesh/%d/%d", key.structure, key.mesh);
  }
  if (!known.shapes.empty()) {
    const ShapeKey& key = known.shapes.begin()->first;
    return absl::StrFormat("shape/%d/%d/%d", key.mesh.structure, key.mesh.mesh, key.number);
  }
  const DifferenceKey& key = known.differences.begin()->first;
  return absl::StrFormat("difference/%d/%d/%d/%016x", key.shape.mesh.structure, key.shape.mesh.mesh,
                         key.shape.number, key.weights);
}

}  // namespace

absl::StatusOr<KnownShapes> LoadShapes(store::Store& store, const std::string& id) {
  KnownShapes known;
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& transaction) {
    known = {};
    return VisitKept(transaction, kShapeKind, KeptPrefix(id), /*with_payloads=*/true,
                     [&](const store::Record& record) { return Read(record, known); });
  }));
  return known;
}

absl::Status PutShapes(store::Transaction& transaction, const std::string& id,
                       const KnownShapes& known) {
  if (known.empty()) return absl::OkStatus();
  stored::KnownShapes shapes;
  for (const auto& [key, mesh] : known.meshes) Write(key, mesh, *shapes.add_meshes());
  for (const auto& [key, shape] : known.shapes) Write(key, shape, *shapes.add_shapes());
  for (const auto& [key, difference] : known.differences) {
    Write(key, difference, *shapes.add_differences());
  }
  return transaction
      .Put(kShapeKind, absl::StrCat(KeptPrefix(id), KeyOf(known)), shapes.SerializeAsString())
      .status();
}

absl::Status DropShapes(store::Transaction& transaction, const std::string& id) {
  return DropKept(transaction, kShapeKind, id);
}

}  // namespace mortise::interpolator
