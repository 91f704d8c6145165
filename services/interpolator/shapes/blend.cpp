#include "services/interpolator/shapes/blend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/interpolator/shapes/blend_kernel.h"

namespace mortise::interpolator {
namespace {

// Numbers of one shape, and what they stand for: origin + step · number.
struct Source {
  const std::uint16_t* numbers = nullptr;
  std::array<double, 3> origin{}, step{};
};

Source PositionsOf(const PackedShape& shape) {
  Source source;
  source.numbers = shape.positions.data();
  for (int axis = 0; axis < 3; ++axis) {
    source.origin[static_cast<std::size_t>(axis)] = shape.origin[axis];
    source.step[static_cast<std::size_t>(axis)] = shape.step[axis];
  }
  return source;
}

Source FieldOf(const PackedShape& shape, int number) {
  const PackedField& field = shape.fields[static_cast<std::size_t>(number)];
  Source source;
  source.numbers = field.numbers.data();
  source.origin.fill(field.minimum);
  source.step.fill(field.step);
  return source;
}

// Adds up what `source_of` takes of each shape.
template <typename SourceOf>
void BlendNumbers(std::span<const WeightedShape> shapes, const SourceOf& source_of,
                  std::span<float> out) {
  std::array<double, 3> origin{};
  for (const auto& [shape, weight] : shapes) {
    const Source source = source_of(*shape);
    for (std::size_t axis = 0; axis < 3; ++axis) origin[axis] += weight * source.origin[axis];
  }
  std::array<float, 3> offset{};
  for (std::size_t axis = 0; axis < 3; ++axis) offset[axis] = static_cast<float>(origin[axis]);
  std::array<BlendStream, kMostStreams> streams;
  std::size_t count = 0;
  bool is_continued = false;
  for (const auto& [shape, weight] : shapes) {
    if (weight == 0) continue;
    const Source source = source_of(*shape);
    BlendStream& stream = streams[count++];
    stream.numbers = source.numbers;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      stream.scale[axis] = static_cast<float>(weight * source.step[axis]);
    }
    if (count < kMostStreams) continue;
    BlendStreams(std::span(streams).first(count), offset, is_continued, out);
    is_continued = true;
    count = 0;
  }
  if (count > 0) BlendStreams(std::span(streams).first(count), offset, is_continued, out);
  if (count == 0 && !is_continued) std::fill(out.begin(), out.end(), 0.0f);
}

absl::Status CheckShapes(std::span<const WeightedShape> shapes, const CanonicalMesh& mesh) {
  if (shapes.empty()) return InvalidField("shapes", "must be at least one");
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const std::string field = absl::StrCat("shapes[", i, "]");
    if (!std::isfinite(shapes[i].weight)) {
      return InvalidField(absl::StrCat(field, ".weight"), "must be finite");
    }
    const absl::Status fits = CheckFits(*shapes[i].shape, mesh);
    if (!fits.ok()) return UnderField(field, fits);
  }
  return absl::OkStatus();
}

absl::Status CheckParts(const BlendedParts& parts, const CanonicalMesh& mesh) {
  for (std::size_t i = 0; i < parts.fields.size(); ++i) {
    const int number = parts.fields[i];
    const std::string field = absl::StrCat("fields[", i, "]");
    if (number < 0 || number >= std::ssize(mesh.fields)) {
      return InvalidField(field, absl::StrCat("is none of the ", mesh.fields.size()));
    }
    const fields::FieldPlace place = mesh.fields[static_cast<std::size_t>(number)].place;
    if (parts.surface_only && place == fields::FieldPlace::kElements) {
      return InvalidField(field, "is of elements, which the surface has not");
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status Blend(std::span<const WeightedShape> shapes, const CanonicalMesh& mesh,
                   const BlendedParts& parts, BlendedShape& out) {
  MORTISE_RETURN_IF_ERROR(CheckShapes(shapes, mesh));
  MORTISE_RETURN_IF_ERROR(CheckParts(parts, mesh));
  const int nodes = parts.surface_only ? mesh.surface_nodes : mesh.node_count();
  out.positions.resize(3 * static_cast<std::size_t>(nodes));
  BlendNumbers(shapes, PositionsOf, out.positions);
  out.field_numbers.assign(parts.fields.begin(), parts.fields.end());
  out.fields.resize(parts.fields.size());
  for (std::size_t i = 0; i < parts.fields.size(); ++i) {
    const int number = parts.fields[i];
    const FieldKind& kind = mesh.fields[static_cast<std::size_t>(number)];
    const int count = kind.place == fields::FieldPlace::kNodes ? nodes : mesh.element_count();
    out.fields[i].resize(static_cast<std::size_t>(count) *
                         static_cast<std::size_t>(kind.components));
    BlendNumbers(
        shapes, [number](const PackedShape& shape) { return FieldOf(shape, number); },
        out.fields[i]);
  }
  return absl::OkStatus();
}

}  // namespace mortise::interpolator
