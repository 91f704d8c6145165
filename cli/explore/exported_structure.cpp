#include "cli/explore/exported_structure.h"

#include <algorithm>
#include <string>
#include <utility>

namespace mortise::cli {
namespace {

using Sample = v1::MapExportPart::Sample;

// A message that goes on with the sample before it adds to what that has.
void AddSample(Sample sample, std::vector<Sample>& samples) {
  if (samples.empty() || samples.back().sample() != sample.sample() ||
      samples.back().mesh() != sample.mesh()) {
    samples.push_back(std::move(sample));
    return;
  }
  Sample& whole = samples.back();
  whole.mutable_positions()->append(sample.positions());
  for (v1::MapFieldValues& field : *sample.mutable_fields()) {
    const auto known = std::ranges::find_if(*whole.mutable_fields(), [&](const auto& one) {
      return one.name() == field.name() && one.load_case() == field.load_case();
    });
    if (known == whole.mutable_fields()->end()) {
      *whole.add_fields() = std::move(field);
    } else {
      known->mutable_values()->append(field.values());
    }
  }
}

// A region that comes in several messages, which all name it, is one.
void AddRegion(v1::MapMesh::Region region, v1::MapMesh& mesh) {
  const auto known = std::ranges::find_if(
      *mesh.mutable_regions(), [&](const auto& one) { return one.name() == region.name(); });
  if (known == mesh.mutable_regions()->end()) {
    *mesh.add_regions() = std::move(region);
  } else {
    known->mutable_triangles()->append(region.triangles());
  }
}

void AddMesh(v1::MapMesh part, std::vector<v1::MapMesh>& meshes) {
  if (meshes.empty() || !meshes.back().more()) {
    meshes.push_back(std::move(part));
    return;
  }
  v1::MapMesh& mesh = meshes.back();
  mesh.mutable_triangles()->append(part.triangles());
  mesh.mutable_tetrahedra()->append(part.tetrahedra());
  mesh.mutable_parts()->append(part.parts());
  mesh.mutable_part_names()->MergeFrom(part.part_names());
  for (v1::MapMesh::Region& region : *part.mutable_regions()) AddRegion(std::move(region), mesh);
  mesh.set_more(part.more());
}

}  // namespace

void AddPart(v1::MapExportPart part, ExportedStructure& structure) {
  switch (part.part_case()) {
    case v1::MapExportPart::kTree:
      // Appends lists to lists.
      structure.tree.MergeFrom(part.tree());
      structure.tree.set_more(part.tree().more());
      break;
    case v1::MapExportPart::kMesh:
      AddMesh(std::move(*part.mutable_mesh()), structure.meshes);
      break;
    case v1::MapExportPart::kSample:
      AddSample(std::move(*part.mutable_sample()), structure.samples);
      break;
    case v1::MapExportPart::PART_NOT_SET:
      break;
  }
}

}  // namespace mortise::cli
