#include "services/catalog/service/assembly_methods.h"

#include <set>
#include <utility>

#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/host/call_author.h"
#include "common/resources/collection.h"
#include "common/resources/resource_tags.h"
#include "services/catalog/exchange/assembly_import.h"
#include "services/catalog/exchange/part_annotations.h"
#include "services/catalog/records/assembly_records.h"
#include "services/catalog/records/drawing_records.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/shape_records.h"
#include "services/catalog/service/assembly_reading.h"

namespace mortise::catalog::methods {
namespace {

absl::StatusOr<v1::AssemblyBundle> FreezeNow(const Catalog& catalog, const v1::Assembly& assembly) {
  return resources::ReadFrom<v1::AssemblyBundle>(
      *catalog.store,
      [&](store::ReadTransaction& transaction) { return Freeze(transaction, assembly); });
}

// Whether a design can be made of it; kept for who asks for it next.
absl::StatusOr<templates::Parametrization> Parametrize(Catalog& catalog, const rpc::Call& call,
                                                       const v1::AssemblyBundle& bundle) {
  return catalog.parametrized.Get(bundle, [&call] { return call.cancelled(); });
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

absl::StatusOr<DrawnBundle> DrawnOf(Catalog& catalog, const rpc::Call& call,
                                    const v1::ImportAssemblyStepRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<parametric::Item> items,
                           ItemsOf(catalog, asked.annotations()));
  const absl::StatusOr<Drawing> read = catalog.drawings.Read(asked.step(), asked.drawing());
  if (absl::IsInvalidArgument(read.status())) {
    return Together(read.status(),
                    parametric::ToStatus(CheckWithoutDrawing(asked.annotations(), items)));
  }
  MORTISE_RETURN_IF_ERROR(read.status());
  const cad::StepAssembly& drawing = **read;
  DrawnAssembly drawn = MakeAssembly(drawing, asked.annotations(), items);
  MORTISE_ASSIGN_OR_RETURN(v1::AssemblyBundle bundle, FreezeNow(catalog, drawn.assembly));
  AddNewShapes(drawing, bundle);
  const absl::StatusOr<templates::Parametrization> made = Parametrize(catalog, call, bundle);
  MORTISE_RETURN_IF_ERROR(AtRequest(drawn, asked.annotations(), made.status()));
  const std::string held = NoteOnHeldSizes((*made)->HeldSizes());
  if (!held.empty()) drawn.notes.push_back(held);
  return DrawnBundle{std::move(bundle), std::move(drawn.notes)};
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
  const absl::Status faults =
      Together(Parametrize(catalog, call, bundle).status(), resources::ValidateTags(assembly));
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
  absl::StatusOr<DrawnBundle> prepared = DrawnOf(catalog, call, asked);
  // What is said of 'step' is said of the drawing that was uploaded instead.
  const bool renames = !prepared.ok() && !asked.drawing().empty();
  const absl::Status faults =
      Together(renames ? OfUpload(prepared.status()) : prepared.status(),
               UnderField("annotations", resources::ValidateTags(asked.annotations())));
  MORTISE_RETURN_IF_ERROR(WithRevisionFault(*catalog.store, kAssemblies, asked.annotations().name(),
                                            asked.expected_revision(), faults));
  return prepared;
}

absl::StatusOr<v1::ImportAssemblyStepResponse> ImportAssemblyStep(
    const rpc::Call& call, const v1::ImportAssemblyStepRequest& asked, DrawnBundle& drawn,
    store::Transaction& transaction) {
  v1::ImportAssemblyStepResponse answer;
  MORTISE_ASSIGN_OR_RETURN(
      *answer.mutable_assembly(),
      ImportBundle(transaction, drawn.bundle, asked.expected_revision(), rpc::AuthorOf(call)));
  answer.mutable_notes()->Assign(drawn.notes.begin(), drawn.notes.end());
  return answer;
}

absl::StatusOr<std::unique_ptr<rpc::UploadReader<v1::Chunk, v1::UploadDrawingResponse>>>
UploadDrawing(Catalog& catalog, const rpc::Call&) {
  return ReceiveDrawing(catalog.store, catalog.blobs);
}

}  // namespace mortise::catalog::methods
