#include "services/catalog/service/design_methods.h"

#include <string>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/design/parameter_values.h"
#include "common/files/template_codec.h"
#include "common/host/chunk_stream.h"
#include "common/rpc/server_host.h"
#include "services/catalog/exchange/design_export.h"
#include "services/catalog/service/design_stream.h"
#include "services/catalog/service/evaluated_design_reply.h"
#include "services/catalog/service/template_reading.h"

namespace mortise::catalog::methods {
namespace {

using ParameterValues = google::protobuf::RepeatedPtrField<v1::ParameterValue>;
using ChunkWriter = std::shared_ptr<rpc::StreamWriter<v1::Chunk>>;

// A template and where to evaluate it.
struct Choice {
  std::shared_ptr<const templates::Template> design_template;
  Eigen::VectorXd q;
};

// A design with the template it came from.
struct NamedDesign {
  std::shared_ptr<const templates::Template> design_template;
  Eigen::VectorXd q;
  parametric::EvaluatedDesign design;
};

// F and the given parameters, rounded to what a workshop can set.
absl::StatusOr<Choice> Choose(Catalog& catalog, const std::string& name, int64_t revision,
                              const ParameterValues& values) {
  MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle, FindBundle(catalog, name, revision));
  MORTISE_ASSIGN_OR_RETURN(
      std::shared_ptr<const templates::Template> design_template,
      catalog.compiled.Get(std::move(bundle), [&catalog](v1::TemplateBundle& needed) {
        return AddShapesTo(catalog, needed);
      }));
  const std::vector<parametric::Parameter>& parameters = design_template->parameters();
  MORTISE_ASSIGN_OR_RETURN(
      Eigen::VectorXd q, parametric::CompleteParameters(parameters, parametric::FromProto(values)));
  q = parametric::RoundToSteps(parameters, q);
  return Choice{std::move(design_template), std::move(q)};
}

// Whether there is such a file, of whatever template.
absl::Status CheckFile(const v1::ExportDesignRequest& asked) {
  if (asked.format() != v1::ExportDesignRequest::DESIGN) return KindOf(asked.format()).status();
  if (asked.rest_pose().empty()) return absl::OkStatus();
  return InvalidField("rest_pose", "of a DESIGN there is only the pose it is drawn in");
}

// What a file is made of. Everything that is wrong with the request is told.
absl::StatusOr<Choice> ChooseFor(Catalog& catalog, const v1::ExportDesignRequest& asked) {
  absl::StatusOr<Choice> choice =
      Choose(catalog, asked.name(), asked.revision(), asked.parameters());
  MORTISE_RETURN_IF_ERROR(CombineViolations(CheckFile(asked), choice.status()));
  return choice;
}

absl::StatusOr<NamedDesign> Evaluate(Choice choice) {
  MORTISE_ASSIGN_OR_RETURN(parametric::EvaluatedDesign design,
                           choice.design_template->Evaluate(choice.q));
  return NamedDesign{std::move(choice.design_template), std::move(choice.q), std::move(design)};
}

// The evaluated design itself, as large as it may be.
absl::Status ExportMessage(const NamedDesign& evaluated, const ChunkWriter& writer) {
  v1::EvaluatedDesign design = parametric::ToProto(evaluated.design);
  MORTISE_RETURN_IF_ERROR(AddFaults(*evaluated.design_template, evaluated.q, design));
  rpc::StreamBytes(design.SerializeAsString(), {"design.binpb", "application/x-protobuf"}, writer);
  return absl::OkStatus();
}

// What a STEP file says of the design besides its shapes; nothing for others.
absl::StatusOr<DesignIdentity> IdentityFor(const Catalog& catalog,
                                           const v1::ExportDesignRequest& asked,
                                           const NamedDesign& evaluated) {
  if (asked.format() != v1::ExportDesignRequest::STEP) return DesignIdentity{};
  MORTISE_ASSIGN_OR_RETURN(
      const v1::TemplateBundle bundle,
      FindBundle(catalog, asked.name(), evaluated.design_template->head().revision));
  return IdentityOf(bundle.template_(), bundle.items());
}

// The design as a file of solids or triangles, which is called `id`.
absl::StatusOr<std::string> FileOf(const NamedDesign& evaluated,
                                   v1::ExportDesignRequest::Format format, const std::string& id,
                                   const DesignIdentity& identity) {
  if (format != v1::ExportDesignRequest::STEP) {
    return ExportMesh(evaluated.design, {}, MeshFormatOf(format), id);
  }
  MORTISE_ASSIGN_OR_RETURN(const std::vector<cad::Solid> solids,
                           evaluated.design_template->Solids(evaluated.q));
  return ExportStep(evaluated.design, solids, id, identity);
}

}  // namespace

