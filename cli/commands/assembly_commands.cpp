// mortise assembly list|show|adjust|sample: designs as experts draw them, and what they can be
// changed to.
#include <google/protobuf/util/json_util.h>
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "cli/client/command_flags.h"
#include "cli/client/filter_options.h"
#include "cli/client/requests.h"
#include "cli/client/session.h"
#include "cli/commands/commands.h"
#include "cli/commands/delete_commands.h"
#include "cli/files/assembly_files.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/assembly.grpc.pb.h"

namespace mortise::cli {
namespace {

struct AdjustOptions {
  std::string subject;
  std::vector<std::string> demands;
  std::filesystem::path from;
  bool strict = false;
  std::filesystem::path step;
  std::filesystem::path glb;
};

struct ListOptions {
  std::string item;
  std::string text;
  FilterOptions filter;
};

struct SampleOptions {
  std::string subject;
  int count = 10;
  std::uint64_t seed = 1;
};

std::string MeasureText(const v1::Measure& measure) {
  const std::string axis = measure.axis() == v1::Y ? "y" : measure.axis() == v1::Z ? "z" : "x";
  const std::string name = absl::StrCat(measure.element(), ".", axis);
  switch (measure.kind()) {
    case v1::Measure::CENTER:
      return name + ".center";
    case v1::Measure::MINIMUM:
      return name + ".minimum";
    case v1::Measure::MAXIMUM:
      return name + ".maximum";
    default:
      return name;
  }
}

// ---- The commands -------------------------------------------------------------------------------

absl::Status List(const ListOptions& options, Session& session, Output& output) {
  v1::ListAssembliesRequest filters;
  if (!options.item.empty()) filters.set_item(ResourceName("items", options.item));
  filters.set_text(options.text);
  MORTISE_ASSIGN_OR_RETURN(*filters.mutable_filter(), ParseFilter(options.filter));
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::AssemblyService::NewStub(client->channel());
  nlohmann::ordered_json document = nlohmann::ordered_json::array();
  std::vector<std::vector<std::string>> rows;
  const absl::Status listed = ListAll<v1::ListAssembliesRequest, v1::ListAssembliesResponse>(
      *client, [&](auto... a) { return stub->ListAssemblies(a...); },
      [&](const v1::ListAssembliesResponse& page) {
        for (const v1::Assembly& assembly : page.assemblies()) {
          rows.push_back(
              {assembly.name(), assembly.title(), absl::StrCat("revision ", assembly.revision())});
          if (!output.text()) document.push_back(ToJson(assembly));
        }
      },
      filters);
  MORTISE_RETURN_IF_ERROR(listed);
  output.Table({"name", "title", "details"}, rows);
  output.Document(document);
  return absl::OkStatus();
}

// "contact across x, 12 cm2"; of several patches the first and how many more.
std::string MeetingText(const v1::ElementConnection& connection) {
  if (connection.patches().empty()) return "";
  const v1::ConnectionPatch& patch = connection.patches(0);
  std::string text;
  switch (patch.kind()) {
    case v1::ConnectionPatch::CONTACT:
      text =
          absl::StrFormat("contact across %s, %.4g cm2",
                          absl::AsciiStrToLower(v1::Axis_Name(patch.normal())), 1e4 * patch.area());
      break;
    case v1::ConnectionPatch::GAP:
      text = absl::StrCat("gap along ", absl::AsciiStrToLower(v1::Axis_Name(patch.normal())));
      break;
    default:
      text = "anywhere on it";
  }
  if (connection.patches_size() > 1) {
    absl::StrAppend(&text, " and ", connection.patches_size() - 1, " more");
  }
  return text;
}

void PrintParametrization(const v1::Parametrization& found, const Output& output) {
  std::vector<std::vector<std::string>> nodes;
  for (const v1::ParametricNode& node : found.nodes()) {
    nodes.push_back({node.group().empty() ? "(all)" : node.group(), absl::StrCat(node.elements()),
                     absl::StrCat(node.relationships()), absl::StrCat(node.degrees_of_freedom())});
  }
  output.Table({"group", "elements", "relationships", "degrees of freedom"}, nodes);
  std::vector<std::vector<std::string>> sizes;
  for (const v1::MeasureRange& range : found.sizes()) {
    sizes.push_back({MeasureText(range.measure()), Millimetres(range.drawn()),
                     Millimetres(range.minimum()), Millimetres(range.maximum())});
  }
  output.Table({"size", "drawn", "least", "most"}, sizes);
  std::vector<std::vector<std::string>> connections;
  for (const v1::ElementConnection& connection : found.connections()) {
    connections.push_back({connection.name(),
                           connection.connecting().empty()
                               ? "(they touch)"
                               : absl::StrJoin(connection.connecting(), ", "),
                           MeetingText(connection), absl::StrCat(connection.hard_size()),
                           absl::StrCat(connection.soft_size())});
  }
  output.Table({"connection", "held by", "where they meet", "hard", "soft"}, connections);
  output.Line(absl::StrFormat(
      "%s revision %d: %d contacts, %d connections, %d relationships, %d ways to change it",
      found.assembly(), found.revision(), found.contacts_size(), found.connections_size(),
      found.relationships_size(), found.degrees_of_freedom()));
}

absl::Status Show(const std::string& name, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::AssemblyService::NewStub(client->channel());
  v1::ParametrizeAssemblyRequest request;
  request.set_name(ResourceName("assemblies", name));
  v1::Parametrization found;
  MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub->ParametrizeAssembly(&context, request, &found));
  }));
  PrintParametrization(found, output);
  output.DocumentOf(found);
  return absl::OkStatus();
}

