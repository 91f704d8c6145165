#include "cli/files/assembly_files.h"

#include <google/protobuf/message.h>
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "cli/client/command_flags.h"
#include "cli/client/field_sources.h"
#include "cli/client/json_input.h"
#include "cli/client/requests.h"
#include "cli/client/tag_options.h"
#include "cli/files/import_call.h"
#include "cli/files/shape_files.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "common/base/text_encoding.h"
#include "common/base/violation_lists.h"
#include "common/design/template_validation.h"
#include "common/messages/proto_text.h"
#include "common/rpc/chunk_calls.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/assembly.grpc.pb.h"

namespace mortise::cli {
namespace {

using Stub = v1::AssemblyService::Stub;

constexpr std::size_t kMaxFile = 4 << 20;  // bytes
constexpr double kLargeFileSeconds = 600;

struct ImportOptions {
  std::vector<std::filesystem::path> files;
  std::filesystem::path annotations;
  std::string id;
  bool drop_annotations = false;  // those of the revision before
  std::string unit, up;           // of meshes
  int most_parts = 0;
  TagOptions tags;

  bool HasMeshOptions() const { return !unit.empty() || !up.empty() || most_parts != 0; }
};

struct ExportOptions {
  std::string subject;
  std::filesystem::path at;
  std::string format = "step";
  std::string pose;
  std::filesystem::path path;
};

// "Side Table.step" to "side-table".
std::string IdOf(const std::filesystem::path& file) {
  std::string id;
  for (const char c : file.stem().string()) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) != 0) {
      id += static_cast<char>(std::tolower(byte));
    } else if (!id.empty() && id.back() != '-') {
      id += '-';
    }
  }
  while (id.ends_with('-')) id.pop_back();
  return id;
}

// What is wrong with a file's text, at its places in the file.
absl::Status FaultsOfFile(const std::filesystem::path& path, std::vector<FieldViolation> faults) {
  if (faults.empty()) return absl::OkStatus();
  for (FieldViolation& fault : faults) {
    fault.field = absl::StrCat(path.string(), fault.field.empty() ? "" : ": ", fault.field);
  }
  return InvalidFields(faults);
}

// A message as JSON, as the gateway writes it, or else as protobuf text. INVALID_ARGUMENT naming
// the file with the place in it, fields of JSON, lines of text, of everything that is wrong.
template <typename Message>
absl::StatusOr<Message> ReadMessage(const std::filesystem::path& path) {
  Message message;
  MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(path, kMaxFile));
  MORTISE_RETURN_IF_ERROR(LowerCaseExtension(path) == ".json"
                              ? ReadJson(text, path.string(), message)
                              : parametric::ParseProtoText(text, path.string(), message));
  return message;
}

absl::StatusOr<v1::AssemblyAnnotations> ReadAnnotations(const std::filesystem::path& path) {
  if (path.empty()) return v1::AssemblyAnnotations();
  return ReadMessage<v1::AssemblyAnnotations>(path);
}

// The latest revision of an assembly; 0 if there is none.
absl::StatusOr<int64_t> PresentRevision(const std::string& name, Stub& stub,
                                        const GatewayClient& client) {
  v1::GetAssemblyRequest get;
  get.set_name(name);
  v1::Assembly present;
  const absl::Status found = client.Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub.GetAssembly(&context, get, &present));
  });
  // A name that is malformed is one of the findings of the import.
  if (!found.ok() && !absl::IsNotFound(found) && !absl::IsInvalidArgument(found)) return found;
  return present.revision();
}

// The call that imports what a request says under a name.
template <typename Request>
ImportCall WatchedCall(const Request& request, const std::string& name,
                       const std::function<absl::Status(grpc::ClientContext&)>& make, Stub& stub,
                       const GatewayClient& client) {
  return {.request_id = request.request_id(),
          .name = name,
          .before = request.expected_revision(),
          .seconds = kLargeFileSeconds,
          .make = make,
          .present = [name, &stub, &client] { return PresentRevision(name, stub, client); }};
}

