#include "services/interpolator/shapes/shape_file.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/interpolator/shapes/compressed_file.h"

namespace mortise::interpolator {
namespace {

constexpr std::string_view kLetters = "MORTISEP";

using Numbers = std::vector<std::uint16_t>;

std::uint16_t Folded(std::uint16_t residual) {
  const bool is_negative = residual >= 0x8000;
  return static_cast<std::uint16_t>(is_negative ? 2 * (0xffff - residual) + 1 : 2 * residual);
}

std::uint16_t Unfolded(std::uint16_t folded) {
  const auto half = static_cast<std::uint16_t>(folded >> 1);
  return (folded & 1) != 0 ? static_cast<std::uint16_t>(0xffff - half) : half;
}

// What numbers are told against; zeros where there is nothing.
std::uint16_t At(const Numbers& reference, std::size_t i) {
  return reference.empty() ? std::uint16_t{0} : reference[i];
}

// Calls `visit` with the index of each number, component by component, and of its place among all.
template <typename Visit>
void ByComponent(std::size_t count, int components, const Visit& visit) {
  const auto stride = static_cast<std::size_t>(components);
  std::size_t place = 0;
  for (std::size_t component = 0; component < stride; ++component) {
    for (std::size_t i = component; i < count; i += stride) visit(i, place++);
  }
}

void AppendNumbers(const Numbers& numbers, const Numbers& reference, int components,
                   std::string& content) {
  const std::size_t begin = content.size();
  content.resize(begin + 2 * numbers.size());
  const auto stride = static_cast<std::size_t>(components);
  ByComponent(numbers.size(), components, [&](std::size_t i, std::size_t place) {
    std::uint16_t residual = numbers[i] - At(reference, i);
    if (i >= stride) residual -= numbers[i - stride] - At(reference, i - stride);
    const std::uint16_t folded = Folded(residual);
    content[begin + place] = static_cast<char>(folded & 0xff);
    content[begin + numbers.size() + place] = static_cast<char>(folded >> 8);
  });
}

Numbers TakeNumbers(std::string_view bytes, const Numbers& reference, int components) {
  Numbers numbers(bytes.size() / 2);
  const auto stride = static_cast<std::size_t>(components);
  ByComponent(numbers.size(), components, [&](std::size_t i, std::size_t place) {
    const auto low = static_cast<std::uint8_t>(bytes[place]);
    const auto high = static_cast<std::uint8_t>(bytes[numbers.size() + place]);
    std::uint16_t number = Unfolded(static_cast<std::uint16_t>(low | high << 8));
    number += At(reference, i);
    if (i >= stride) number += numbers[i - stride] - At(reference, i - stride);
    numbers[i] = number;
  });
  return numbers;
}

template <typename Number>
void Append(const Number* numbers, std::size_t count, std::string& content) {
  content.append(reinterpret_cast<const char*>(numbers), count * sizeof(Number));
}

// Takes what the file has from its beginning.
class Taking {
 public:
  explicit Taking(std::string_view bytes) : rest_(bytes) {}

  void Take(double* numbers, std::size_t count) {
    const std::string_view bytes = Bytes(count * sizeof(double));
    std::memcpy(numbers, bytes.data(), bytes.size());
  }

  std::string_view Bytes(std::size_t count) {
    const std::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return taken;
  }

 private:
  std::string_view rest_;
};

std::size_t NumbersOf(const FieldKind& kind, const CanonicalMesh& mesh) {
  return static_cast<std::size_t>(kind.components) *
         static_cast<std::size_t>(mesh.ValueCount(kind));
}

std::size_t ContentSize(const CanonicalMesh& mesh) {
  std::size_t size = 6 * sizeof(double) + 2 * static_cast<std::size_t>(mesh.nodes.size());
  for (const FieldKind& kind : mesh.fields) size += 2 * sizeof(double) + 2 * NumbersOf(kind, mesh);
  return size;
}

// Returns the numbers that the canonical mesh's own nodes are packed to.
absl::StatusOr<Numbers> ReferenceOf(const CanonicalMesh& mesh) {
  ConsistentShape own{mesh.nodes, {}};
  for (const FieldKind& kind : mesh.fields) {
    own.fields.push_back(Eigen::MatrixXd::Zero(kind.components, mesh.ValueCount(kind)));
  }
  MORTISE_ASSIGN_OR_RETURN(PackedShape packed, Pack(own, mesh));
  return std::move(packed.positions);
}

absl::Status CheckOrigins(const PackedShape& shape) {
  bool is_good = shape.origin.allFinite() && shape.step.allFinite();
  for (const PackedField& field : shape.fields) {
    is_good = is_good && std::isfinite(field.minimum) && std::isfinite(field.step);
  }
  return is_good ? absl::OkStatus() : InvalidField("shape", "has numbers that are not finite");
}

}  // namespace

absl::StatusOr<std::string> WriteShape(const PackedShape& shape, const CanonicalMesh& mesh) {
  MORTISE_RETURN_IF_ERROR(CheckFits(shape, mesh));
  MORTISE_RETURN_IF_ERROR(CheckOrigins(shape));
  MORTISE_ASSIGN_OR_RETURN(const Numbers reference, ReferenceOf(mesh));
  std::string content;
  content.reserve(ContentSize(mesh));
  Append(shape.origin.data(), 3, content);
  Append(shape.step.data(), 3, content);
  for (const PackedField& field : shape.fields) {
    Append(&field.minimum, 1, content);
    Append(&field.step, 1, content);
  }
  AppendNumbers(shape.positions, reference, 3, content);
  for (const PackedField& field : shape.fields) {
    AppendNumbers(field.numbers, {}, field.components, content);
  }
  return Compress(kLetters, content);
}

absl::StatusOr<PackedShape> ReadShape(std::string_view bytes, const CanonicalMesh& mesh) {
  const std::size_t size = ContentSize(mesh);
  const auto limit = static_cast<std::int64_t>(size);
  auto expanded = Expand(kLetters, bytes, limit, "shape");
  if (!expanded.ok() && !absl::IsResourceExhausted(expanded.status())) return expanded.status();
  if (!expanded.ok() || expanded->size() != size) {
    return InvalidField("shape", "is of another mesh");
  }
  const std::string content = *std::move(expanded);
  MORTISE_ASSIGN_OR_RETURN(const Numbers reference, ReferenceOf(mesh));
  Taking rest(content);
  PackedShape shape;
  rest.Take(shape.origin.data(), 3);
  rest.Take(shape.step.data(), 3);
  shape.fields.resize(mesh.fields.size());
  for (PackedField& field : shape.fields) {
    rest.Take(&field.minimum, 1);
    rest.Take(&field.step, 1);
  }
  MORTISE_RETURN_IF_ERROR(CheckOrigins(shape));
  shape.positions = TakeNumbers(rest.Bytes(2 * reference.size()), reference, 3);
  for (std::size_t f = 0; f < shape.fields.size(); ++f) {
    const FieldKind& kind = mesh.fields[f];
    shape.fields[f].components = kind.components;
    shape.fields[f].numbers =
        TakeNumbers(rest.Bytes(2 * NumbersOf(kind, mesh)), {}, kind.components);
  }
  return shape;
}

}  // namespace mortise::interpolator
