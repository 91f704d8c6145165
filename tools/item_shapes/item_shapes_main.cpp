// Draws the shapes of the items that ship: item_shapes collection/shapes [NAME…]
#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "common/base/files.h"
#include "tools/item_shapes/item_shapes.h"

namespace {

// Whether both files could be written.
absl::Status Draw(const std::filesystem::path& folder, const mortise::catalog::ItemShape& shape) {
  const auto step = mortise::catalog::DrawStep(folder, shape);
  if (!step.ok()) return step.status();
  const auto message = mortise::catalog::ShapeOfFile(*step);
  if (!message.ok()) return message.status();
  std::cout << shape.name << ": " << 1000 * message->size().x() << " x "
            << 1000 * message->size().y() << " x " << 1000 * message->size().z() << " mm, "
            << message->triangle_count() << " triangles, " << message->ByteSizeLong() << " bytes\n";
  const absl::Status written = mortise::WriteFile(folder / (shape.name + ".step"), *step);
  if (!written.ok()) return written;
  return mortise::WriteFile(folder / (shape.name + ".shape"), message->SerializeAsString());
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2) {
    std::cerr << "Usage: item_shapes FOLDER [NAME...]\n";
    return 2;
  }
  const std::vector<std::string> wanted(arguments + 2, arguments + count);
  const auto shapes = mortise::catalog::ReadShapeList(arguments[1]);
  if (!shapes.ok()) {
    std::cerr << shapes.status() << "\n";
    return 1;
  }
  int failed = 0;
  for (const mortise::catalog::ItemShape& shape : *shapes) {
    const bool is_wanted =
        wanted.empty() || std::find(wanted.begin(), wanted.end(), shape.name) != wanted.end();
    if (!is_wanted) continue;
    const absl::Status drawn = Draw(arguments[1], shape);
    if (drawn.ok()) continue;
    std::cerr << shape.name << ": " << drawn << "\n";
    ++failed;
  }
  return failed == 0 ? 0 : 1;
}