void PrintDesign(const v1::AdjustedAssembly& design, const v1::AdjustAssemblyRequest& request,
                 const Output& output) {
  std::vector<std::vector<std::string>> demands;
  for (int i = 0; i < design.reached_size(); ++i) {
    demands.push_back({MeasureText(request.demands(i).measure()),
                       Millimetres(request.demands(i).value()), Millimetres(design.reached(i))});
  }
  if (!demands.empty()) output.Table({"measure", "asked", "reached"}, demands);
  std::vector<std::vector<std::string>> parts;
  for (const v1::PlacedPart& part : design.parts()) {
    parts.push_back({part.name(), part.item(), Millimetres(part.maximum().x() - part.minimum().x()),
                     Millimetres(part.maximum().y() - part.minimum().y()),
                     Millimetres(part.maximum().z() - part.minimum().z())});
  }
  output.Table({"part", "item", "x", "y", "z"}, parts);
  for (const std::string& fault : design.faults()) output.Line(absl::StrCat("fault: ", fault));
  output.Line(absl::StrFormat("%d parts, %d faults", design.parts_size(), design.faults_size()));
}

absl::Status Adjust(const AdjustOptions& options, Session& session, Output& output) {
  v1::AdjustAssemblyRequest request;
  request.set_name(ResourceName("assemblies", options.subject));
  request.set_strict(options.strict);
  for (const std::string& text : options.demands) {
    MORTISE_ASSIGN_OR_RETURN(*request.add_demands(), ParseDemand(text));
  }
  if (!options.from.empty()) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<double> q, ReadParameters(options.from));
    request.mutable_q()->Add(q.begin(), q.end());
  }
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::AssemblyService::NewStub(client->channel());
  v1::AdjustedAssembly design;
  MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub->AdjustAssembly(&context, request, &design));
  }));
  PrintDesign(design, request, output);
  v1::ExportAssemblyRequest file;
  file.set_name(design.assembly());
  file.set_revision(design.revision());
  *file.mutable_q() = design.q();
  file.set_format(v1::ExportDesignRequest::STEP);
  MORTISE_RETURN_IF_ERROR(ExportTo(file, options.step, *client, output));
  file.set_format(v1::ExportDesignRequest::GLB);
  MORTISE_RETURN_IF_ERROR(ExportTo(file, options.glb, *client, output));
  output.DocumentOf(design);
  return options.strict ? FaultsToStatus(design.assembly(), design.faults()) : absl::OkStatus();
}

// Of the box around all parts, m.
std::array<double, 3> OverallSize(const v1::AdjustedAssembly& design) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::array<double, 3> low = {kInfinity, kInfinity, kInfinity};
  std::array<double, 3> high = {-kInfinity, -kInfinity, -kInfinity};
  for (const v1::PlacedPart& part : design.parts()) {
    const std::array<double, 3> least = {part.minimum().x(), part.minimum().y(),
                                         part.minimum().z()};
    const std::array<double, 3> most = {part.maximum().x(), part.maximum().y(), part.maximum().z()};
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], least[k]);
      high[k] = std::max(high[k], most[k]);
    }
  }
  return {high[0] - low[0], high[1] - low[1], high[2] - low[2]};
}

