#include "common/files/collection_shapes.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/files/shape_name.h"

namespace mortise::parametric {
namespace {

// As the catalog keeps it: triangulated and checked, so that it starts without the CAD kernel. Its
// name is the digest of the rest, since the kernel may crash over surfaces that are damaged.
absl::StatusOr<v1::Shape> ReadShape(const std::filesystem::path& path) {
  constexpr std::size_t kMaxBytes = 16 << 20;
  const absl::StatusOr<std::string> bytes = ReadFile(path, kMaxBytes);
  if (!bytes.ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat("'", path.string(), "' cannot be read: ", bytes.status().message()));
  }
  v1::Shape shape;
  if (!shape.ParseFromString(*bytes) || NameOf(shape) != shape.name()) {
    return absl::InvalidArgumentError(absl::StrCat("'", path.string(), "' is damaged"));
  }
  return shape;
}

}  // namespace

absl::Status CollectionShapes::Resolve(const std::filesystem::path& file, std::string& shape) {
  if (shape.empty() || shape.starts_with("shapes/")) return absl::OkStatus();
  std::filesystem::path path = (file.parent_path() / shape).lexically_normal();
  path.replace_extension(".shape");
  std::string& name = names_[path];
  if (name.empty()) {
    MORTISE_ASSIGN_OR_RETURN(v1::Shape read, ReadShape(path));
    name = read.name();
    shapes_.emplace(name, std::move(read));
  }
  shape = name;
  return absl::OkStatus();
}

std::vector<v1::Shape> CollectionShapes::Take() {
  std::vector<v1::Shape> taken;
  for (auto& [name, shape] : shapes_) taken.push_back(std::move(shape));
  shapes_.clear();
  names_.clear();
  return taken;
}

}  // namespace mortise::parametric
