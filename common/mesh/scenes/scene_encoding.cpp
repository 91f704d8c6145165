#include "common/mesh/scenes/scene_encoding.h"

#include <cstdint>
#include <cstring>
#include <type_traits>

#include "absl/status/status.h"

namespace mortise::mesh {
namespace {

// ---- Writing ------------------------------------------------------------------------------------

template <typename Value>
void Put(const Value* values, std::size_t count, std::string& bytes) {
  static_assert(std::is_trivially_copyable_v<Value>);
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(Value));
}

void PutCount(std::size_t count, std::string& bytes) {
  const auto number = static_cast<std::uint32_t>(count);
  Put(&number, 1, bytes);
}

void PutText(const std::string& text, std::string& bytes) {
  PutCount(text.size(), bytes);
  bytes += text;
}

std::size_t SizeOf(const Scene& scene) {
  std::size_t size = 64;
  for (const std::string& note : scene.notes) size += sizeof(std::uint32_t) + note.size();
  for (const SceneComponent& component : scene.components) {
    size += 3 * sizeof(std::uint32_t) + component.name.size() +
            sizeof(double) * static_cast<std::size_t>(component.vertices.size()) +
            sizeof(int) * static_cast<std::size_t>(component.triangles.size());
  }
  return size;
}

// ---- Reading ------------------------------------------------------------------------------------

// Takes values off the front of bytes; after the first that is not there, all is wrong.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}

  template <typename Value>
  void Take(Value* values, std::size_t count) {
    if (!Has(count, sizeof(Value))) return;
    std::memcpy(values, rest_.data(), count * sizeof(Value));
    rest_.remove_prefix(count * sizeof(Value));
  }

  // The number of things that follow, each of `size` bytes or more.
  std::uint32_t TakeCount(std::size_t size) {
    std::uint32_t count = 0;
    Take(&count, 1);
    return Has(count, size) ? count : 0;
  }

  std::string TakeText() {
    std::string text(TakeCount(1), '\0');
    Take(text.data(), text.size());
    return text;
  }

  bool IsDone() const { return is_right_ && rest_.empty(); }

 private:
  bool Has(std::size_t count, std::size_t size) {
    is_right_ = is_right_ && count <= rest_.size() / size;
    return is_right_;
  }

  std::string_view rest_;
  bool is_right_ = true;
};

SceneComponent TakeComponent(Reader& reader) {
  SceneComponent component;
  component.name = reader.TakeText();
  component.vertices.resize(3, reader.TakeCount(3 * sizeof(double)));
  reader.Take(component.vertices.data(), static_cast<std::size_t>(component.vertices.size()));
  component.triangles.resize(3, reader.TakeCount(3 * sizeof(int)));
  reader.Take(component.triangles.data(), static_cast<std::size_t>(component.triangles.size()));
  return component;
}

bool IsSound(const SceneComponent& component) {
  if (component.triangles.size() == 0) return false;
  return component.triangles.minCoeff() >= 0 &&
         component.triangles.maxCoeff() < component.vertices.cols() &&
         component.vertices.allFinite();
}

}  // namespace

std::string EncodeScene(const Scene& scene) {
  std::string bytes;
  bytes.reserve(SizeOf(scene));
  const double unit = scene.unit.value_or(0);
  Put(&unit, 1, bytes);
  PutCount(static_cast<std::size_t>(scene.up), bytes);
  PutCount(scene.notes.size(), bytes);
  for (const std::string& note : scene.notes) PutText(note, bytes);
  PutCount(scene.components.size(), bytes);
  for (const SceneComponent& component : scene.components) {
    PutText(component.name, bytes);
    PutCount(static_cast<std::size_t>(component.vertices.cols()), bytes);
    Put(component.vertices.data(), static_cast<std::size_t>(component.vertices.size()), bytes);
    PutCount(static_cast<std::size_t>(component.triangles.cols()), bytes);
    Put(component.triangles.data(), static_cast<std::size_t>(component.triangles.size()), bytes);
  }
  return bytes;
}

absl::StatusOr<Scene> DecodeScene(std::string_view bytes) {
  Reader reader(bytes);
  Scene scene;
  double unit = 0;
  std::uint32_t up = 0;
  reader.Take(&unit, 1);
  reader.Take(&up, 1);
  if (unit > 0) scene.unit = unit;
  scene.up = static_cast<UpAxis>(up);
  scene.notes.resize(reader.TakeCount(sizeof(std::uint32_t)));
  for (std::string& note : scene.notes) note = reader.TakeText();
  scene.components.resize(reader.TakeCount(3 * sizeof(std::uint32_t)));
  bool is_sound = up <= static_cast<std::uint32_t>(UpAxis::kZ);
  for (SceneComponent& component : scene.components) {
    component = TakeComponent(reader);
    is_sound = is_sound && IsSound(component);
  }
  if (!is_sound || !reader.IsDone()) {
    return absl::InternalError("reading a mesh: what the reading process says is no scene");
  }
  return scene;
}

}  // namespace mortise::mesh