absl::Status Sample(const SampleOptions& options, Session& session, Output& output) {
  v1::SampleAssemblyRequest request;
  request.set_name(ResourceName("assemblies", options.subject));
  request.set_count(options.count);
  request.set_seed(options.seed);
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::AssemblyService::NewStub(client->channel());
  std::vector<v1::AdjustedAssembly> designs;
  MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
    designs.clear();
    const auto reader = stub->SampleAssembly(&context, request);
    v1::AdjustedAssembly design;
    while (reader->Read(&design)) designs.push_back(design);
    return rpc::FromGrpc(reader->Finish());
  }));
  nlohmann::ordered_json document = nlohmann::ordered_json::array();
  std::vector<std::vector<std::string>> rows;
  for (const v1::AdjustedAssembly& design : designs) {
    const std::array<double, 3> size = OverallSize(design);
    rows.push_back({absl::StrCat(rows.size() + 1), absl::StrCat(design.parts_size()),
                    Millimetres(size[0]), Millimetres(size[1]), Millimetres(size[2]),
                    absl::StrCat(design.faults_size())});
    if (!output.text()) document.push_back(ToJson(design));
  }
  output.Table({"sample", "parts", "x", "y", "z", "faults"}, rows);
  output.Document(document);
  return absl::OkStatus();
}

void AddList(CLI::App& assembly, Session& session) {
  auto options = std::make_shared<ListOptions>();
  CommandFlags flags(*assembly.add_subcommand("list", "List the assemblies"));
  flags.Add("--item", options->item, "Only those that use this item", "item");
  flags.Add("--text", options->text, "Only those with these words in id, title or description",
            "text");
  AddFilterOptions(flags, options->filter);
  flags.command().footer("Example: mortise assembly list --text table");
  flags.Run(session, [options](Session& s, Output& o) { return List(*options, s, o); });
}

}  // namespace

void AddAssemblyCommands(CLI::App& app, Session& session) {
  CLI::App* assembly =
      app.add_subcommand("assembly", "Designs as drawn, and what they can be changed to");
  assembly->require_subcommand(1);

  AddAssemblyFileCommands(*assembly, session);
  AddAssemblyDelete(*assembly, session);

  AddList(*assembly, session);

  auto name = std::make_shared<std::string>();
  CommandFlags show(
      *assembly->add_subcommand("show", "What of an assembly can be changed, how far"));
  show.Add("assembly", *name, "Such as bookshelf", "name")->required();
  show.command().footer("Example: mortise assembly show bookshelf");
  show.Run(session, [name](Session& s, Output& o) { return Show(*name, s, o); });

  auto adjust_options = std::make_shared<AdjustOptions>();
  CommandFlags adjust(*assembly->add_subcommand(
      "adjust", "The design nearest to one that meets what is asked for"));
  adjust.Add("assembly", adjust_options->subject, "Such as bookshelf", "name")->required();
  adjust.Add("--set", adjust_options->demands,
             "ELEMENT.x=VALUE, or y, or z: a size; ELEMENT.z.maximum=VALUE, or minimum, or center: "
             "a place",
             "demands");
  adjust.Add("--from", adjust_options->from,
             "Start at a design that 'assembly adjust --json' printed");
  adjust.command().add_flag(
      "--strict", adjust_options->strict,
      "Refuse what cannot be met instead of coming near; fail if the design has faults");
  adjust.Add("--step", adjust_options->step, "Also write a STEP file");
  adjust.Add("--glb", adjust_options->glb, "Also write a GLB file");
  adjust.command().footer(
      "Example: mortise assembly adjust bookshelf --set side.z=1.5 --glb shelf.glb");
  adjust.Run(session, [adjust_options](FieldSources& sources, Session& s, Output& o) {
    sources.Add("q", adjust_options->from.empty() ? "assembly" : "--from");
    return Adjust(*adjust_options, s, o);
  });

  auto sample_options = std::make_shared<SampleOptions>();
  CommandFlags sample(*assembly->add_subcommand("sample", "Designs spread over all it can be"));
  sample.Add("assembly", sample_options->subject, "Such as bookshelf", "name")->required();
  sample.Add("--count", sample_options->count, "How many, 1 to 1000", "count")
      ->capture_default_str();
  sample.Add("--seed", sample_options->seed, "The same seed gives the same designs")
      ->capture_default_str();
  sample.command().footer("Example: mortise assembly sample bookshelf --count 5 --seed 7");
  sample.Run(session,
             [sample_options](Session& s, Output& o) { return Sample(*sample_options, s, o); });
  // Last: commands would inherit it.
  assembly->footer("Example: mortise assembly list");
}

}  // namespace mortise::cli
