#include "cli/files/shape_files.h"

#include <google/protobuf/io/gzip_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <set>

#include "absl/strings/str_cat.h"
#include "cli/client/field_sources.h"
#include "cli/client/requests.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/rpc/status_mapping.h"

namespace mortise::cli {
namespace {

constexpr std::size_t kMaxFile = 64 << 20;  // bytes

absl::StatusOr<std::string> Packed(const std::string& bytes, const std::string& name) {
  std::string packed;
  google::protobuf::io::StringOutputStream sink(&packed);
  google::protobuf::io::GzipOutputStream gzip(&sink);
  google::protobuf::io::ArrayInputStream source(bytes.data(), static_cast<int>(bytes.size()));
  const void* piece = nullptr;
  int size = 0;
  while (source.Next(&piece, &size)) {
    for (const char* from = static_cast<const char*>(piece); size > 0;) {
      void* room = nullptr;
      int free = 0;
      if (!gzip.Next(&room, &free)) return InvalidField(name, "cannot be packed");
      const int count = std::min(size, free);
      std::copy_n(from, count, static_cast<char*>(room));
      gzip.BackUp(free - count);
      from += count;
      size -= count;
    }
  }
  gzip.Close();
  return packed;
}

}  // namespace

absl::StatusOr<std::string> PackedFile(const std::filesystem::path& file) {
  MORTISE_ASSIGN_OR_RETURN(std::string bytes, ReadFile(file, kMaxFile));
  if (!bytes.starts_with("\x1f\x8b")) {
    MORTISE_ASSIGN_OR_RETURN(bytes, Packed(bytes, file.string()));
  }
  return bytes;
}

bool IsStepFile(const std::filesystem::path& file) {
  const std::string extension = LowerCaseExtension(file);
  return extension == ".step" || extension == ".stp" || extension == ".stpz";
}

bool IsMeshFile(const std::filesystem::path& file) {
  static const std::set<std::string> kExtensions = {".obj", ".off", ".ply",
                                                    ".stl", ".glb", ".gltf"};
  return kExtensions.count(LowerCaseExtension(file)) != 0;
}

absl::StatusOr<v1::Shape> ImportShapeFile(const std::filesystem::path& file,
                                          v1::CatalogService::Stub& stub,
                                          const GatewayClient& client) {
  if (!IsStepFile(file) && LowerCaseExtension(file) != ".stl") {
    return InvalidField(file.string(), "is neither STEP (.step, .stp, .stpz) nor STL (.stl)");
  }
  v1::ImportShapeRequest request;
  request.set_request_id(NewIdentifier());
  request.set_format(IsStepFile(file) ? v1::ImportShapeRequest::STEP : v1::ImportShapeRequest::STL);
  MORTISE_ASSIGN_OR_RETURN(*request.mutable_file(), PackedFile(file));
  if (request.file().size() > kMaxInMessage) {
    return TooLarge(file.string(), "4 MB packed by gzip");
  }
  FieldSources sources;
  sources.Add("file", file.string());
  v1::Shape shape;
  MORTISE_RETURN_IF_ERROR(sources.Name(client.Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub.ImportShape(&context, request, &shape));
  })));
  return shape;
}

absl::Status ResolveShape(const std::filesystem::path& file, std::string& shape,
                          v1::CatalogService::Stub& stub, const GatewayClient& client,
                          std::vector<std::string>& notes) {
  if (shape.empty() || shape.starts_with("shapes/")) return absl::OkStatus();
  MORTISE_ASSIGN_OR_RETURN(const v1::Shape stored,
                           ImportShapeFile(file.parent_path() / shape, stub, client));
  for (const std::string& note : stored.notes()) notes.push_back(absl::StrCat(shape, ": ", note));
  shape = stored.name();
  return absl::OkStatus();
}

absl::Status AddShapeFaults(const absl::Status& resolved, const std::string& place,
                            std::vector<FieldViolation>& findings) {
  if (absl::IsNotFound(resolved) || absl::IsResourceExhausted(resolved)) {
    findings.push_back({place, std::string(resolved.message())});
    return absl::OkStatus();
  }
  if (!absl::IsInvalidArgument(resolved)) return resolved;
  for (const FieldViolation& violation : AllViolationsOf(resolved)) {
    findings.push_back({place, absl::StrCat(violation.field, ": ", violation.message)});
  }
  return absl::OkStatus();
}

}  // namespace mortise::cli
