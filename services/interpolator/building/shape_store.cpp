#include "services/interpolator/building/shape_store.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/fields/fields_file.h"
#include "services/interpolator/shapes/shape_file.h"

namespace mortise::interpolator {
namespace {

absl::Status Damaged(const char* what, const std::string& digest, const absl::Status& status) {
  return absl::DataLossError(
      absl::StrCat("the file of a ", what, ", ", digest, ", is damaged: ", status.message()));
}

// What a mesh takes with all that maps into it have ready.
std::size_t BytesOf(const CanonicalMesh& mesh) {
  constexpr std::size_t kPerNode = 2000;  // with the factors of its equations
  return static_cast<std::size_t>(mesh.node_count()) * kPerNode;
}

}  // namespace

ShapeStore::ShapeStore(const ShapeOptions& options)
    : options_(options),
      designs_(options.memory / 4),
      meshes_(options.memory / 4, Oversize::kAlone),
      shapes_(options.memory / 2) {}

absl::StatusOr<std::shared_ptr<const fields::DesignFields>> ShapeStore::Design(
    const std::string& digest) {
  using Made = decltype(designs_)::Made;
  return designs_.Get(digest, [&]() -> absl::StatusOr<Made> {
    MORTISE_ASSIGN_OR_RETURN(const std::string bytes, options_.get(digest));
    absl::StatusOr<fields::DesignFields> read = fields::ReadFields(bytes);
    if (!read.ok()) {
      return WithDetail(absl::InvalidArgumentError(
                            absl::StrCat("the file of its shape: ", read.status().message())),
                        {"SHAPE_UNREADABLE", DetailOf(read.status()).field});
    }
    // Numbers take up to twice the memory that they take in the file.
    return Made{std::make_shared<const fields::DesignFields>(*std::move(read)), 2 * bytes.size()};
  });
}

absl::StatusOr<std::shared_ptr<const ReadyMesh>> ShapeStore::Mesh(const std::string& digest) {
  using Made = decltype(meshes_)::Made;
  return meshes_.Get(digest, [&]() -> absl::StatusOr<Made> {
    MORTISE_ASSIGN_OR_RETURN(const std::string bytes, options_.get(digest));
    absl::StatusOr<CanonicalMesh> read = ReadMesh(bytes);
    if (!read.ok()) return Damaged("canonical mesh", digest, read.status());
    const auto mesh = std::make_shared<const CanonicalMesh>(*std::move(read));
    return Made{std::make_shared<const ReadyMesh>(mesh, options_.mapping), BytesOf(*mesh)};
  });
}

absl::StatusOr<std::shared_ptr<const PackedShape>> ShapeStore::Shape(const std::string& digest,
                                                                     const CanonicalMesh& mesh) {
  using Made = decltype(shapes_)::Made;
  return shapes_.Get(digest, [&]() -> absl::StatusOr<Made> {
    MORTISE_ASSIGN_OR_RETURN(const std::string bytes, options_.get(digest));
    absl::StatusOr<PackedShape> read = ReadShape(bytes, mesh);
    if (!read.ok()) return Damaged("shape", digest, read.status());
    const auto shape = std::make_shared<const PackedShape>(*std::move(read));
    return Made{shape, static_cast<std::size_t>(shape->ByteSize())};
  });
}

}  // namespace mortise::interpolator
