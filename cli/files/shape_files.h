// Shapes in files beside those of items and assemblies.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "cli/client/gateway_client.h"
#include "common/design/template_validation.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::cli {

// Returns the bytes of a file of at most 64 MiB, packed by gzip. NOT_FOUND; RESOURCE_EXHAUSTED.
absl::StatusOr<std::string> PackedFile(const std::filesystem::path& file);

// Whether a file is STEP by its extension: .step, .stp, .stpz.
bool IsStepFile(const std::filesystem::path& file);

// Whether a file is a mesh by its extension: .obj, .off, .ply, .stl, .glb, .gltf.
bool IsMeshFile(const std::filesystem::path& file);

// Adds the shape in a file (STEP, or STL in millimetres) to the catalog. What is wrong with it is
// said with the file's name.
absl::StatusOr<v1::Shape> ImportShapeFile(const std::filesystem::path& file,
                                          v1::CatalogService::Stub& stub,
                                          const GatewayClient& client);

// Where `shape`, as `file` has it, is no shapes/{digest} but a path beside the file, adds that
// shape to the catalog and puts its name there; and adds what was repaired of it to `notes`, with
// the path.
absl::Status ResolveShape(const std::filesystem::path& file, std::string& shape,
                          v1::CatalogService::Stub& stub, const GatewayClient& client,
                          std::vector<std::string>& notes);

// Adds what is wrong with the shape that `place` names to the findings, as ResolveShape gives it;
// gives it back if it is no fault of the file.
absl::Status AddShapeFaults(const absl::Status& resolved, const std::string& place,
                            std::vector<FieldViolation>& findings);

}  // namespace mortise::cli
