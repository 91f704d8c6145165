// Conversion between structs and messages loses nothing and refuses what structs cannot hold.
#include <gmock/gmock.h>
#include <google/protobuf/util/message_differencer.h>
#include <gtest/gtest.h>

#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/files/template_codec.h"
#include "tests/unit/common/files/table.h"

namespace mortise::parametric {
namespace {

using google::protobuf::util::MessageDifferencer;

// A template of parts, as its file has it.
v1::Template ShippedTable() {
  const Collection collection = ShippedCollection();
  for (const v1::Template& message : collection.templates) {
    if (message.name() == "templates/table") return message;
  }
  ADD_FAILURE() << "there is no table";
  return {};
}

TEST(Codec, KeepsTemplatesItemsAndMaterials) {
  const Collection collection = ShippedCollection();
  for (v1::Template message : collection.templates) {
    message.clear_labels();  // which are the catalog's, no part of a definition
    if (message.kind_case() != v1::Template::KIND_NOT_SET) continue;
    for (v1::Parameter& parameter : *message.mutable_parameters()) {
      parameter = ToProto(FromProto(parameter));  // what choices leave out is filled in
    }
    const auto definition = FromProto(message);
    ASSERT_TRUE(definition.ok()) << definition.status();
    EXPECT_TRUE(MessageDifferencer::Equals(ToProto(*definition), message));
  }
  for (const auto& message : collection.items) {
    const auto item = FromProto(message);
    ASSERT_TRUE(item.ok()) << item.status();
    EXPECT_TRUE(MessageDifferencer::Equals(ToProto(*item), message)) << message.name();
  }
  for (const auto& message : collection.materials) {
    EXPECT_TRUE(MessageDifferencer::Equals(ToProto(*FromProto(message)), message));
  }
}

TEST(Codec, KeepsBundlesAndDesigns) {
  const TemplateBundle bundle = TableBundle();
  const v1::TemplateBundle message = ToProto(bundle);
  const auto back = FromProto(message);
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_TRUE(MessageDifferencer::Equals(ToProto(*back), message));

  const auto table = TemplateFunction::Create(*back);
  ASSERT_TRUE(table.ok()) << table.status();
  const auto design = table->Evaluate(table->Defaults());
  ASSERT_TRUE(design.ok()) << design.status();
  const v1::EvaluatedDesign evaluated = ToProto(*design);
  const auto design_back = FromProto(evaluated);
  ASSERT_TRUE(design_back.ok()) << design_back.status();
  EXPECT_TRUE(MessageDifferencer::Equals(ToProto(*design_back), evaluated));
}

TEST(Codec, DigestIsOfTheContentAlone) {
  v1::Template message = ShippedTable();
  const std::string digest = TemplateDigest(message);
  EXPECT_EQ(digest.size(), 64u);
  message.set_revision(7);
  message.set_name("templates/other");
  message.mutable_create_time()->set_seconds(12345);
  message.set_digest("x");
  EXPECT_EQ(TemplateDigest(message), digest);
  message.mutable_parameters(0)->set_maximum(1.9);
  EXPECT_NE(TemplateDigest(message), digest);
}

template <typename Message>
void Tag(Message& message) {
  message.add_external_ids("100-4711/A");
  (*message.mutable_labels())["site"] = "Hamburg";
  message.set_creator("users/ada");
  message.mutable_create_time()->set_seconds(12345);
}

TEST(Codec, DigestsDoNotDependOnTags) {
  v1::TemplateBundle message = ToProto(TableBundle());
  message.mutable_assembly()->set_title("An assembly");
  const std::string digest = BundleDigest(message);
  const std::string of_template = TemplateDigest(message.template_());
  Tag(*message.mutable_template_());
  Tag(*message.mutable_items(0));
  Tag(*message.mutable_materials(0));
  Tag(*message.mutable_assembly());
  EXPECT_EQ(TemplateDigest(message.template_()), of_template);
  EXPECT_EQ(BundleDigest(message), digest);
  message.mutable_assembly()->set_title("Another");
  EXPECT_NE(BundleDigest(message), digest);
}

TEST(Codec, RefusesWhatStructsCannotHold) {
  const Collection collection = ShippedCollection();
  const auto field = [](const absl::Status& status) { return DetailOf(status).field; };

  v1::Template without_body = ShippedTable();
  without_body.mutable_parts(2)->clear_body();
  EXPECT_EQ(field(FromProto(without_body).status()), "parts[2].body");

  v1::Template without_axis = ShippedTable();
  without_axis.mutable_parts(2)->set_length_axis(v1::AXIS_UNSPECIFIED);
  EXPECT_EQ(field(FromProto(without_axis).status()), "parts[2].length_axis");

  v1::Template unknown_kind = ShippedTable();
  unknown_kind.mutable_boundary_conditions(1)->set_kind(
      static_cast<v1::BoundaryCondition::Kind>(42));
  EXPECT_EQ(field(FromProto(unknown_kind).status()), "boundary_conditions[1].kind");

  v1::Template of_features;
  of_features.mutable_cad();
  EXPECT_EQ(field(FromProto(of_features).status()), "kind");

  v1::Item twice = collection.items[0];
  twice.mutable_dimensions(1)->set_axis(v1::X);
  EXPECT_EQ(field(FromProto(twice).status()), "dimensions[1].axis");
  v1::Item missing = collection.items[0];
  missing.mutable_dimensions()->RemoveLast();
  EXPECT_EQ(field(FromProto(missing).status()), "dimensions");
  v1::Item kindless = collection.items[0];
  kindless.set_kind(static_cast<v1::ItemKind>(77));
  EXPECT_EQ(field(FromProto(kindless).status()), "kind");
}

TEST(CollectionText, ReportsLineAndColumnOfEveryFault) {
  const auto parsed = ParseTemplateText(
      "name: \"templates/x\"\nparts { nonsense: 1 }\ntitle: 3\nname: \"templates/y\"",
      "x.textproto");
  std::vector<std::string> places;
  for (const FieldViolation& fault : ViolationsOf(parsed.status())) places.push_back(fault.field);
  EXPECT_THAT(places,
              testing::ElementsAre("x.textproto: line 2, column 9", "x.textproto: line 3, column 8",
                                   "x.textproto: line 4, column 1"));
  EXPECT_EQ(ReadCollection("/nonexistent").status().code(), absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace mortise::parametric
