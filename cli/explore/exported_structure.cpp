#include "cli/explore/exported_structure.h"

#include <utility>

namespace mortise::cli {

void AddPart(v1::MapExportPart part, ExportedStructure& structure) {
  switch (part.part_case()) {
    case v1::MapExportPart::kTree:
      // Appends lists to lists.
      structure.tree.MergeFrom(part.tree());
      structure.tree.set_more(part.tree().more());
      break;
    case v1::MapExportPart::kMesh: {
      if (structure.meshes.empty() || !structure.meshes.back().more()) {
        structure.meshes.push_back(std::move(*part.mutable_mesh()));
        break;
      }
      v1::MapMesh& mesh = structure.meshes.back();
      mesh.mutable_triangles()->append(part.mesh().triangles());
      mesh.mutable_tetrahedra()->append(part.mesh().tetrahedra());
      mesh.mutable_parts()->append(part.mesh().parts());
      mesh.mutable_part_names()->MergeFrom(part.mesh().part_names());
      mesh.mutable_regions()->MergeFrom(part.mesh().regions());
      mesh.set_more(part.mesh().more());
      break;
    }
    case v1::MapExportPart::kSample:
      structure.samples.push_back(std::move(*part.mutable_sample()));
      break;
    case v1::MapExportPart::PART_NOT_SET:
      break;
  }
}

}  // namespace mortise::cli
