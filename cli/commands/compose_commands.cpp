// mortise compose: new designs of pieces of others.
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/client/command_flags.h"
#include "cli/client/requests.h"
#include "cli/client/session.h"
#include "cli/commands/commands.h"
#include "cli/commands/compose_calls.h"
#include "cli/commands/compose_check_command.h"
#include "cli/commands/compose_list_commands.h"
#include "cli/commands/compose_suggest_command.h"
#include "cli/output/compose_output.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/composer.grpc.pb.h"

namespace mortise::cli {
namespace {

using Stub = v1::ComposerService::Stub;

// All commands take these: they say which model a command is about.
struct ModelOptions {
  std::string model;
  std::int64_t revision = 0;  // 0: the present one
  bool rebase = false;
  std::filesystem::path picture;
};

struct AddOptions : ModelOptions {
  std::string subject, group, id, at, turn;
  std::int64_t template_revision = 0;
  std::vector<std::string> demands;
};

// Commands that are about a component or a node take these.
struct NodeOptions : ModelOptions {
  std::string component, node, at, control, to;
  bool controls = false;
  bool preview = false;
  std::string axis = "z";
  int times = 1;
};

struct ForkOptions : ModelOptions {
  std::string id, title;
};

struct SaveOptions : ModelOptions {
  std::string id, title;
  bool with_loads = false;
};

// ---- What the commands have in common ----------------------------------------------------------

absl::StatusOr<v1::Model> Get(const GatewayClient& client, const ModelOptions& options) {
  v1::GetModelRequest request;
  request.set_name(ResourceName("models", options.model));
  return AskComposer(client, &Stub::GetModel, request);
}

absl::Status WritePicture(const GatewayClient& client, const ModelOptions& options,
                          Output& output) {
  if (options.picture.empty()) return absl::OkStatus();
  v1::DrawModelRequest request;
  request.set_name(ResourceName("models", options.model));
  MORTISE_ASSIGN_OR_RETURN(const v1::ModelPicture drawn,
                           AskComposer(client, &Stub::DrawModel, request));
  MORTISE_RETURN_IF_ERROR(WriteFile(options.picture, drawn.png()));
  output.Line(absl::StrCat("  ", options.picture.string()));
  return absl::OkStatus();
}

// Names the model and the revision that a request is about: the one that was said, or the present.
template <typename Request>
absl::Status Address(const GatewayClient& client, const ModelOptions& options, Request* request) {
  request->set_request_id(NewIdentifier());
  request->set_name(ResourceName("models", options.model));
  request->set_revision(options.revision);
  if (options.revision != 0) return absl::OkStatus();
  MORTISE_ASSIGN_OR_RETURN(const v1::Model present, Get(client, options));
  request->set_revision(present.revision());
  return absl::OkStatus();
}

// Makes a change, and shows what came of it; of one component what it snapped or was connected by.
template <typename Request>
absl::Status Change(grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, v1::Model*),
                    Request request, const ModelOptions& options, const std::string& component,
                    Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  MORTISE_RETURN_IF_ERROR(Address(*client, options, &request));
  if constexpr (requires { request.set_rebase(true); }) request.set_rebase(options.rebase);
  MORTISE_ASSIGN_OR_RETURN(const v1::Model model, AskComposer(*client, method, request));
  PrintModel(model, output);
  PrintComponent(model, component, output);
  return WritePicture(*client, options, output);
}

void AddModel(CommandFlags& flags, ModelOptions& options) {
  flags.Add("model", options.model, "Model, such as desk", "name")->required();
}

void AddChange(CommandFlags& flags, ModelOptions& options) {
  AddModel(flags, options);
  flags.Add("--revision", options.revision,
            "Only if the model has this revision; the present one if absent", "revision");
  flags.Add("--picture", options.picture, "PNG file for a picture of what came of it");
}

void AddRebase(CommandFlags& flags, ModelOptions& options) {
  flags.command().add_flag("--rebase", options.rebase,
                           "Of a newer revision than --revision, too, if what this is about has "
                           "not changed since");
}

// ---- The commands ------------------------------------------------------------------------------

absl::Status ShowControls(const GatewayClient& client, const NodeOptions& options, Output& output) {
  v1::GetNodeControlsRequest request;
  request.set_name(ResourceName("models", options.model));
  request.set_component(options.component);
  request.set_node(options.node);
  MORTISE_ASSIGN_OR_RETURN(const v1::NodeControls found,
                           AskComposer(client, &Stub::GetNodeControls, request));
  std::vector<std::vector<std::string>> rows;
  for (const v1::NodeControl& control : found.controls()) {
    rows.push_back({control.name(), Millimetres(control.value()), Millimetres(control.minimum()),
                    Millimetres(control.maximum())});
  }
  output.Table({"control", "now", "from", "to"}, rows);
  output.DocumentOf(found);
  return absl::OkStatus();
}

absl::Status Show(const NodeOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  if (options.controls || !options.node.empty() || !options.component.empty()) {
    MORTISE_RETURN_IF_ERROR(ShowControls(*client, options, output));
    return WritePicture(*client, options, output);
  }
  MORTISE_ASSIGN_OR_RETURN(const v1::Model model, Get(*client, options));
  PrintModel(model, output);
  for (const v1::ModelComponent& each : model.components()) {
    PrintComponent(model, each.id(), output);
  }
  return WritePicture(*client, options, output);
}

absl::Status Add(const AddOptions& options, Session& session, Output& output) {
  v1::AddComponentRequest request;
  request.set_component_id(options.id);
  request.set_template_(ResourceName("templates", options.subject));
  request.set_template_revision(options.template_revision);
  request.set_group(options.group);
  if (!options.at.empty()) {
    MORTISE_ASSIGN_OR_RETURN(*request.mutable_position(), ParseVector(options.at, "--at"));
  }
  for (const std::string& text : options.demands) {
    MORTISE_ASSIGN_OR_RETURN(*request.add_demands(), ParseDemand(text));
  }
  for (const char axis : options.turn) {
    MORTISE_ASSIGN_OR_RETURN(const v1::Axis about, ParseAxis(std::string(1, axis), "--turn"));
    request.add_turns(about);
  }
  return Change(&Stub::AddComponent, std::move(request), options, "", session, output);
}

absl::Status Snap(const NodeOptions& options, Session& session, Output& output) {
  v1::SnapComponentRequest request;
  request.set_component(options.component);
  request.set_preview(options.preview);
  return Change(&Stub::SnapComponent, std::move(request), options, options.component, session,
                output);
}

absl::Status Connect(const NodeOptions& options, Session& session, Output& output) {
  v1::ConnectComponentRequest request;
  request.set_component(options.component);
  return Change(&Stub::ConnectComponent, std::move(request), options, options.component, session,
                output);
}

absl::Status Move(const NodeOptions& options, Session& session, Output& output) {
  v1::MoveComponentRequest request;
  request.set_component(options.component);
  MORTISE_ASSIGN_OR_RETURN(*request.mutable_position(), ParseVector(options.at, "--at"));
  return Change(&Stub::MoveComponent, std::move(request), options, "", session, output);
}

absl::Status Turn(const NodeOptions& options, Session& session, Output& output) {
  v1::TurnComponentRequest request;
  request.set_component(options.component);
  MORTISE_ASSIGN_OR_RETURN(const v1::Axis axis, ParseAxis(options.axis, "--axis"));
  // Three quarters are one the other way.
  for (int turn = 0; turn < ((options.times % 4) + 4) % 4; ++turn) request.add_turns(axis);
  if (request.turns().empty()) return InvalidField("--times", "must not be whole turns");
  return Change(&Stub::TurnComponent, std::move(request), options, "", session, output);
}

absl::Status PreviewDrag(const NodeOptions& options, double value, Session& session,
                         Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  v1::PreviewDragRequest request;
  request.set_name(ResourceName("models", options.model));
  request.set_revision(options.revision);
  request.set_component(options.component);
  request.set_node(options.node);
  request.set_control(options.control);
  request.set_value(value);
  if (options.revision == 0) {
    MORTISE_ASSIGN_OR_RETURN(const v1::Model present, Get(*client, options));
    request.set_revision(present.revision());
  }
  MORTISE_ASSIGN_OR_RETURN(const v1::DragPreview preview,
                           AskComposer(*client, &Stub::PreviewDrag, request));
  PrintPreview(preview, output);
  return absl::OkStatus();
}

absl::Status Drag(const NodeOptions& options, Session& session, Output& output) {
  v1::DragControlRequest request;
  request.set_component(options.component);
  request.set_node(options.node);
  request.set_control(options.control);
  MORTISE_ASSIGN_OR_RETURN(const double value, ParseQuantity(options.to, "--to"));
  if (options.preview) return PreviewDrag(options, value, session, output);
  request.set_value(value);
  return Change(&Stub::DragControl, std::move(request), options, "", session, output);
}

absl::Status Remove(const NodeOptions& options, Session& session, Output& output) {
  v1::RemoveNodeRequest request;
  request.set_component(options.component);
  request.set_node(options.node);
  return Change(&Stub::RemoveNode, std::move(request), options, "", session, output);
}

absl::Status Fork(const ForkOptions& options, Session& session, Output& output) {
  v1::ForkModelRequest request;
  request.set_request_id(NewIdentifier());
  request.set_name(ResourceName("models", options.model));
  request.set_model_id(options.id);
  request.set_title(options.title);
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  MORTISE_ASSIGN_OR_RETURN(const v1::Model model, AskComposer(*client, &Stub::ForkModel, request));
  PrintModel(model, output);
  return absl::OkStatus();
}

absl::Status Save(const SaveOptions& options, Session& session, Output& output) {
  v1::SaveModelRequest request;
  request.set_template_id(options.id);
  request.set_title(options.title);
  request.set_with_loads(options.with_loads);
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  MORTISE_RETURN_IF_ERROR(Address(*client, options, &request));
  MORTISE_ASSIGN_OR_RETURN(const v1::SavedModel saved,
                           AskComposer(*client, &Stub::SaveModel, request));
  output.Line(absl::StrFormat("%s, revision %d, of %s", saved.template_(),
                              saved.template_revision(), saved.assembly()));
  MORTISE_ASSIGN_OR_RETURN(const v1::Model model, Get(*client, options));
  PrintWarnings(model, output);
  output.DocumentOf(saved);
  return WritePicture(*client, options, output);
}

absl::Status Delete(const ModelOptions& options, Session& session, Output& output) {
  v1::DeleteModelRequest request;
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  MORTISE_RETURN_IF_ERROR(Address(*client, options, &request));
  MORTISE_ASSIGN_OR_RETURN(const v1::DeleteModelResponse deleted,
                           AskComposer(*client, &Stub::DeleteModel, request));
  output.Line(absl::StrCat(request.name(), " deleted"));
  output.DocumentOf(deleted);
  return absl::OkStatus();
}

// ---- The command line --------------------------------------------------------------------------

void AddShow(CLI::App& compose, Session& session) {
  auto options = std::make_shared<NodeOptions>();
  CommandFlags show(*compose.add_subcommand("show", "A model, or what of a node can be dragged"));
  AddModel(show, *options);
  show.command().add_flag("--controls", options->controls,
                          "What can be dragged of the node, and how far");
  show.Add("--node", options->node, "Element or group; all of it if absent", "node");
  show.Add("--component", options->component, "Of this one, which is not connected yet",
           "component");
  show.Add("--picture", options->picture, "PNG file for a picture of it");
  show.command().footer("Example: mortise compose show desk --controls --node \"shelf 1\"");
  show.Run(session, [options](Session& s, Output& o) { return Show(*options, s, o); });
}

void AddAdd(CLI::App& compose, Session& session) {
  auto options = std::make_shared<AddOptions>();
  CommandFlags add(*compose.add_subcommand("add", "Drop a piece of a design into a model"));
  AddChange(add, *options);
  AddRebase(add, *options);
  add.Add("template", options->subject, "Template of an assembly, such as bookshelf", "template")
      ->required();
  add.Add("--group", options->group, "Group, part or row of it; all of it if absent", "group");
  add.Add("--id", options->id, "What it is called in the model", "component_id");
  add.Add("--at", options->at,
          "\"X, Y, Z\" of the middle of its lower side; where it is drawn if absent", "position");
  add.Add("--turn", options->turn,
          "Axes of quarter turns, such as z, or xzz for one about x and two about z", "turns");
  add.Add("--set", options->demands, "ELEMENT.x=VALUE, a size that it shall have; may be repeated",
          "demands");
  add.Add("--template-revision", options->template_revision, "Revision; the latest if absent",
          "template_revision");
  add.command().footer(
      "Example: mortise compose add desk bookshelf --group shelves --at \"0.4, 0.2, 0.5\"");
  add.Run(session, [options](Session& s, Output& o) { return Add(*options, s, o); });
}

using NodeCommand = absl::Status (*)(const NodeOptions&, Session&, Output&);

// The commands of a component that is not connected.
void AddComponentCommand(CLI::App& compose, Session& session, const std::string& name,
                         const std::string& help, const std::string& example, NodeCommand run) {
  auto options = std::make_shared<NodeOptions>();
  CommandFlags flags(*compose.add_subcommand(name, help));
  AddChange(flags, *options);
  AddRebase(flags, *options);
  flags.Add("component", options->component, "Component of the model", "component")->required();
  if (name == "snap") {
    flags.command().add_flag("--preview", options->preview, "Only tell what would become of it");
  }
  if (name == "move") {
    flags.Add("--at", options->at, "\"X, Y, Z\" of the middle of its lower side", "position")
        ->required();
  }
  if (name == "turn") {
    flags.Add("--axis", options->axis, "x, y or z, which it turns about; z if absent", "turns");
    flags.Add("--times", options->times,
              "How many quarter turns, against the clock; less than 0 with it; 1 if absent");
  }
  flags.command().footer("Example: mortise compose " + example);
  flags.Run(session, [options, run](Session& s, Output& o) { return run(*options, s, o); });
}

// The commands of a node of what is connected, or of a component that is not.
void AddNodeCommand(CLI::App& compose, Session& session, const std::string& name,
                    const std::string& help, const std::string& example, NodeCommand run) {
  auto options = std::make_shared<NodeOptions>();
  CommandFlags flags(*compose.add_subcommand(name, help));
  AddChange(flags, *options);
  AddRebase(flags, *options);
  flags.Add("--node", options->node, "Element, group or part", "node");
  flags.Add("--component", options->component, "Of this one, which is not connected yet",
            "component");
  if (name == "drag") {
    flags.Add("--control", options->control, "width, depth, height, x, y or z", "control")
        ->required();
    flags.Add("--to", options->to, "What it shall be, such as 1.2 or 1200mm", "value")->required();
    flags.command().add_flag("--preview", options->preview, "Only tell what would move");
  }
  flags.command().footer("Example: mortise compose " + example);
  flags.Run(session, [options, run](Session& s, Output& o) { return run(*options, s, o); });
}

template <typename Request>
void AddHistoryCommand(CLI::App& compose, Session& session, const std::string& name,
                       const std::string& help,
                       grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&,
                                                    v1::Model*)) {
  auto options = std::make_shared<ModelOptions>();
  CommandFlags flags(*compose.add_subcommand(name, help));
  AddChange(flags, *options);
  flags.command().footer("Example: mortise compose " + name + " desk");
  flags.Run(session, [options, method](Session& s, Output& o) {
    return Change(method, Request(), *options, "", s, o);
  });
}