void Tell(const v1::Assembly& stored, int64_t before, const std::vector<std::string>& notes,
          Output& output, nlohmann::ordered_json& document) {
  const bool changed = stored.revision() != before;
  output.Line(absl::StrCat(stored.name(), changed ? " imported as" : " is there already as",
                           " revision ", stored.revision()));
  for (const std::string& note : notes) output.Line(absl::StrCat("  note: ", note));
  nlohmann::ordered_json entry = {{"name", stored.name()},
                                  {"revision", stored.revision()},
                                  {"change", !changed      ? "none"
                                             : before == 0 ? "created"
                                                           : "updated"}};
  if (!notes.empty()) entry["notes"] = notes;
  document.push_back(std::move(entry));
}

// Brings a file that is too large for a message to the catalog; its digest.
absl::StatusOr<std::string> Upload(const std::string& bytes, Stub& stub,
                                   const GatewayClient& client) {
  v1::UploadDrawingResponse response;
  MORTISE_RETURN_IF_ERROR(client.Call(
      [&](grpc::ClientContext& context) {
        const auto writer = stub.UploadDrawing(&context, &response);
        rpc::SendChunks(bytes, *writer);
        return rpc::FromGrpc(writer->Finish());
      },
      kLargeFileSeconds));
  return response.sha256();
}

// What a file that was drawn becomes besides the file: its annotations, as the flags have them.
template <typename Request>
absl::Status Describe(const std::filesystem::path& file, const ImportOptions& options, Stub& stub,
                      const GatewayClient& client, Request& request, FieldSources& sources) {
  MORTISE_ASSIGN_OR_RETURN(*request.mutable_annotations(), ReadAnnotations(options.annotations));
  v1::AssemblyAnnotations& annotations = *request.mutable_annotations();
  sources.AddFile("drawing", file.string());
  sources.AddFile("annotations",
                  (options.annotations.empty() ? file : options.annotations).string());
  if (!options.id.empty()) {
    annotations.set_name(ResourceName("assemblies", options.id));
    sources.Add("annotations.name", "--id");
  } else if (annotations.name().empty()) {
    annotations.set_name(ResourceName("assemblies", IdOf(file)));
  }
  // One that means all parts, and says nothing of them.
  if (options.drop_annotations) annotations.add_parts()->add_parts("*");
  if (!options.tags.empty()) {
    annotations.clear_external_ids();
    annotations.clear_labels();
    MORTISE_RETURN_IF_ERROR(AddTags(options.tags, &annotations));
    sources.AddEach("annotations.external_ids", "--external-id", options.tags.external_ids);
    sources.Add("annotations.labels", "--label");
  }
  request.set_request_id(NewIdentifier());
  MORTISE_ASSIGN_OR_RETURN(const int64_t before, PresentRevision(annotations.name(), stub, client));
  request.set_expected_revision(before);
  return absl::OkStatus();
}

absl::Status ImportDrawing(const std::filesystem::path& file, const ImportOptions& options,
                           Stub& stub, const GatewayClient& client, Output& output,
                           nlohmann::ordered_json& document) {
  v1::ImportAssemblyStepRequest request;
  FieldSources sources;
  sources.AddFile("step", file.string());
  MORTISE_ASSIGN_OR_RETURN(std::string packed, PackedFile(file));
  MORTISE_RETURN_IF_ERROR(Describe(file, options, stub, client, request, sources));
  if (request.ByteSizeLong() + packed.size() <= kMaxInMessage) {
    request.set_step(std::move(packed));
  } else {
    MORTISE_ASSIGN_OR_RETURN(*request.mutable_drawing(), Upload(packed, stub, client));
  }
  v1::ImportAssemblyStepResponse imported;
  const auto import = [&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub.ImportAssemblyStep(&context, request, &imported));
  };
  MORTISE_RETURN_IF_ERROR(sources.Name(MakeWatched(
      WatchedCall(request, request.annotations().name(), import, stub, client), client, output)));
  Tell(imported.assembly(), request.expected_revision(),
       {imported.notes().begin(), imported.notes().end()}, output, document);
  return absl::OkStatus();
}

