// The catalog's records: materials, items and templates in the store, as messages.
//
// A template revision is kept together with the items and materials it uses, as they were when it
// was imported, so that F(q) of a revision never changes and its digest says all of it.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/design/template_validation.h"
#include "common/resources/author.h"
#include "common/resources/record_page.h"
#include "common/store/store.h"
#include "common/templates/template_codec.h"
#include "mortise/v1/catalog.pb.h"

namespace mortise::catalog {

using resources::Page;

// ---- Materials and items -----------------------------------------------------------------------

// `name` is a resource name; NOT_FOUND, or INVALID_ARGUMENT naming "name" or "revision" (0: the
// latest).
absl::StatusOr<v1::Material> GetMaterial(store::ReadTransaction& transaction,
                                         const std::string& name, int64_t revision = 0);
absl::StatusOr<v1::Item> GetItem(store::ReadTransaction& transaction, const std::string& name,
                                 int64_t revision = 0);

// In the order of names, only those that meet all of the request's filters. INVALID_ARGUMENT naming
// page_size, page_token, text, fields of filter, or of items material.
absl::StatusOr<Page<v1::Material>> ListMaterials(store::ReadTransaction& transaction,
                                                 const v1::ListMaterialsRequest& request);
absl::StatusOr<Page<v1::Item>> ListItems(store::ReadTransaction& transaction,
                                         const v1::ListItemsRequest& request);

// Returns what is wrong with an item and its tags, given the materials and shapes there are; fields
// are those of the item.
absl::StatusOr<std::vector<FieldViolation>> CheckItem(store::ReadTransaction& transaction,
                                                      const v1::Item& item);

// Writes a new record, created by the author, and tells of it ("material.created", "item.created").
// ALREADY_EXISTS; INVALID_ARGUMENT with what is wrong.
absl::StatusOr<v1::Material> CreateMaterial(store::Transaction& transaction,
                                            const v1::Material& material,
                                            const resources::Author& author);
absl::StatusOr<v1::Item> CreateItem(store::Transaction& transaction, const v1::Item& item,
                                    const resources::Author& author);

// Writes the fields that the mask names, all if it is empty ("material.updated", "item.updated");
// who created it, and when, stays. ABORTED if the revision in the request is not the present one.
absl::StatusOr<v1::Material> UpdateMaterial(store::Transaction& transaction,
                                            const v1::UpdateMaterialRequest& request,
                                            const resources::Author& author);
absl::StatusOr<v1::Item> UpdateItem(store::Transaction& transaction,
                                    const v1::UpdateItemRequest& request,
                                    const resources::Author& author);

// What became of a thing that takes the place of what is there under its name.
struct Replacement {
  int64_t before = 0;    // the revision that was there; 0 if there was none
  int64_t revision = 0;  // that is there now; the same if it says the same
};

// Creates a material or an item that has been checked, or makes it the next revision of what is
// there and says something else. What is there keeps its external ids and its labels where the
// message has none. Tells of it as the methods above do.
absl::StatusOr<Replacement> ReplaceMaterial(store::Transaction& transaction,
                                            const v1::Material& material,
                                            const resources::Author& author);
absl::StatusOr<Replacement> ReplaceItem(store::Transaction& transaction, const v1::Item& item,
                                        const resources::Author& author);

// What is wrong with a material and its tags; fields are those of the material. OK if nothing is.
absl::Status CheckMaterial(const v1::Material& material);

// Removes a material ("material.deleted"). ABORTED for another revision; FAILED_PRECONDITION,
// MATERIAL_IN_USE, naming items that are made of it.
absl::Status DeleteMaterial(store::Transaction& transaction,
                            const v1::DeleteMaterialRequest& request,
                            const resources::Author& author);

// Removes an item ("item.deleted"). ABORTED for another revision; FAILED_PRECONDITION, ITEM_IN_USE,
// naming the templates and assemblies whose latest revision uses it.
absl::Status DeleteItem(store::Transaction& transaction, const v1::DeleteItemRequest& request,
                        const resources::Author& author);

// Adds those of the items named that exist, and their materials, in the order of names.
absl::Status AddItems(store::ReadTransaction& transaction, const std::set<std::string>& names,
                      google::protobuf::RepeatedPtrField<v1::Item>& items,
                      google::protobuf::RepeatedPtrField<v1::Material>& materials);

// ---- Templates ---------------------------------------------------------------------------------

// Returns a template revision (0: the latest) and all it uses but shapes, which AddShapes adds.
absl::StatusOr<v1::TemplateBundle> GetBundle(store::ReadTransaction& transaction,
                                             const std::string& name, int64_t revision);

// Latest revisions without what they are made of, in the order of names; only those that meet all
// of the request's filters. INVALID_ARGUMENT naming page_size, page_token, item, text or fields of
// filter.
absl::StatusOr<Page<v1::Template>> ListTemplates(store::ReadTransaction& transaction,
                                                 const v1::ListTemplatesRequest& request);

// Returns the name that a template has where it is placed on these height fields, of which the
// digests are known: templates/{id}-{12 hexadecimal digits}.
std::string PlacedName(const std::string& name,
                       const google::protobuf::RepeatedPtrField<v1::HeightField>& height_fields);

// Writes a completed bundle of a template that is placed on ground as ImportBundle does, as the
// first revision of its name or the one after the latest. What is there keeps its external ids and
// its labels where the template has none. ALREADY_EXISTS if what is there is no placing of the same
// template.
absl::StatusOr<v1::Template> PutPlaced(store::Transaction& transaction, v1::TemplateBundle bundle,
                                       const resources::Author& author);

// Returns the template with those items and materials it names that exist, or with the assembly
// that it is of and what that uses. INVALID_ARGUMENT, "assembly.assembly", for one there is not.
// What makes it whole is templates::Complete.
absl::StatusOr<v1::TemplateBundle> Freeze(store::ReadTransaction& transaction,
                                          const v1::Template& message);

// Writes a completed bundle as the revision after `expected_revision` ("template.imported") and
// returns the template; the creator stays that of the revision before. If the present revision has
// the same content and tags, that is returned and nothing changes. One of the same content stays
// what it was placed of. ABORTED if the latest revision is not `expected_revision`.
absl::StatusOr<v1::Template> ImportBundle(store::Transaction& transaction,
                                          v1::TemplateBundle bundle, int64_t expected_revision,
                                          const resources::Author& author);

// Removes a template ("template.deleted"); its revisions stay readable by number, for what was made
// of them. NOT_FOUND; ABORTED for another revision.
absl::Status DeleteTemplate(store::Transaction& transaction,
                            const v1::DeleteTemplateRequest& request,
                            const resources::Author& author);

}  // namespace mortise::catalog
