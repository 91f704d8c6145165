// The shapes of the items that ship, drawn: collection/shapes has a list of them (shapes.csv),
// which names for each a drawing, a CAD template beside it, and its dimensions. Of each is kept
// what people open, a STEP file, and what the catalog loads, a Shape that was read from that file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/cad/solid.h"
#include "common/design/evaluated_design.h"
#include "mortise/v1/item.pb.h"

namespace mortise::catalog {

// A row of the list.
struct ItemShape {
  std::string name;     // of its files: wheel-rubber-50.step, wheel-rubber-50.shape
  std::string drawing;  // wheel.textproto
  std::vector<parametric::NamedValue> dimensions;  // of the drawing's parameters, m
};

// All rows of shapes.csv in `folder`. INVALID_ARGUMENT with the places of all faults.
absl::StatusOr<std::vector<ItemShape>> ReadShapeList(const std::filesystem::path& folder);

// The shape drawn anew. INVALID_ARGUMENT naming what the drawing in `folder` cannot be made with.
absl::StatusOr<cad::Solid> DrawSolid(const std::filesystem::path& folder, const ItemShape& shape);

// The same as the bytes of a STEP file.
absl::StatusOr<std::string> DrawStep(const std::filesystem::path& folder, const ItemShape& shape);

// What a STEP file becomes when it is imported as a shape.
absl::StatusOr<v1::Shape> ShapeOfFile(const std::string& step);

}  // namespace mortise::catalog
