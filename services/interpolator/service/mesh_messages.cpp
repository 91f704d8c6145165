#include "services/interpolator/service/mesh_messages.h"

#include <algorithm>
#include <bit>
#include <string>
#include <utility>

namespace mortise::interpolator {
namespace {

// Numbers are copied as they lie in memory.
static_assert(std::endian::native == std::endian::little);

// What a message within another takes beside itself, bytes.
constexpr std::size_t kOverhead = 16;

template <typename Number>
std::string BytesOf(const Number* numbers, std::size_t count) {
  static_assert(sizeof(Number) == 4);
  return {reinterpret_cast<const char*>(numbers), count * sizeof(Number)};
}

template <typename Matrix>
std::string BytesOf(const Matrix& matrix) {
  return BytesOf(matrix.data(), static_cast<std::size_t>(matrix.size()));
}

// Takes up to `room` bytes of `from`, whole numbers, beginning at `at`.
void Take(const std::string& from, std::size_t& at, std::size_t& room, std::string& to) {
  const std::size_t count = std::min(from.size() - at, room / 4 * 4);
  to.append(from, at, count);
  at += count;
  room -= count;
}

}  // namespace

std::vector<v1::MapMesh> MeshMessages(const CanonicalMesh& canonical, int structure, int mesh,
                                      v1::GeometryKind geometry, std::size_t most) {
  const bool with_elements = geometry == v1::TETRAHEDRA;
  const std::string triangles = BytesOf(canonical.triangles);
  const std::string tetrahedra = with_elements ? BytesOf(canonical.tetrahedra) : std::string();
  const std::string parts = BytesOf(canonical.triangle_part) +
                            (with_elements ? BytesOf(canonical.tetrahedron_part) : std::string());
  std::vector<v1::MapMesh> messages;
  std::size_t of_triangles = 0, of_tetrahedra = 0, of_parts = 0, room = 0;
  const auto begin = [&]() -> v1::MapMesh& {
    v1::MapMesh& message = messages.emplace_back();
    message.set_structure(structure);
    message.set_mesh(mesh);
    message.set_nodes(with_elements ? canonical.node_count() : canonical.surface_nodes);
    message.set_more(true);
    room = std::max<std::size_t>(most, 4);
    return message;
  };
  do {
    v1::MapMesh& message = begin();
    Take(triangles, of_triangles, room, *message.mutable_triangles());
    Take(tetrahedra, of_tetrahedra, room, *message.mutable_tetrahedra());
    Take(parts, of_parts, room, *message.mutable_parts());
  } while (of_parts < parts.size());
  for (const fields::Region& region : canonical.regions) {
    const std::string of_region = BytesOf(region.triangles.data(), region.triangles.size());
    std::size_t taken = 0;
    do {
      v1::MapMesh& message = room < 4 ? begin() : messages.back();
      v1::MapMesh::Region& to = *message.add_regions();
      to.set_name(region.name);
      Take(of_region, taken, room, *to.mutable_triangles());
      room -= std::min(room, region.name.size());
    } while (taken < of_region.size());
  }
  v1::MapMesh& last = messages.back();
  last.set_more(false);
  last.mutable_part_names()->Add(canonical.parts.begin(), canonical.parts.end());
  return messages;
}

std::vector<v1::MapShape> WithMesh(v1::MapShape shape, std::vector<v1::MapMesh> mesh,
                                   std::size_t most) {
  v1::MapMesh last = std::move(mesh.back());
  mesh.pop_back();
  if (shape.ByteSizeLong() + last.ByteSizeLong() + kOverhead > most) {
    v1::MapMesh& end = *shape.mutable_new_mesh();
    end.set_structure(last.structure());
    end.set_mesh(last.mesh());
    end.set_nodes(last.nodes());
    end.mutable_part_names()->Swap(last.mutable_part_names());
    last.set_more(true);
    mesh.push_back(std::move(last));
  } else {
    *shape.mutable_new_mesh() = std::move(last);
  }
  std::vector<v1::MapShape> messages;
  for (v1::MapMesh& part : mesh) {
    v1::MapShape& ahead = messages.emplace_back();
    ahead.set_sequence(shape.sequence());
    ahead.set_structure(shape.structure());
    ahead.set_mesh(shape.mesh());
    *ahead.mutable_new_mesh() = std::move(part);
  }
  messages.push_back(std::move(shape));
  return messages;
}

void SetShape(const BlendedShape& blended, const CanonicalMesh& canonical, v1::MapShape& shape) {
  shape.set_positions(BytesOf(blended.positions.data(), blended.positions.size()));
  for (std::size_t f = 0; f < blended.fields.size(); ++f) {
    const FieldKind& kind = canonical.fields[static_cast<std::size_t>(blended.field_numbers[f])];
    v1::MapFieldValues& to = *shape.add_fields();
    to.set_name(kind.name);
    to.set_load_case(kind.load_case);
    to.set_values(BytesOf(blended.fields[f].data(), blended.fields[f].size()));
  }
}

}  // namespace mortise::interpolator
