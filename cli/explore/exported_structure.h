// Puts together what ExportMap says of one structure.
#pragma once

#include <vector>

#include "mortise/v1/interpolator.pb.h"

namespace mortise::cli {

struct ExportedStructure {
  int structure = 0;  // index into DesignMap.structures
  v1::MapTree tree;
  std::vector<v1::MapMesh> meshes;
  std::vector<v1::MapExportPart::Sample> samples;
};

// Puts the next part of an export to what came before of it.
void AddPart(v1::MapExportPart part, ExportedStructure& structure);

}  // namespace mortise::cli
