// What the catalog refuses, and what it says then.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "common/base/violation_lists.h"
#include "tests/integration/services/catalog/catalog_service_fixture.h"

namespace mortise::catalog {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;
using ::testing::UnorderedElementsAreArray;

std::vector<std::string> FieldsRefused(const absl::Status& refused) {
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument) << refused;
  std::vector<std::string> fields;
  for (const FieldViolation& violation : AllViolationsOf(refused)) {
    fields.push_back(violation.field);
  }
  return fields;
}

// Clients without a command line read them, too.
TEST_F(CatalogServiceTest, OffersNamesThatMayBeMeant) {
  using Stub = v1::CatalogService::Stub;
  v1::GetTemplateRequest of_template;
  of_template.set_name("templates/tabel");
  EXPECT_THAT(Fail(&Stub::GetTemplate, of_template).message,
              HasSubstr("did you mean 'templates/table'?"));
  v1::GetItemRequest item;
  item.set_name("items/dowel-8x53");
  const auto missing = Fail(&Stub::GetItem, item);
  EXPECT_EQ(missing.code, absl::StatusCode::kNotFound);
  EXPECT_EQ(missing.field, "items/dowel-8x53");
  EXPECT_THAT(missing.message, HasSubstr("did you mean 'items/dowel-8x"));
  v1::GetMaterialRequest material;
  material.set_name("materials/spruse");
  EXPECT_THAT(Fail(&Stub::GetMaterial, material).message,
              HasSubstr("did you mean 'materials/spruce'?"));
  v1::ListTemplatesRequest templates;
  templates.set_item("items/dowel-8x53");
  EXPECT_THAT(Fail(&Stub::ListTemplates, templates).message,
              HasSubstr("did you mean 'items/dowel"));
  v1::EvaluateTemplateRequest evaluation;
  evaluation.set_name("templates/table");
  evaluation.add_parameters()->set_name("lenght");
  EXPECT_THAT(Fail(&Stub::EvaluateTemplate, evaluation).message,
              HasSubstr("did you mean 'length'?"));
  // Nothing is like it.
  item.set_name("items/unobtainium");
  EXPECT_EQ(Fail(&Stub::GetItem, item).message, "there is no 'items/unobtainium'");
}