absl::Status ImportMesh(const std::filesystem::path& file, const ImportOptions& options, Stub& stub,
                        const GatewayClient& client, Output& output,
                        nlohmann::ordered_json& document) {
  v1::ImportAssemblyMeshRequest request;
  FieldSources sources;
  sources.AddFile("file", file.string());
  request.set_file_name(file.filename().string());
  request.set_length_unit(options.unit);
  MORTISE_ASSIGN_OR_RETURN(const v1::Axis up, ParseAxis(options.up, "--up"));
  request.set_up(up);
  request.set_most_parts(options.most_parts);
  MORTISE_ASSIGN_OR_RETURN(std::string packed, PackedFile(file));
  MORTISE_RETURN_IF_ERROR(Describe(file, options, stub, client, request, sources));
  if (request.ByteSizeLong() + packed.size() <= kMaxInMessage) {
    request.set_file(std::move(packed));
  } else {
    MORTISE_ASSIGN_OR_RETURN(*request.mutable_drawing(), Upload(packed, stub, client));
  }
  v1::ImportAssemblyMeshResponse imported;
  const auto import = [&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub.ImportAssemblyMesh(&context, request, &imported));
  };
  MORTISE_RETURN_IF_ERROR(sources.Name(MakeWatched(
      WatchedCall(request, request.annotations().name(), import, stub, client), client, output)));
  Tell(imported.assembly(), request.expected_revision(),
       {imported.notes().begin(), imported.notes().end()}, output, document);
  return absl::OkStatus();
}

// The refusal of an assembly, with why files of shapes are none where it only says that there are
// no shapes of their names.
absl::Status WithShapeFaults(const std::vector<FieldViolation>& of_shapes,
                             const absl::Status& refusal) {
  if (of_shapes.empty() || (!refusal.ok() && !absl::IsInvalidArgument(refusal))) return refusal;
  std::vector<FieldViolation> all;
  for (const FieldViolation& finding : of_shapes) {
    all.push_back({finding.field, finding.message});
  }
  for (FieldViolation& violation : AllViolationsOf(refusal)) {
    const bool is_told = std::any_of(
        of_shapes.begin(), of_shapes.end(),
        [&](const FieldViolation& finding) { return finding.field == violation.field; });
    if (!is_told) all.push_back(std::move(violation));
  }
  return InvalidFields(all);
}

absl::Status ImportText(const std::filesystem::path& file, const v1::Assembly& assembly, Stub& stub,
                        const GatewayClient& client, Output& output,
                        nlohmann::ordered_json& document) {
  MORTISE_ASSIGN_OR_RETURN(const int64_t before, PresentRevision(assembly.name(), stub, client));
  v1::ImportAssemblyRequest request;
  request.set_request_id(NewIdentifier());
  *request.mutable_assembly() = assembly;
  const auto catalog = v1::CatalogService::NewStub(client.channel());
  std::vector<std::string> notes;
  std::vector<FieldViolation> of_shapes;
  for (int i = 0; i < assembly.parts_size(); ++i) {
    const absl::Status resolved =
        ResolveShape(file, *request.mutable_assembly()->mutable_parts(i)->mutable_shape(), *catalog,
                     client, notes);
    const std::string place = absl::StrCat(file.string(), ": parts[", i, "].shape");
    MORTISE_RETURN_IF_ERROR(AddShapeFaults(resolved, place, of_shapes));
  }
  request.set_expected_revision(before);
  v1::Assembly stored;
  FieldSources sources;
  sources.AddFile("assembly", file.string());
  const auto import = [&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub.ImportAssembly(&context, request, &stored));
  };
  MORTISE_RETURN_IF_ERROR(WithShapeFaults(
      of_shapes,
      sources.Name(MakeWatched(WatchedCall(request, assembly.name(), import, stub, client), client,
                               output))));
  Tell(stored, before, notes, output, document);
  return absl::OkStatus();
}

// Whether a file is drawn, and no text.
bool IsDrawn(const std::filesystem::path& file) { return IsStepFile(file) || IsMeshFile(file); }

// Whether the name of a file says that it is an assembly's text. ReadMessage takes other names,
// too.
bool IsNamedAsText(const std::filesystem::path& file) {
  const std::string extension = absl::AsciiStrToLower(file.extension().string());
  return extension == ".textproto" || extension == ".txtpb" || extension == ".json";
}

