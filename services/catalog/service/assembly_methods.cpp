#include "services/catalog/service/assembly_methods.h"

#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/host/call_author.h"
#include "common/mesh/length_unit.h"
#include "common/mesh/scenes/scene_format.h"
#include "common/resources/collection.h"
#include "common/resources/resource_tags.h"
#include "services/catalog/exchange/assembly_import.h"
#include "services/catalog/exchange/kept_annotations.h"
#include "services/catalog/exchange/part_annotations.h"
#include "services/catalog/records/assembly_records.h"
#include "services/catalog/records/drawing_records.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/shape_records.h"
#include "services/catalog/service/assembly_reading.h"
#include "services/catalog/service/import_progress.h"

namespace mortise::catalog::methods {
namespace {

absl::StatusOr<v1::AssemblyBundle> FreezeNow(const Catalog& catalog, const v1::Assembly& assembly) {
  return resources::ReadFrom<v1::AssemblyBundle>(
      *catalog.store,
      [&](store::ReadTransaction& transaction) { return Freeze(transaction, assembly); });
}

// Tells how far the import is that a call asks for.
template <typename Request>
ImportProgress ProgressOf(const Catalog& catalog, const rpc::Call& call, const Request& asked,
                          const std::string& assembly) {
  return {catalog.store, assembly, asked.request_id(), rpc::AuthorOf(call)};
}

// Whether a design can be made of it; kept for who asks for it next.
absl::StatusOr<templates::Parametrization> Parametrize(Catalog& catalog, const rpc::Call& call,
                                                       ImportProgress& progress,
                                                       const v1::AssemblyBundle& bundle) {
  return catalog.parametrized.Get(
      bundle, [&call] { return call.cancelled(); }, "",
      [&progress](const char* stage, std::int64_t done, std::int64_t total) {
        progress.Tell(stage, done, total);
      });
}

// Adds those of the drawing's shapes that parts have and that are not stored yet.
void AddNewShapes(const cad::StepAssembly& drawing, v1::AssemblyBundle& bundle) {
  std::set<std::string> missing;
  for (const v1::AssemblyPart& part : bundle.assembly().parts()) missing.insert(part.shape());
  for (const v1::Shape& shape : bundle.shapes()) missing.erase(shape.name());
  for (const mesh::DrawnShape& shape : drawing.shapes) {
    if (missing.erase(shape.name) != 0) *bundle.add_shapes() = NamedShape(shape);
  }
}

// The items that annotations name and that exist.
absl::StatusOr<std::vector<parametric::Item>> ItemsOf(const Catalog& catalog,
                                                      const v1::AssemblyAnnotations& annotations) {
  v1::Assembly named;
  for (const v1::PartAnnotation& part : annotations.parts()) {
    named.add_parts()->set_item(part.item());
  }
  MORTISE_ASSIGN_OR_RETURN(const v1::AssemblyBundle bundle, FreezeNow(catalog, named));
  MORTISE_ASSIGN_OR_RETURN(parametric::TemplateBundle used, UsedBy(bundle));
  return std::move(used.items);
}

// The items that are there still of those that the parts of a revision are made of.
absl::StatusOr<std::vector<parametric::Item>> ItemsOf(const Catalog& catalog,
                                                      const v1::Assembly& assembly) {
  v1::Assembly named;
  for (const v1::AssemblyPart& part : assembly.parts()) named.add_parts()->set_item(part.item());
  MORTISE_ASSIGN_OR_RETURN(const v1::AssemblyBundle bundle, FreezeNow(catalog, named));
  MORTISE_ASSIGN_OR_RETURN(parametric::TemplateBundle used, UsedBy(bundle));
  return std::move(used.items);
}

// What a drawing is annotated with.
struct Annotated {
  v1::AssemblyAnnotations annotations;
  std::vector<parametric::Item> items;  // that they name and that exist
  std::vector<std::string> notes;       // for people
};

// The annotations of a request; where they say nothing, those of the revision before, as far as
// they fit the drawing.
absl::StatusOr<Annotated> AnnotationsFor(const Catalog& catalog,
                                         const absl::StatusOr<Drawing>& read,
                                         const v1::AssemblyAnnotations& asked) {
  Annotated annotated;
  annotated.annotations = WithoutDropping(asked);
  if (read.ok() && KeepFormer(asked)) {
    const absl::StatusOr<v1::AssemblyBundle> before = FindAssembly(catalog, asked.name(), 0);
    if (before.ok()) {
      MORTISE_ASSIGN_OR_RETURN(annotated.items, ItemsOf(catalog, before->assembly()));
      KeptAnnotations kept = KeepAnnotations(before->assembly(), **read, asked, annotated.items);
      annotated.annotations = std::move(kept.annotations);
      annotated.notes = std::move(kept.notes);
      return annotated;
    }
    // A name that is malformed is told of with all else.
    const bool is_told =
        absl::IsNotFound(before.status()) || absl::IsInvalidArgument(before.status());
    if (!is_told) return before.status();
  }
  MORTISE_ASSIGN_OR_RETURN(annotated.items, ItemsOf(catalog, annotated.annotations));
  return annotated;
}

// The assembly of a drawing that was read, or why there is none.
absl::StatusOr<DrawnBundle> DrawnOf(Catalog& catalog, const rpc::Call& call,
                                    ImportProgress& progress, const absl::StatusOr<Drawing>& read,
                                    const v1::AssemblyAnnotations& asked) {
  MORTISE_ASSIGN_OR_RETURN(const Annotated annotated, AnnotationsFor(catalog, read, asked));
  const auto& [annotations, items, kept] = annotated;
  if (absl::IsInvalidArgument(read.status())) {
    return CombineViolations(read.status(),
                             parametric::ToStatus(CheckWithoutDrawing(annotations, items)));
  }
  MORTISE_RETURN_IF_ERROR(read.status());
  const cad::StepAssembly& drawing = **read;
  DrawnAssembly drawn = MakeAssembly(drawing, annotations, items);
  drawn.notes.insert(drawn.notes.begin(), kept.begin(), kept.end());
  MORTISE_ASSIGN_OR_RETURN(v1::AssemblyBundle bundle, FreezeNow(catalog, drawn.assembly));
  AddNewShapes(drawing, bundle);
  const absl::StatusOr<templates::Parametrization> made =
      Parametrize(catalog, call, progress, bundle);
  MORTISE_RETURN_IF_ERROR(AtRequest(drawn, annotations, made.status()));
  const std::string held = NoteOnHeldSizes((*made)->HeldSizes());
  if (!held.empty()) drawn.notes.push_back(held);
  return DrawnBundle{std::move(bundle), std::move(drawn.notes)};
}

// What is drawn, with what is wrong with the rest of the request. What is said of 'step' is said of
// `file`, the field of the request that has the drawing.
template <typename Request>
absl::StatusOr<DrawnBundle> Checked(const Catalog& catalog, const Request& asked,
                                    absl::StatusOr<DrawnBundle> prepared, const std::string& file,
                                    const absl::Status& others = absl::OkStatus()) {
  const absl::Status faults = CombineViolations(
      CombineViolations(
          prepared.ok() ? absl::OkStatus() : RenameField(prepared.status(), "step", file), others),
      UnderField("annotations", resources::ValidateTags(asked.annotations())));
  MORTISE_RETURN_IF_ERROR(WithRevisionFault(*catalog.store, kAssemblies, asked.annotations().name(),
                                            asked.expected_revision(), faults));
  return prepared;
}

// Stores what is drawn.
template <typename Response, typename Request>
absl::StatusOr<Response> Import(const rpc::Call& call, const Request& asked, DrawnBundle& drawn,
                                store::Transaction& transaction) {
  Response answer;
  MORTISE_ASSIGN_OR_RETURN(
      *answer.mutable_assembly(),
      ImportBundle(transaction, drawn.bundle, asked.expected_revision(), rpc::AuthorOf(call)));
  answer.mutable_notes()->Assign(drawn.notes.begin(), drawn.notes.end());
  return answer;
}

// How a mesh is to be read, with what is wrong with that in `faults`.
MeshDrawingOptions OptionsOf(const v1::ImportAssemblyMeshRequest& asked, absl::Status& faults) {
  MeshDrawingOptions options;
  options.up = mesh::UpAxisOf(asked.up());
  if (!asked.length_unit().empty()) {
    const absl::StatusOr<double> metres = mesh::MetresOf(asked.length_unit(), "length_unit");
    faults = CombineViolations(faults, metres.status());
    if (metres.ok()) options.unit = *metres;
  }
  faults = CombineViolations(faults, mesh::CheckFileName(asked.file_name()));
  const bool is_count =
      asked.most_parts() >= 0 && asked.most_parts() <= static_cast<std::int64_t>(kMaxMeshParts);
  if (!is_count) {
    faults = CombineViolations(
        faults, InvalidField("most_parts", absl::StrCat("must be 1 to ", kMaxMeshParts)));
  } else if (asked.most_parts() > 0) {
    options.most_parts = static_cast<std::size_t>(asked.most_parts());
  }
  return options;
}

}  // namespace

absl::StatusOr<v1::Assembly> GetAssembly(Catalog& catalog, const rpc::Call&,
                                         const v1::GetAssemblyRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(v1::AssemblyBundle bundle,
                           FindAssembly(catalog, asked.name(), asked.revision()));
  return std::move(*bundle.mutable_assembly());
}

absl::StatusOr<v1::ListAssembliesResponse> ListAssemblies(Catalog& catalog, const rpc::Call&,
                                                          const v1::ListAssembliesRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(Page<v1::Assembly> page,
                           resources::ReadFrom<Page<v1::Assembly>>(
                               *catalog.store, [&](store::ReadTransaction& transaction) {
                                 return catalog::ListAssemblies(transaction, asked);
                               }));
  return resources::ToResponse(std::move(page), &v1::ListAssembliesResponse::mutable_assemblies);
}

absl::StatusOr<v1::DeleteAssemblyResponse> DeleteAssembly(const rpc::Call& call,
                                                          const v1::DeleteAssemblyRequest& asked,
                                                          store::Transaction& transaction) {
  MORTISE_RETURN_IF_ERROR(catalog::DeleteAssembly(transaction, asked, rpc::AuthorOf(call)));
  return v1::DeleteAssemblyResponse();
}

absl::StatusOr<v1::AssemblyBundle> PrepareAssembly(Catalog& catalog, const rpc::Call& call,
                                                   const v1::ImportAssemblyRequest& asked) {
  const v1::Assembly& assembly = asked.assembly();
  MORTISE_ASSIGN_OR_RETURN(v1::AssemblyBundle bundle, FreezeNow(catalog, assembly));
  ImportProgress progress = ProgressOf(catalog, call, asked, assembly.name());
  const absl::Status faults = CombineViolations(
      Parametrize(catalog, call, progress, bundle).status(), resources::ValidateTags(assembly));
  MORTISE_RETURN_IF_ERROR(WithRevisionFault(*catalog.store, kAssemblies, assembly.name(),
                                            asked.expected_revision(),
                                            UnderField("assembly", faults)));
  return bundle;
}

absl::StatusOr<v1::Assembly> ImportAssembly(const rpc::Call& call,
                                            const v1::ImportAssemblyRequest& asked,
                                            v1::AssemblyBundle& bundle,
                                            store::Transaction& transaction) {
  return ImportBundle(transaction, bundle, asked.expected_revision(), rpc::AuthorOf(call));
}

absl::StatusOr<DrawnBundle> PrepareAssemblyStep(Catalog& catalog, const rpc::Call& call,
                                                const v1::ImportAssemblyStepRequest& asked) {
  ImportProgress progress = ProgressOf(catalog, call, asked, asked.annotations().name());
  cad::StepChildOptions reading;
  reading.progress = [&progress](std::size_t done, std::size_t total) {
    progress.Tell("reading solids", static_cast<std::int64_t>(done),
                  static_cast<std::int64_t>(total));
  };
  reading.is_given_up = [&call] { return call.cancelled(); };
  const absl::StatusOr<Drawing> read =
      catalog.drawings.Read(asked.step(), asked.drawing(), reading);
  return Checked(catalog, asked, DrawnOf(catalog, call, progress, read, asked.annotations()),
                 asked.drawing().empty() ? "step" : "drawing");
}

absl::StatusOr<v1::ImportAssemblyStepResponse> ImportAssemblyStep(
    const rpc::Call& call, const v1::ImportAssemblyStepRequest& asked, DrawnBundle& drawn,
    store::Transaction& transaction) {
  return Import<v1::ImportAssemblyStepResponse>(call, asked, drawn, transaction);
}

absl::StatusOr<DrawnBundle> PrepareAssemblyMesh(Catalog& catalog, const rpc::Call& call,
                                                const v1::ImportAssemblyMeshRequest& asked) {
  const std::string file = asked.drawing().empty() ? "file" : "drawing";
  absl::Status faults;
  const MeshDrawingOptions options = OptionsOf(asked, faults);
  absl::StatusOr<Drawing> read =
      catalog.drawings.ReadMesh(asked.file(), asked.drawing(), asked.file_name(), options);
  if (!read.ok()) read = RenameField(read.status(), "file", file);
  v1::AssemblyAnnotations annotations = asked.annotations();
  if (read.ok() && annotations.tolerance() == 0) annotations.set_tolerance(ToleranceOfMesh(**read));
  ImportProgress progress = ProgressOf(catalog, call, asked, annotations.name());
  return Checked(catalog, asked, DrawnOf(catalog, call, progress, read, annotations), file, faults);
}

absl::StatusOr<v1::ImportAssemblyMeshResponse> ImportAssemblyMesh(
    const rpc::Call& call, const v1::ImportAssemblyMeshRequest& asked, DrawnBundle& drawn,
    store::Transaction& transaction) {
  return Import<v1::ImportAssemblyMeshResponse>(call, asked, drawn, transaction);
}

absl::StatusOr<std::unique_ptr<rpc::UploadReader<v1::Chunk, v1::UploadDrawingResponse>>>
UploadDrawing(Catalog& catalog, const rpc::Call&) {
  return ReceiveDrawing(catalog.store, catalog.blobs);
}

}  // namespace mortise::catalog::methods