void AddForkAndDelete(CLI::App& compose, Session& session) {
  auto forked = std::make_shared<ForkOptions>();
  CommandFlags fork(*compose.add_subcommand("fork", "Make another model of the state of one"));
  AddModel(fork, *forked);
  fork.Add("id", forked->id, "Id of the new model; chosen if absent", "model_id");
  fork.Add("--title", forked->title, "Its title, for people", "title");
  fork.command().footer("Example: mortise compose fork desk higher-desk");
  fork.Run(session, [forked](Session& s, Output& o) { return Fork(*forked, s, o); });

  auto deleted = std::make_shared<ModelOptions>();
  CommandFlags remove(*compose.add_subcommand("delete", "Remove a model with its history"));
  AddModel(remove, *deleted);
  remove.Add("--revision", deleted->revision,
             "Only if the model has this revision; the present one if absent", "revision");
  remove.command().footer("Example: mortise compose delete desk");
  remove.Run(session, [deleted](Session& s, Output& o) { return Delete(*deleted, s, o); });
}

void AddSave(CLI::App& compose, Session& session) {
  auto options = std::make_shared<SaveOptions>();
  CommandFlags save(
      *compose.add_subcommand("save", "Write a model into the catalog, as a template"));
  AddChange(save, *options);
  save.Add("--template", options->id, "Id of the template; that of the model if absent",
           "template_id");
  save.Add("--title", options->title, "Its title, for people; that of the model if absent",
           "title");
  save.command().add_flag("--with-loads", options->with_loads,
                          "With supports and loads, so that it can be analysed");
  save.command().footer("Example: mortise compose save desk --template desk-with-shelf");
  save.Run(session, [options](Session& s, Output& o) { return Save(*options, s, o); });
}

}  // namespace

