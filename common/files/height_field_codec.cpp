#include "common/files/height_field_codec.h"

#include <cmath>
#include <memory>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/messages/message_digest.h"
#include "common/terrain/height_field.h"

namespace mortise::parametric {
namespace {

using terrain::HeightField;
using Heights = std::shared_ptr<const HeightField>;

constexpr int kMaxColumns = 10'000;
constexpr std::size_t kMostNumbersTold = 20;

absl::StatusOr<Heights> GridFrom(const v1::HeightGrid& message, double datum) {
  const int columns = message.columns();
  if (columns < 2 || columns > kMaxColumns) {
    return InvalidField("columns", absl::StrCat("must be 2 to ", kMaxColumns));
  }
  if (message.heights_size() % columns != 0) {
    return InvalidField("heights", absl::StrCat("are ", message.heights_size(),
                                                ", which are no whole rows of ", columns));
  }
  terrain::HeightGrid grid;
  grid.origin = {message.x(), message.y()};
  grid.spacing = {message.x_spacing(), message.y_spacing()};
  grid.heights = Eigen::Map<const Eigen::MatrixXd>(message.heights().data(), columns,
                                                   message.heights_size() / columns);
  grid.heights.array() -= datum;
  return HeightField::Create(std::move(grid));
}

absl::Status CheckTriples(const char* field, int count) {
  if (count % 3 == 0) return absl::OkStatus();
  return InvalidField(field, absl::StrCat("are ", count, " numbers, where each has three"));
}

absl::StatusOr<Heights> TrianglesFrom(const v1::HeightTriangles& message, double datum) {
  MORTISE_RETURN_IF_ERROR(CombineViolations(CheckTriples("vertices", message.vertices_size()),
                                            CheckTriples("triangles", message.triangles_size())));
  terrain::HeightTriangles triangles;
  triangles.vertices =
      Eigen::Map<const Eigen::Matrix3Xd>(message.vertices().data(), 3, message.vertices_size() / 3);
  triangles.vertices.row(2).array() -= datum;
  triangles.triangles = Eigen::Map<const Eigen::Matrix3Xi>(message.triangles().data(), 3,
                                                           message.triangles_size() / 3);
  return HeightField::Create(std::move(triangles));
}

// Numbers are told before all else that is wrong; heights of a grid may be none where nothing is
// known.
absl::Status CheckNumbers(const v1::HeightField& message) {
  std::vector<FieldViolation> violations;
  const auto check = [&violations](const std::string& field, bool is_usable) {
    if (is_usable || violations.size() == kMostNumbersTold) return;
    violations.push_back({field, "must be a finite number"});
  };
  const v1::HeightGrid& grid = message.grid();
  check("datum", std::isfinite(message.datum()));
  check("grid.x", std::isfinite(grid.x()));
  check("grid.y", std::isfinite(grid.y()));
  check("grid.x_spacing", std::isfinite(grid.x_spacing()));
  check("grid.y_spacing", std::isfinite(grid.y_spacing()));
  for (int i = 0; i < grid.heights_size(); ++i) {
    if (std::isinf(grid.heights(i))) check(absl::StrCat("grid.heights[", i, "]"), false);
  }
  const v1::HeightTriangles& triangles = message.triangles();
  for (int i = 0; i < triangles.vertices_size(); ++i) {
    if (!std::isfinite(triangles.vertices(i))) {
      check(absl::StrCat("triangles.vertices[", i, "]"), false);
    }
  }
  return violations.empty() ? absl::OkStatus() : InvalidFields(violations);
}

absl::StatusOr<Heights> HeightsFrom(const v1::HeightField& message) {
  MORTISE_RETURN_IF_ERROR(CheckNumbers(message));
  if (!(std::abs(message.datum()) <= HeightField::kMaxFromOrigin)) {
    return InvalidField("datum",
                        absl::StrCat("must be within ", HeightField::kMaxFromOrigin, " m"));
  }
  switch (message.heights_case()) {
    case v1::HeightField::kGrid: {
      absl::StatusOr<Heights> grid = GridFrom(message.grid(), message.datum());
      if (!grid.ok()) return UnderField("grid", grid.status());
      return grid;
    }
    case v1::HeightField::kTriangles: {
      absl::StatusOr<Heights> triangles = TrianglesFrom(message.triangles(), message.datum());
      if (!triangles.ok()) return UnderField("triangles", triangles.status());
      return triangles;
    }
    case v1::HeightField::HEIGHTS_NOT_SET:
      break;
  }
  return InvalidField("heights", "must be given, as a grid or as triangles");
}

// Stands for what cannot be read.
Heights FlatGround() {
  return HeightField::Create(terrain::HeightGrid{.heights = Eigen::MatrixXd::Zero(2, 2)}).value();
}

std::size_t CountOf(const v1::HeightField& message) {
  return static_cast<std::size_t>(message.grid().heights_size()) +
         static_cast<std::size_t>(message.triangles().vertices_size()) / 3;
}

v1::HeightGrid ToMessage(const terrain::HeightGrid& grid) {
  v1::HeightGrid message;
  message.set_x(grid.origin.x());
  message.set_y(grid.origin.y());
  message.set_x_spacing(grid.spacing.x());
  message.set_y_spacing(grid.spacing.y());
  message.set_columns(static_cast<int>(grid.heights.rows()));
  message.mutable_heights()->Add(grid.heights.data(), grid.heights.data() + grid.heights.size());
  return message;
}

v1::HeightTriangles ToMessage(const terrain::HeightTriangles& triangles) {
  v1::HeightTriangles message;
  const auto& [vertices, indices] = triangles;
  message.mutable_vertices()->Add(vertices.data(), vertices.data() + vertices.size());
  message.mutable_triangles()->Add(indices.data(), indices.data() + indices.size());
  return message;
}

}  // namespace

std::vector<Ground> ReadGrounds(const google::protobuf::RepeatedPtrField<v1::HeightField>& messages,
                                std::vector<FieldViolation>& findings) {
  std::size_t count = 0;
  for (const v1::HeightField& message : messages) count += CountOf(message);
  const bool is_too_much = count > HeightField::kMaxHeights;
  if (is_too_much) {
    findings.push_back(
        {"height_fields", absl::StrCat("have ", count, " heights and vertices; at most ",
                                       HeightField::kMaxHeights, " are accepted in all")});
  }
  std::vector<Ground> grounds;
  for (int i = 0; i < messages.size(); ++i) {
    const v1::HeightField& message = messages[i];
    Ground& ground = grounds.emplace_back(Ground{message.name(), message.title(), nullptr});
    if (!is_too_much) {
      absl::StatusOr<Heights> heights = HeightsFrom(message);
      const absl::Status fault =
          UnderField(absl::StrCat("height_fields[", i, "]"), heights.status());
      for (FieldViolation& violation : AllViolationsOf(fault)) {
        findings.push_back(std::move(violation));
      }
      if (heights.ok()) ground.heights = *std::move(heights);
    }
    if (ground.heights == nullptr) ground.heights = FlatGround();
  }
  return grounds;
}

v1::HeightField ToProto(const Ground& ground) {
  v1::HeightField message;
  message.set_name(ground.name);
  message.set_title(ground.title);
  const terrain::GivenHeights given = ground.heights->Given();
  if (const auto* grid = std::get_if<terrain::HeightGrid>(&given)) {
    *message.mutable_grid() = ToMessage(*grid);
  } else {
    *message.mutable_triangles() = ToMessage(std::get<terrain::HeightTriangles>(given));
  }
  return message;
}

std::string HeightsDigest(const v1::HeightField& message) {
  v1::HeightField content = message;
  content.clear_name();
  content.clear_title();
  content.clear_digest();
  return MessageDigest(content);
}

}  // namespace mortise::parametric
