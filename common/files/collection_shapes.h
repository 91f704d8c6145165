// The shapes that the items and parts of a collection name by paths. Private to collection.cpp.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "mortise/v1/item.pb.h"

namespace mortise::parametric {

// Reads each shape once, however many name it.
class CollectionShapes {
 public:
  // Puts what a shape is called by its content in place of the path of its drawing, which is beside
  // `file`. What is read is the shape beside the drawing: castor.shape for castor.step. Names
  // without a path stay as they are. INVALID_ARGUMENT, without a field, with the path: no such
  // file, or it is damaged.
  absl::Status Resolve(const std::filesystem::path& file, std::string& shape);

  // Returns those that were read, in the order of their names.
  std::vector<v1::Shape> Take();

 private:
  std::map<std::filesystem::path, std::string> names_;
  std::map<std::string, v1::Shape> shapes_;
};

}  // namespace mortise::parametric