void AddComposeCommands(CLI::App& app, Session& session) {
  CLI::App& compose = *app.add_subcommand("compose", "New designs of pieces of others");
  compose.require_subcommand(1);
  compose.footer("Example: mortise compose new desk");
  AddComposeNewAndList(compose, session);
  AddShow(compose, session);
  AddComposeCheckCommand(compose, session);
  AddComposeBillCommand(compose, session);
  AddComposeSuggestCommand(compose, session);
  AddAdd(compose, session);
  AddComponentCommand(compose, session, "snap", "Fit a component to the rest",
                      "snap desk shelf --picture snapped.png", Snap);
  AddComponentCommand(compose, session, "connect", "Make a component part of the rest",
                      "connect desk shelf", Connect);
  AddComponentCommand(compose, session, "move", "Move a component that is not connected",
                      "move desk shelf --at \"0.4, 0.2, 0.5\"", Move);
  AddComponentCommand(compose, session, "turn", "Turn a component that is not connected",
                      "turn desk shelf --axis z --times 1", Turn);
  AddNodeCommand(compose, session, "drag", "Drag a control of a node; all else follows",
                 "drag desk --node \"shelf 1\" --control width --to 1.2", Drag);
  AddNodeCommand(compose, session, "remove", "Take a node or component out of a model",
                 "remove desk --node \"shelf 1\"", Remove);
  AddHistoryCommand(compose, session, "undo", "Go back to the state before the last change",
                    &Stub::UndoModel);
  AddHistoryCommand(compose, session, "redo", "Take back what was undone last", &Stub::RedoModel);
  AddComposeHistoryCommand(compose, session);
  AddForkAndDelete(compose, session);
  AddSave(compose, session);
  AddComposeRunCommand(compose, session);
}

}  // namespace mortise::cli