absl::Status UnknownFormat(const std::filesystem::path& file) {
  return InvalidField(file.string(),
                      "is of no format that is imported: an assembly (.textproto, .json), STEP "
                      "(.step, .stp, .stpz) or a mesh (.obj, .off, .ply, .stl, .glb, .gltf), by "
                      "the end of its name");
}

// The assemblies of the files that are text, each at its file's place. Everything that is wrong
// with any of them is told.
absl::StatusOr<std::vector<v1::Assembly>> ReadTexts(
    const std::vector<std::filesystem::path>& files) {
  std::vector<v1::Assembly> texts(files.size());
  absl::Status faults;
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (IsDrawn(files[i])) continue;
    absl::StatusOr<v1::Assembly> text = ReadMessage<v1::Assembly>(files[i]);
    // What is no text is not told of as if it were one.
    const bool is_other = absl::IsInvalidArgument(text.status()) && !IsNamedAsText(files[i]);
    faults = CombineViolations(faults, is_other ? UnknownFormat(files[i]) : text.status());
    if (text.ok()) texts[i] = *std::move(text);
  }
  MORTISE_RETURN_IF_ERROR(faults);
  return texts;
}

// Flags that belong to one file of a kind.
absl::Status CheckFlags(const ImportOptions& options) {
  const bool is_one = options.files.size() == 1;
  const bool is_mesh = is_one && IsMeshFile(options.files.front());
  if (is_one && !IsDrawn(options.files.front()) && !IsNamedAsText(options.files.front())) {
    return absl::OkStatus();  // reading it tells what it is
  }
  if (options.HasMeshOptions() && !is_mesh) {
    return InvalidField(!options.unit.empty() ? "--unit"
                        : !options.up.empty() ? "--up"
                                              : "--most-parts",
                        "belongs to one mesh");
  }
  if (options.drop_annotations && !options.annotations.empty()) {
    return InvalidField("--drop-annotations",
                        "cannot be given with --annotations, which replace "
                        "those of the revision before as they are");
  }
  const bool has_options = options.drop_annotations || !options.annotations.empty() ||
                           !options.id.empty() || !options.tags.empty();
  if (has_options && !(is_one && IsDrawn(options.files.front()))) {
    return InvalidField(!options.id.empty()                  ? "--id"
                        : !options.annotations.empty()       ? "--annotations"
                        : options.drop_annotations           ? "--drop-annotations"
                        : !options.tags.external_ids.empty() ? "--external-id"
                                                             : "--label",
                        "belongs to one STEP file or mesh");
  }
  return absl::OkStatus();
}

absl::Status Import(const ImportOptions& options, Session& session, Output& output) {
  MORTISE_RETURN_IF_ERROR(CheckFlags(options));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<v1::Assembly> texts, ReadTexts(options.files));
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::AssemblyService::NewStub(client->channel());
  nlohmann::ordered_json document = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const std::filesystem::path& file = options.files[i];
    MORTISE_RETURN_IF_ERROR(
        IsStepFile(file)   ? ImportDrawing(file, options, *stub, *client, output, document)
        : IsMeshFile(file) ? ImportMesh(file, options, *stub, *client, output, document)
                           : ImportText(file, texts[i], *stub, *client, output, document));
  }
  output.Document(document);
  return absl::OkStatus();
}

absl::Status Export(const ExportOptions& options, Session& session, Output& output) {
  v1::ExportAssemblyRequest request;
  request.set_name(ResourceName("assemblies", options.subject));
  static const std::map<std::string, v1::ExportDesignRequest::Format> kFormats = {
      {"step", v1::ExportDesignRequest::STEP},
      {"glb", v1::ExportDesignRequest::GLB},
      {"obj", v1::ExportDesignRequest::OBJ},
      {"stl", v1::ExportDesignRequest::STL}};
  request.set_format(kFormats.at(options.format));
  request.set_rest_pose(options.pose);
  if (!options.at.empty()) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<double> q, ReadParameters(options.at));
    request.mutable_q()->Add(q.begin(), q.end());
  }
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  MORTISE_RETURN_IF_ERROR(ExportTo(request, options.path, *client, output));
  output.Document({{"assembly", request.name()}, {"file", options.path.string()}});
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::vector<double>> ReadParameters(const std::filesystem::path& path) {
  MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(path, kMaxFile));
  MORTISE_ASSIGN_OR_RETURN(const std::string_view json, WithoutByteOrderMark(text, path.string()));
  const nlohmann::json document = nlohmann::json::parse(json, nullptr, false);
  if (!document.is_object() || !document.contains("q") || !document["q"].is_array()) {
    return InvalidField(path.string(), "is not what 'assembly adjust --json' prints");
  }
  std::vector<double> q;
  std::vector<FieldViolation> faults;
  for (const nlohmann::json& entry : document["q"]) {
    if (!entry.is_number()) faults.push_back({absl::StrCat("q[", q.size(), "]"), "is no number"});
    q.push_back(entry.is_number() ? entry.get<double>() : 0);
  }
  MORTISE_RETURN_IF_ERROR(FaultsOfFile(path, std::move(faults)));
  return q;
}

