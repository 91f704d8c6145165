#include "services/interpolator/records/loaded_shapes.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/interpolator/shapes/shape_file.h"

namespace mortise::interpolator {
namespace {

absl::Status Damaged(const std::string& file, const absl::Status& why) {
  return WithDetail(
      absl::DataLossError(absl::StrCat("a file of the map cannot be used (", file, ": ",
                                       why.message(), "); building the map again mends it")),
      {"MAP_DAMAGED", file});
}

template <typename Derived>
std::size_t BytesOf(const Eigen::MatrixBase<Derived>& matrix) {
  return static_cast<std::size_t>(matrix.size()) * sizeof(typename Derived::Scalar);
}

std::size_t BytesOf(const std::vector<fields::Region>& regions) {
  std::size_t bytes = 0;
  for (const fields::Region& region : regions) bytes += sizeof(int) * region.triangles.size();
  return bytes;
}

std::size_t BytesOf(const fields::DesignFields& design) {
  std::size_t bytes =
      BytesOf(design.nodes) + BytesOf(design.tetrahedra) + BytesOf(design.tetrahedron_part) +
      BytesOf(design.triangles) + BytesOf(design.triangle_back) + BytesOf(design.triangle_front) +
      BytesOf(design.regions) + sizeof(fields::ControlPoint) * design.control_points.size();
  for (const fields::Path& path : design.paths) {
    bytes += sizeof(path) + sizeof(int) * path.nodes.size();
  }
  for (const fields::ControlWay& way : design.ways) bytes += sizeof(way) + BytesOf(way.positions);
  for (const fields::Field& field : design.fields) bytes += BytesOf(field.values);
  return bytes;
}

// With what it was made of.
std::size_t BytesOf(const CanonicalMesh& mesh) {
  std::size_t bytes = BytesOf(mesh.nodes) + BytesOf(mesh.tetrahedra) +
                      BytesOf(mesh.tetrahedron_part) + BytesOf(mesh.triangles) +
                      BytesOf(mesh.triangle_part) + BytesOf(mesh.inner_triangles) +
                      BytesOf(mesh.inner_back) + BytesOf(mesh.inner_front) + BytesOf(mesh.regions) +
                      sizeof(int) * mesh.given_node.size() + BytesOf(mesh.given);
  for (const Eigen::MatrixXd& values : mesh.own_values) bytes += BytesOf(values);
  return bytes;
}

}  // namespace

LoadedShapes::LoadedShapes(store::BlobFolder* blobs, std::size_t capacity)
    : blobs_(blobs), kept_(capacity, Oversize::kAlone) {}

absl::StatusOr<std::shared_ptr<const CanonicalMesh>> LoadedShapes::Mesh(const std::string& file) {
  MORTISE_ASSIGN_OR_RETURN(const Loaded loaded, kept_.Get(file, [&] { return LoadMesh(file); }));
  return loaded.mesh;
}

absl::StatusOr<std::shared_ptr<const PackedShape>> LoadedShapes::Shape(const std::string& mesh,
                                                                       const std::string& file) {
  MORTISE_ASSIGN_OR_RETURN(const Loaded loaded, kept_.Get(absl::StrCat(mesh, "/", file),
                                                          [&] { return LoadShape(mesh, file); }));
  return loaded.shape;
}

absl::StatusOr<std::string> LoadedShapes::Read(const std::string& file) const {
  absl::StatusOr<std::string> bytes = blobs_->Get(file);
  if (absl::IsNotFound(bytes.status()) || absl::IsDataLoss(bytes.status())) {
    return Damaged(file, bytes.status());
  }
  return bytes;
}

absl::StatusOr<LoadedShapes::Kept::Made> LoadedShapes::LoadMesh(const std::string& file) const {
  MORTISE_ASSIGN_OR_RETURN(const std::string bytes, Read(file));
  absl::StatusOr<CanonicalMesh> mesh = ReadMesh(bytes);
  if (!mesh.ok()) return Damaged(file, mesh.status());
  const std::size_t size = BytesOf(*mesh);
  return Kept::Made{{std::make_shared<const CanonicalMesh>(*std::move(mesh)), nullptr}, size};
}

absl::StatusOr<LoadedShapes::Kept::Made> LoadedShapes::LoadShape(const std::string& mesh,
                                                                 const std::string& file) {
  MORTISE_ASSIGN_OR_RETURN(const std::shared_ptr<const CanonicalMesh> canonical, Mesh(mesh));
  MORTISE_ASSIGN_OR_RETURN(const std::string bytes, Read(file));
  absl::StatusOr<PackedShape> shape = ReadShape(bytes, *canonical);
  if (!shape.ok()) return Damaged(file, shape.status());
  const auto size = static_cast<std::size_t>(shape->ByteSize());
  return Kept::Made{{nullptr, std::make_shared<const PackedShape>(*std::move(shape))}, size};
}

}  // namespace mortise::interpolator