TEST_F(CatalogServiceTest, OffersItemsThatTemplatesMayMean) {
  v1::Template message = GetTemplate("templates/table");
  message.mutable_parts(0)->set_item("items/spruce-planed-2040");
  const auto refused =
      Fail(&v1::CatalogService::Stub::ImportTemplate, ImportRequest(message, message.revision()));
  EXPECT_EQ(refused.code, absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(refused.message, HasSubstr("did you mean 'items/spruce-planed-2400'?"));
}

TEST_F(CatalogServiceTest, RefusesBadReads) {
  using Stub = v1::CatalogService::Stub;
  v1::GetMaterialRequest material;
  material.set_name("cheese");
  EXPECT_EQ(Fail(&Stub::GetMaterial, material).field, "name");
  v1::GetItemRequest item;
  item.set_name("items/unobtainium");
  EXPECT_EQ(Fail(&Stub::GetItem, item).code, absl::StatusCode::kNotFound);
  item.set_name("items/../../etc/passwd");
  EXPECT_EQ(Fail(&Stub::GetItem, item).field, "name");
  v1::ListMaterialsRequest materials;
  materials.set_page_size(-1);
  EXPECT_EQ(Fail(&Stub::ListMaterials, materials).field, "page_size");
  v1::ListItemsRequest items;
  items.set_page_size(1001);
  EXPECT_EQ(Fail(&Stub::ListItems, items).field, "page_size");
  items.set_page_size(1);
  for (const char* made_up : {"'; drop table", "a", "screw-4x40"}) {
    items.set_page_token(made_up);
    EXPECT_EQ(Fail(&Stub::ListItems, items).field, "page_token") << made_up;
  }
  // A token belongs to its list and its filters.
  items.clear_page_token();
  v1::ListItemsResponse first;
  ASSERT_TRUE(Call(&Stub::ListItems, items, &first).ok());
  ASSERT_FALSE(first.next_page_token().empty());
  items.set_page_token(first.next_page_token());
  items.set_page_size(2);
  ASSERT_TRUE(Call(&Stub::ListItems, items, &first).ok());
  items.set_text("screw");
  EXPECT_EQ(Fail(&Stub::ListItems, items).field, "page_token");
  materials.Clear();
  materials.set_page_token(items.page_token());
  EXPECT_EQ(Fail(&Stub::ListMaterials, materials).field, "page_token");
  items.Clear();
  items.set_kind(static_cast<v1::ItemKind>(99));
  EXPECT_EQ(Fail(&Stub::ListItems, items).field, "kind");
  items.Clear();
  for (const char* unknown :
       {"materials/unobtainium", "oak", "items/screw-4x40", "materials/../x"}) {
    items.set_material(unknown);
    const Failure failure = Fail(&Stub::ListItems, items);
    EXPECT_EQ(failure.code, absl::StatusCode::kInvalidArgument) << unknown;
    EXPECT_EQ(failure.field, "material") << unknown;
  }
  items.Clear();
  items.set_text(std::string(201, 'x'));
  EXPECT_EQ(Fail(&Stub::ListItems, items).field, "text");
  item.set_name("items/screw-4x40");
  item.set_revision(-1);
  EXPECT_EQ(Fail(&Stub::GetItem, item).field, "revision");
  item.set_revision(2);
  EXPECT_EQ(Fail(&Stub::GetItem, item).code, absl::StatusCode::kNotFound);
  v1::ListTemplatesRequest templates;
  templates.set_page_token("NOT A TOKEN");
  EXPECT_EQ(Fail(&Stub::ListTemplates, templates).field, "page_token");
  templates.Clear();
  templates.set_item("items/unobtainium");
  EXPECT_EQ(Fail(&Stub::ListTemplates, templates).field, "item");
  templates.set_item("dowel");
  EXPECT_EQ(Fail(&Stub::ListTemplates, templates).field, "item");
  templates.Clear();
  templates.set_text(std::string(201, 'x'));
  EXPECT_EQ(Fail(&Stub::ListTemplates, templates).field, "text");
  materials.Clear();
  materials.set_text(std::string(201, 'x'));
  EXPECT_EQ(Fail(&Stub::ListMaterials, materials).field, "text");
  v1::GetTemplateRequest revision;
  revision.set_name("templates/table");
  revision.set_revision(-1);
  EXPECT_EQ(Fail(&Stub::GetTemplate, revision).field, "revision");
  revision.set_revision(99);
  EXPECT_EQ(Fail(&Stub::GetTemplate, revision).code, absl::StatusCode::kNotFound);
  v1::GetTemplateBundleRequest bundle;
  bundle.set_name("");
  EXPECT_EQ(Fail(&Stub::GetTemplateBundle, bundle).field, "name");
}

TEST_F(CatalogServiceTest, TellsAllThatIsWrongWithAList) {
  using Stub = v1::CatalogService::Stub;
  v1::ListItemsRequest items;
  items.set_page_size(-1);
  items.set_text(std::string(201, 'x'));
  items.set_material("materials/cheese");
  v1::ListItemsResponse no_items;
  EXPECT_THAT(FieldsRefused(rpc::FromGrpc(Call(&Stub::ListItems, items, &no_items))),
              UnorderedElementsAre("page_size", "text", "material"));
  v1::ListTemplatesRequest templates;
  templates.set_page_size(1001);
  templates.set_text(std::string(201, 'x'));
  templates.set_item("dowel");
  v1::ListTemplatesResponse no_templates;
  EXPECT_THAT(FieldsRefused(rpc::FromGrpc(Call(&Stub::ListTemplates, templates, &no_templates))),
              UnorderedElementsAre("page_size", "text", "item"));
}

TEST_F(CatalogServiceTest, RefusesBadParameters) {
  using Stub = v1::CatalogService::Stub;
  const auto evaluate = [&](const std::string& name, double value) {
    v1::EvaluateTemplateRequest request;
    request.set_name("templates/table");
    request.add_parameters()->set_name(name);
    request.mutable_parameters(0)->set_value(value);
    const Failure failure = Fail(&Stub::EvaluateTemplate, request);
    EXPECT_EQ(failure.code, absl::StatusCode::kInvalidArgument);
    return failure.field;
  };
  EXPECT_EQ(evaluate("depth", 1), "parameters[0].name");
  EXPECT_EQ(evaluate("length", -1), "parameters[0].value");
  EXPECT_EQ(evaluate("length", NAN), "parameters[0].value");
  EXPECT_EQ(evaluate("length", std::numeric_limits<double>::infinity()), "parameters[0].value");

  // One that is no number hides no other fault.
  const auto add = [](auto& request, const std::string& name, double value) {
    request.add_parameters()->set_name(name);
    request.mutable_parameters(request.parameters_size() - 1)->set_value(value);
  };
  const auto spoil = [&](auto& spoiled) {
    spoiled.set_name("templates/table");
    add(spoiled, "width", NAN);
    add(spoiled, "depth", 1);
    add(spoiled, "length", 100);
    add(spoiled, "width", 0.6);
    add(spoiled, "breadth", -std::numeric_limits<double>::infinity());
  };
  const std::vector<std::string> faults = {"parameters[0].value", "parameters[1].name",
                                           "parameters[2].value", "parameters[3].name",
                                           "parameters[4].value", "parameters[4].name"};
  v1::EvaluateTemplateRequest spoiled;
  spoil(spoiled);
  v1::EvaluatedDesign none;
  EXPECT_THAT(FieldsRefused(rpc::FromGrpc(Call(&Stub::EvaluateTemplate, spoiled, &none))),
              UnorderedElementsAreArray(faults));
  v1::ExportDesignRequest file;
  spoil(file);
  std::vector<std::string> of_file = faults;
  of_file.push_back("format");
  EXPECT_THAT(FieldsRefused(Export(file).status()), UnorderedElementsAreArray(of_file));
  file.set_format(v1::ExportDesignRequest::DESIGN);
  file.set_rest_pose("open");
  of_file.back() = "rest_pose";
  EXPECT_THAT(FieldsRefused(Export(file).status()), UnorderedElementsAreArray(of_file));
  // Of a template that is not there, only what the request shows by itself.
  spoiled.set_name("templates/none");
  EXPECT_THAT(FieldsRefused(rpc::FromGrpc(Call(&Stub::EvaluateTemplate, spoiled, &none))),
              UnorderedElementsAre("parameters[0].value", "parameters[4].value"));

  v1::ExportDesignRequest request;
  request.set_name("templates/table");
  EXPECT_EQ(DetailOf(Export(request).status()).field, "format");
  request.set_format(static_cast<v1::ExportDesignRequest::Format>(9));
  EXPECT_EQ(DetailOf(Export(request).status()).field, "format");
  request.set_format(v1::ExportDesignRequest::GLB);
  request.set_name("templates/none");
  EXPECT_EQ(Export(request).status().code(), absl::StatusCode::kNotFound);
}

TEST_F(CatalogServiceTest, RefusesBadItemsAndMaterials) {
  using Stub = v1::CatalogService::Stub;
  const v1::Item dowel = GetItem("items/dowel-8x35");
  const auto create = [&](const std::function<void(v1::Item&)>& spoil) {
    v1::CreateItemRequest request;
    request.set_request_id(NewRequestId());
    *request.mutable_item() = dowel;
    request.mutable_item()->set_name("items/new-dowel");
    spoil(*request.mutable_item());
    return Fail(&Stub::CreateItem, request);
  };
  EXPECT_EQ(create([](v1::Item& item) { item.set_name("items/dowel-8x35"); }).code,
            absl::StatusCode::kAlreadyExists);
  EXPECT_EQ(create([](v1::Item& item) { item.set_name("Dowel"); }).field, "item.name");
  EXPECT_EQ(create([](v1::Item& item) { item.set_material("materials/air"); }).field,
            "item.material");
  EXPECT_EQ(create([](v1::Item& item) { item.mutable_dimensions(0)->set_size(-0.035); }).field,
            "item.dimensions[X].size");
  EXPECT_EQ(create([](v1::Item& item) { item.mutable_dimensions(0)->set_size(NAN); }).field,
            "item.dimensions[0].size");
  EXPECT_EQ(create([](v1::Item& item) { item.mutable_dimensions()->RemoveLast(); }).field,
            "item.dimensions");
  EXPECT_EQ(create([](v1::Item& item) { item.set_kind(v1::ITEM_KIND_UNSPECIFIED); }).field,
            "item.kind");
  EXPECT_EQ(create([](v1::Item& item) { item.set_title(std::string(5000, 'x')); }).field,
            "item.title");
  EXPECT_EQ(create([](v1::Item& item) { item.add_measures()->set_size(-1); }).field,
            "item.measures[0].size");
  EXPECT_EQ(create([](v1::Item& item) { item.add_stock_sizes()->set_length(1); }).field,
            "item.stock_sizes");
  EXPECT_EQ(create([](v1::Item& item) { item.add_more_suppliers()->set_url("file:x"); }).field,
            "item.more_suppliers[0].url");
  // All at once, whether it can be read or not; nothing that only follows from the rest.
  const Failure several = create([](v1::Item& item) {
    item.set_name("Dowel");
    item.clear_kind();
    item.set_material("materials/air");
    item.mutable_dimensions(1)->set_axis(v1::X);
    item.mutable_dimensions(2)->set_size(-1);
    item.mutable_price()->set_currency("euro");
    item.set_price_basis(v1::PRICE_BASIS_UNSPECIFIED);
  });
  EXPECT_THAT(several.message, StartsWith("7 findings: "));
  for (const char* field :
       {"item.kind: ", "item.dimensions[1].axis: ", "item.price_basis: ", "item.name: ",
        "item.material: ", "item.dimensions[Z].size: ", "item.price.currency: "}) {
    EXPECT_THAT(several.message, HasSubstr(field));
  }
  v1::CreateItemRequest without_id;
  *without_id.mutable_item() = dowel;
  EXPECT_EQ(Fail(&Stub::CreateItem, without_id).field, "request_id");
  v1::CreateItemRequest huge;
  huge.set_request_id(NewRequestId());
  *huge.mutable_item() = dowel;
  huge.mutable_item()->set_title(std::string(5 << 20, 'x'));
  EXPECT_EQ(Fail(&Stub::CreateItem, huge).code, absl::StatusCode::kResourceExhausted);

  v1::UpdateItemRequest update;
  update.set_request_id(NewRequestId());
  *update.mutable_item() = dowel;
  update.mutable_item()->set_revision(5);
  EXPECT_EQ(Fail(&Stub::UpdateItem, update).code, absl::StatusCode::kAborted);
  update.mutable_item()->set_revision(1);
  update.mutable_update_mask()->add_paths("colour");
  EXPECT_EQ(Fail(&Stub::UpdateItem, update).field, "update_mask");
  update.mutable_update_mask()->set_paths(0, "name");
  EXPECT_EQ(Fail(&Stub::UpdateItem, update).field, "update_mask");
  update.clear_update_mask();
  update.mutable_item()->mutable_price()->set_amount(-1);
  EXPECT_EQ(Fail(&Stub::UpdateItem, update).field, "item.price.amount");
  EXPECT_EQ(GetItem("items/dowel-8x35").revision(), 1);

  v1::CreateMaterialRequest material;
  material.set_request_id(NewRequestId());
  material.mutable_material()->set_name("materials/glass");
  material.mutable_material()->set_density(2500);
  const Failure unfinished = Fail(&Stub::CreateMaterial, material);
  EXPECT_EQ(unfinished.field, "material.youngs_modulus");
  EXPECT_THAT(unfinished.message, HasSubstr("strength"));  // all findings at once
  v1::GetMaterialRequest spruce;
  spruce.set_name("materials/spruce");
  ASSERT_TRUE(Call(&Stub::GetMaterial, spruce, material.mutable_material()).ok());
  material.mutable_material()->set_name("materials/perpetual");
  material.mutable_material()->mutable_orthotropic()->set_poissons_ratio_lr(4);
  EXPECT_EQ(Fail(&Stub::CreateMaterial, material).field, "material.orthotropic.poissons_ratio_lr");
}

TEST_F(CatalogServiceTest, RefusesBadTemplatesAndSaysAllThatIsWrong) {
  using Stub = v1::CatalogService::Stub;
  const v1::Template table = GetTemplate("templates/table");
  const auto import = [&](const std::function<void(v1::Template&)>& spoil) {
    v1::Template spoilt = table;
    spoilt.set_name("templates/spoilt");
    spoil(spoilt);
    const Failure failure = Fail(&Stub::ImportTemplate, ImportRequest(spoilt, 0));
    EXPECT_EQ(failure.code, absl::StatusCode::kInvalidArgument) << failure.message;
    return failure;
  };
  EXPECT_EQ(import([](v1::Template& t) { t.set_name("spoilt"); }).field, "template.name");
  EXPECT_EQ(import([](v1::Template& t) { t.clear_parts(); }).field, "template.parts");
  EXPECT_EQ(import([](v1::Template& t) { t.mutable_parameters(0)->set_minimum(NAN); }).field,
            "template.parameters[0].minimum");
  EXPECT_EQ(import([](v1::Template& t) {
              t.mutable_parts(0)->set_length_axis(static_cast<v1::Axis>(12));
            }).field,
            "template.parts[0].length_axis");
  EXPECT_EQ(import([](v1::Template& t) { t.mutable_parts(1)->set_item("items/none"); }).field,
            "template.parts[1].item");
  const Failure several = import([](v1::Template& t) {
    t.mutable_parameters(2)->set_maximum(0);
    t.mutable_parts(0)->mutable_box()->mutable_x()->set_from("length +");
    t.mutable_connections(3)->set_face("nose");
  });
  EXPECT_EQ(several.field, "template.parameters[2].maximum");
  EXPECT_THAT(several.message, HasSubstr("3 findings"));
  EXPECT_THAT(several.message, HasSubstr("parts[0].box.x.from"));
  EXPECT_THAT(several.message, HasSubstr("connections[3].face"));
  const Failure unreadable = import([](v1::Template& t) {
    t.mutable_parts(0)->clear_length_axis();
    t.mutable_parts(0)->clear_box();
    t.mutable_parts(2)->clear_thickness_axis();
    t.mutable_boundary_conditions(1)->clear_kind();
  });
  EXPECT_THAT(unreadable.message, StartsWith("4 findings"));
  for (const char* field :
       {"template.parts[0].length_axis: ", "template.parts[0].body: ",
        "template.parts[2].thickness_axis: ", "template.boundary_conditions[1].kind: "}) {
    EXPECT_THAT(unreadable.message, HasSubstr(field));
  }
  // Own metrics and a revision that cannot be are faults among the others.
  v1::ImportTemplateRequest early = ImportRequest(table, -1);
  early.mutable_template_()->set_name("templates/spoilt");
  early.mutable_template_()->mutable_parts(1)->set_item("items/none");
  v1::MetricExpression& metric =
      *early.mutable_template_()->mutable_metric_definitions()->add_expressions();
  metric.set_name("slenderness");
  metric.set_unit("1");
  metric.set_expression("length / breadth");
  v1::Template none;
  EXPECT_THAT(FieldsRefused(rpc::FromGrpc(Call(&Stub::ImportTemplate, early, &none))),
              UnorderedElementsAre("expected_revision", "template.parts[1].item",
                                   "template.metric_definitions.expressions[0].expression"));
  early.set_expected_revision(7);  // there is none yet
  EXPECT_THAT(FieldsRefused(rpc::FromGrpc(Call(&Stub::ImportTemplate, early, &none))),
              UnorderedElementsAre("expected_revision", "template.parts[1].item",
                                   "template.metric_definitions.expressions[0].expression"));
  // Of metrics that use a parameter at fault nothing is said that follows from it.
  early.mutable_template_()->mutable_parameters(0)->set_unit("cubit");
  EXPECT_THAT(FieldsRefused(rpc::FromGrpc(Call(&Stub::ImportTemplate, early, &none))),
              UnorderedElementsAre("expected_revision", "template.parts[1].item",
                                   "template.parameters[0].unit"));
  v1::GetTemplateRequest request;
  request.set_name("templates/spoilt");
  EXPECT_EQ(Fail(&Stub::GetTemplate, request).code, absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace mortise::catalog