absl::StatusOr<v1::EvaluatedDesign> EvaluateTemplate(Catalog& catalog, const rpc::Call&,
                                                     const v1::EvaluateTemplateRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(Choice choice,
                           Choose(catalog, asked.name(), asked.revision(), asked.parameters()));
  MORTISE_ASSIGN_OR_RETURN(const NamedDesign evaluated, Evaluate(std::move(choice)));
  v1::EvaluatedDesign answer = parametric::ToProto(evaluated.design);
  if (asked.without_triangles()) DropTriangles(answer);
  if (!asked.without_faults()) {
    MORTISE_RETURN_IF_ERROR(AddFaults(*evaluated.design_template, evaluated.q, answer));
  }
  if (answer.ByteSizeLong() > static_cast<std::size_t>(rpc::kMaxMessageBytes)) {
    return TooLarge("the design", "4 MiB: ask for it without_triangles, or export it as a file");
  }
  return answer;
}

absl::Status ExplainEvaluateTemplate(Catalog& catalog, const rpc::Call&,
                                     const v1::EvaluateTemplateRequest& asked) {
  return Choose(catalog, asked.name(), asked.revision(), asked.parameters()).status();
}

absl::Status ExportDesign(Catalog& catalog, const rpc::Call&, const v1::ExportDesignRequest& asked,
                          const ChunkWriter& writer) {
  MORTISE_ASSIGN_OR_RETURN(Choice choice, ChooseFor(catalog, asked));
  MORTISE_ASSIGN_OR_RETURN(const NamedDesign evaluated, Evaluate(std::move(choice)));
  if (asked.format() == v1::ExportDesignRequest::DESIGN) return ExportMessage(evaluated, writer);
  MORTISE_ASSIGN_OR_RETURN(const FileKind kind, KindOf(asked.format()));
  const std::string id = asked.name().substr(asked.name().find('/') + 1);
  MORTISE_ASSIGN_OR_RETURN(const DesignIdentity identity, IdentityFor(catalog, asked, evaluated));
  MORTISE_ASSIGN_OR_RETURN(const auto assembly, evaluated.design_template->AssemblyAt(evaluated.q));
  if (assembly) {
    return StreamAssembly(
        {*assembly->assembly, assembly->q, evaluated.design, asked.rest_pose(), identity},
        asked.format(), id, evaluated.design_template->head().title, writer);
  }
  if (!asked.rest_pose().empty()) {
    return InvalidField("rest_pose", "only assembly templates have rest poses");
  }
  MORTISE_ASSIGN_OR_RETURN(std::string bytes, FileOf(evaluated, asked.format(), id, identity));
  rpc::StreamBytes(std::move(bytes), {id + kind.extension, kind.media_type}, writer);
  return absl::OkStatus();
}

absl::Status ExplainExportDesign(Catalog& catalog, const rpc::Call&,
                                 const v1::ExportDesignRequest& asked) {
  return ChooseFor(catalog, asked).status();
}

}  // namespace mortise::catalog::methods
