// Shapes of the web whose category is known, as queries and as what is found.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::retrieval {

struct LabelledShape {
  std::string name;  // "chair/kenney_chair.obj": the file in the folder
  std::string category;
  std::string author;         // whose shapes are alike for another reason than their category
  mesh::SurfaceMesh surface;  // z upwards
};

// Whose a source of labels.csv is: the packs of one author (quat, quat17, quat19) are one author's.
std::string AuthorOf(const std::string& source);

// The shapes of a folder with a table labels.csv: columns file, category and source, among others.
// Reads in this process: the folder must be trusted. NOT_FOUND; INVALID_ARGUMENT naming the file at
// fault.
absl::StatusOr<std::vector<LabelledShape>> ReadLabelledShapes(const std::filesystem::path& folder);

}  // namespace mortise::retrieval