absl::Status ExportTo(const v1::ExportAssemblyRequest& request, const std::filesystem::path& path,
                      const GatewayClient& client, const Output& output) {
  if (path.empty()) return absl::OkStatus();
  const auto stub = v1::AssemblyService::NewStub(client.channel());
  MORTISE_RETURN_IF_ERROR(client.Call([&](grpc::ClientContext& context) {
    return Receive(*stub->ExportAssembly(&context, request), path).status();
  }));
  output.Line(absl::StrCat("  ", path.string()));
  return absl::OkStatus();
}

void AddAssemblyFileCommands(CLI::App& assembly, Session& session) {
  auto import_options = std::make_shared<ImportOptions>();
  CommandFlags add(*assembly.add_subcommand("import", "Add assembly files to the catalog"));
  add.Add(
         "files", import_options->files,
         "Files of one mortise.v1.Assembly each (.textproto), STEP (.step, .stp, .stpz), or meshes "
         "(.obj, .off, .ply, .stl, .glb, .gltf)")
      ->required();
  add.Add("--annotations", import_options->annotations,
          "What the STEP file or mesh does not say: mortise.v1.AssemblyAnnotations "
          "(.textproto or .json)");
  add.command().add_flag(
      "--drop-annotations", import_options->drop_annotations,
      "Import a drawing again without annotations, and keep none of the revision before");
  add.Add("--id", import_options->id,
          "Name of the assembly in a STEP file or mesh, instead of the annotations' or the "
          "file's");
  add.Add("--unit", import_options->unit,
          "Unit of a mesh: m, cm, mm, um, in or ft; as its format says, or else a guess",
          "length_unit");
  add.Add("--up", import_options->up,
          "Which way is up in a mesh: x, y or z; as its format says, or else z");
  add.Add("--most-parts", import_options->most_parts,
          "How many parts a mesh becomes at most, 1 to 200; 40 if left out", "most_parts");
  AddTagOptions(add, import_options->tags);
  add.command().footer(
      "Example: mortise assembly import collection/assemblies/bookshelf.textproto\n"
      "         mortise assembly import table.step --annotations table.textproto\n"
      "         mortise assembly import chair.obj --unit cm --up y");
  add.Run(session,
          [import_options](Session& s, Output& o) { return Import(*import_options, s, o); });

  auto export_options = std::make_shared<ExportOptions>();
  CommandFlags out(
      *assembly.add_subcommand("export", "Write an assembly as a STEP, GLB, OBJ or STL file"));
  out.Add("assembly", export_options->subject, "Such as bookshelf", "name")->required();
  out.Add("--at", export_options->at,
          "The design that 'assembly adjust --json' printed; as drawn if left out", "q");
  out.Add("--format", export_options->format, "step, glb, obj (metres), or stl (millimetres)")
      ->check(CLI::IsMember({"step", "glb", "obj", "stl"}))
      ->capture_default_str();
  out.Add("--pose", export_options->pose,
          "A rest pose, such as \"lid hinge: open\"; else as it is drawn", "rest_pose");
  out.Add("-o,--out", export_options->path, "The file")->required();
  out.command().footer("Example: mortise assembly export bookshelf --format glb -o bookshelf.glb");
  out.Run(session,
          [export_options](Session& s, Output& o) { return Export(*export_options, s, o); });
}

}  // namespace mortise::cli
