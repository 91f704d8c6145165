// The file of a map: stored_map.proto, in the folder of blobs.
//
// Maps of metrics would fit into the store (ten metrics of a thousand samples are 80 kB), but they
// grow with the budget past what a record may hold. A blob (blob_folder.h) already has what a map
// needs: it is written beside its place and renamed, it is named by its checksum, and that is
// checked when it is read. Canonical meshes and packed shapes are far larger, and asked for one by
// one: each is a blob of its own, which the file of the map names.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "common/maps/interpolation_map.h"

namespace mortise::interpolator {

// A canonical mesh of a structure, and the shapes of samples in it.
struct StoredMesh {
  std::string file;                   // digest, 64 hexadecimal digits
  std::map<int, std::string> shapes;  // the digest of each, by sample
};

// What a structure's map has of shapes. Elements are in the order of RefinementTree::Elements.
struct StoredShapes {
  // Index into `meshes`; -1 of elements without shapes: those that are cut off, and others.
  std::vector<int> element_meshes;
  std::vector<StoredMesh> meshes;
  Eigen::VectorXd shape_errors;  // m, of each element: how far positions may be off
  Eigen::MatrixXd field_errors;  // fields x elements, SI units
};

struct StoredStructure {
  maps::InterpolationMap map;
  StoredShapes shapes;  // nothing of a map of metrics alone
};

// Writes the maps of all structures: the same bytes for the same maps. `shapes`: one for each
// structure, or none.
std::string SerializeMap(const std::vector<maps::MapContent>& structures,
                         const std::vector<StoredShapes>& shapes = {});

// Reads what SerializeMap wrote, this one's or that of earlier versions. DATA_LOSS when the bytes
// are not such.
absl::StatusOr<std::vector<StoredStructure>> ParseMap(std::string_view bytes);

}  // namespace mortise::interpolator
