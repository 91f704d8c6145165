// What a search leaves out: by what the index says of templates, and by what their designs are
// like.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/design/costs/design_cost.h"
#include "common/templates/template_codec.h"
#include "mortise/v1/events.grpc.pb.h"
#include "services/retrieval/filters/design_filter.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/retrieval/retrieval_house.h"

namespace mortise::retrieval {
namespace {

using ::testing::AllOf;
using testing::BuiltState;
using testing::Call;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::kCoarse;
using testing::RetrievalHouse;
using ::testing::UnorderedElementsAre;
using testing::Value;

// A table, a boat and two tables of other heights, with labels. Searches change nothing: they share
// it.
class SearchFilterTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    house_ = BuiltState::House();
    ImportTable("templates/desk", 1.5, {{"category", "table"}, {"room", "office"}});
    ImportTable("templates/bench", 0.9, {{"category", "chair"}});
    house_->Build("shared", kCoarse);
  }
  static void TearDownTestSuite() { house_.reset(); }

  // The table that ships, under another name and with longer or shorter legs.
  static void ImportTable(const std::string& name, double scale,
                          const std::map<std::string, std::string>& labels) {
    v1::GetTemplateRequest get;
    get.set_name("templates/table");
    auto table = Call(house_->catalog(), &v1::CatalogService::Stub::GetTemplate, get);
    ASSERT_TRUE(table.ok()) << table.status();
    v1::ImportTemplateRequest import;
    import.set_request_id(name);
    *import.mutable_template_() = *table;
    import.mutable_template_()->set_name(name);
    import.mutable_template_()->set_title("A " + name);
    for (v1::Parameter& each : *import.mutable_template_()->mutable_parameters()) {
      if (each.name() != "height") continue;
      each.set_minimum(scale * each.minimum());
      each.set_maximum(scale * each.maximum());
      each.set_default_value(scale * each.default_value());
    }
    import.mutable_template_()->mutable_labels()->clear();
    for (const auto& [key, value] : labels) {
      (*import.mutable_template_()->mutable_labels())[key] = value;
    }
    const auto imported =
        Call(house_->catalog(), &v1::CatalogService::Stub::ImportTemplate, import);
    ASSERT_TRUE(imported.ok()) << imported.status();
  }

  static v1::SearchShapesRequest ForTable() {
    v1::SearchShapesRequest request;
    request.mutable_design()->set_template_("templates/table");
    *request.mutable_design()->add_parameters() = Value("length", 1.7);
    request.set_limit(100);
    return request;
  }

  static std::vector<v1::ShapeMatch> Find(const v1::SearchShapesRequest& request) {
    const auto found = house_->Search(request);
    EXPECT_TRUE(found.ok()) << found.status();
    if (!found.ok()) return {};
    return {found->matches().begin(), found->matches().end()};
  }

  static std::vector<std::string> NamesOf(const std::vector<v1::ShapeMatch>& matches) {
    std::vector<std::string> names;
    for (const v1::ShapeMatch& match : matches) names.push_back(match.template_());
    return names;
  }

  // The template of a match and its design, made here.
  struct Made {
    std::shared_ptr<const templates::Template> design_template;
    parametric::EvaluatedDesign design;
  };
  static Made Make(const v1::ShapeMatch& match) {
    v1::GetTemplateBundleRequest get;
    get.set_name(match.template_());
    get.set_revision(match.template_revision());
    const auto bundle = Call(house_->catalog(), &v1::CatalogService::Stub::GetTemplateBundle, get);
    EXPECT_TRUE(bundle.ok()) << bundle.status();
    const auto function = templates::Compile(*bundle);
    EXPECT_TRUE(function.ok()) << function.status();
    Eigen::VectorXd q(match.parameters_size());
    for (int i = 0; i < match.parameters_size(); ++i) {
      EXPECT_EQ(match.parameters(i).name(),
                (*function)->parameters()[static_cast<std::size_t>(i)].name);
      q[i] = match.parameters(i).value();
    }
    return {*function, *(*function)->Evaluate(q)};
  }

  // Whoever filters the list of all by themselves gets what the search gives, in its order.
  static void ExpectFiltered(const v1::DesignFilter& asked, const DesignFilter& filter) {
    std::vector<std::string> expected;
    const std::vector<v1::ShapeMatch> all = Find(ForTable());
    for (const v1::ShapeMatch& match : all) {
      const Made made = Make(match);
      if (Meets(filter, FactsOf(made.design, made.design_template->head().items))) {
        expected.push_back(match.template_());
      }
    }
    v1::SearchShapesRequest request = ForTable();
    *request.mutable_design_filter() = asked;
    const auto found = house_->Search(request);
    ASSERT_TRUE(found.ok()) << found.status();
    EXPECT_EQ(NamesOf({found->matches().begin(), found->matches().end()}), expected)
        << asked.ShortDebugString();
    EXPECT_FALSE(found->ended_early());
    EXPECT_LE(found->designs_looked_at(), static_cast<int>(all.size()));
    EXPECT_GE(found->designs_looked_at(), static_cast<int>(expected.size()));
    request.set_limit(1);
    expected.resize(std::min<std::size_t>(1, expected.size()));
    EXPECT_EQ(NamesOf(Find(request)), expected) << asked.ShortDebugString();
  }

  static std::unique_ptr<RetrievalHouse> house_;
};

std::unique_ptr<RetrievalHouse> SearchFilterTest::house_;

TEST_F(SearchFilterTest, LooksAtCategoriesAndLabels) {
  ASSERT_EQ(Find(ForTable()).size(), 4u);
  v1::SearchShapesRequest request = ForTable();
  request.add_categories("chair");
  EXPECT_THAT(NamesOf(Find(request)), ElementsAre("templates/bench"));
  request.add_categories("table");
  EXPECT_THAT(NamesOf(Find(request)),
              ::testing::IsSupersetOf({"templates/bench", "templates/desk"}));
  EXPECT_THAT(NamesOf(Find(request)), ::testing::Not(::testing::Contains("templates/table")));
  request = ForTable();
  (*request.mutable_filter()->mutable_labels())["room"] = "office";
  EXPECT_THAT(NamesOf(Find(request)), ElementsAre("templates/desk"));
  request.add_templates("templates/table");
  EXPECT_THAT(NamesOf(Find(request)), IsEmpty());
}

TEST_F(SearchFilterTest, OffersOtherNamesForThoseThatAreNot) {
  v1::SearchShapesRequest request = ForTable();
  request.add_templates("templates/boat");
  request.add_templates("templates/tabel");
  request.add_categories("tabel");
  request.mutable_design_filter()->add_materials("materials/nix");
  request.mutable_design_filter()->add_items()->set_item("items/dovel-8x50");
  const absl::Status refused = house_->Search(request).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument) << refused;
  std::map<std::string, std::string> messages;
  for (const FieldViolation& each : AllViolationsOf(refused)) messages[each.field] = each.message;
  ASSERT_EQ(messages.size(), 4u) << refused;
  EXPECT_THAT(messages["templates[1]"], HasSubstr("did you mean 'table'?"));
  EXPECT_THAT(messages["categories[0]"], HasSubstr("did you mean 'table'?"));
  EXPECT_THAT(messages["design_filter.materials[0]"], HasSubstr("there is no material 'nix'"));
  EXPECT_THAT(messages["design_filter.items[0].item"], HasSubstr("did you mean 'dowel-8x50'?"));
}

// What the catalog has and no template of the index is made of is no mistake.
TEST_F(SearchFilterTest, SaysWhatLeftNothing) {
  v1::SearchShapesRequest request = ForTable();
  request.add_categories("chair");
  request.mutable_design_filter()->mutable_min_size()->set_x(50);
  auto found = house_->Search(request);
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_EQ(found->matches_size(), 0);
  EXPECT_THAT(found->notes(),
              Contains(AllOf(HasSubstr("Nothing is left"), HasSubstr("1 of the categories"),
                             HasSubstr("0 of the size"))));
  request = ForTable();
  request.mutable_design_filter()->add_items()->set_item("items/bearing-608");
  found = house_->Search(request);
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_EQ(found->matches_size(), 0);
  EXPECT_THAT(found->notes(), Contains(HasSubstr("0 with any of the items")));
}

TEST_F(SearchFilterTest, SaysWhichItemsTheNearestLacks) {
  const Made made = Make(Find(ForTable()).front());
  const auto needs = parametric::NeedsOf(made.design, made.design_template->head().items);
  ASSERT_TRUE(needs.ok()) << needs.status();
  ASSERT_GT(needs->size(), 1u);
  v1::SearchShapesRequest request = ForTable();
  request.mutable_design_filter()->add_items()->set_item(needs->front().item);
  const auto found = house_->Search(request);
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_EQ(found->matches_size(), 0);
  EXPECT_THAT(found->notes(), Contains(HasSubstr("of " + needs->back().item + " (there are 0)")));
}

TEST_F(SearchFilterTest, LooksAtTheSizesOfTheMatchedDesigns) {
  for (const v1::ShapeMatch& match : Find(ForTable())) {
    const Made made = Make(match);
    Eigen::Vector3d lower = made.design.parts.front().minimum;
    Eigen::Vector3d upper = made.design.parts.front().maximum;
    for (const auto& part : made.design.parts) {
      lower = lower.cwiseMin(part.minimum);
      upper = upper.cwiseMax(part.maximum);
    }
    const Eigen::Vector3d size = upper - lower;
    DesignFilter filter;
    v1::DesignFilter asked;
    filter.max_size[2] = size[2];
    asked.mutable_max_size()->set_z(size[2]);
    ExpectFiltered(asked, filter);
    filter.min_size[0] = 0.9 * size[0];
    asked.mutable_min_size()->set_x(0.9 * size[0]);
    ExpectFiltered(asked, filter);
  }
}

TEST_F(SearchFilterTest, LooksAtMaterialsAndPrices) {
  for (const v1::ShapeMatch& match : Find(ForTable())) {
    const Made made = Make(match);
    DesignFilter filter;
    v1::DesignFilter asked;
    filter.materials.emplace();
    for (const auto& part : made.design.parts) {
      if (!filter.materials->insert(part.material).second) continue;
      asked.add_materials(part.material);
    }
    ExpectFiltered(asked, filter);
    const auto cost = parametric::CostOf(made.design, made.design_template->head().items);
    if (!cost.ok()) continue;  // of the boat nobody says a price
    EXPECT_EQ(cost->currency, "EUR");
    filter.max_price = *cost;
    asked.mutable_max_price()->set_currency("EUR");
    asked.mutable_max_price()->set_amount(cost->amount);
    ExpectFiltered(asked, filter);
  }
  DesignFilter cheap;
  cheap.max_price = parametric::Cost{.amount = 0.01, .currency = "EUR"};
  v1::DesignFilter asked;
  asked.mutable_max_price()->set_currency("EUR");
  asked.mutable_max_price()->set_amount(0.01);
  ExpectFiltered(asked, cheap);
}

TEST_F(SearchFilterTest, LooksAtWhatThereIsToBuildFrom) {
  const v1::ShapeMatch best = Find(ForTable()).front();
  const Made made = Make(best);
  const auto needs = parametric::NeedsOf(made.design, made.design_template->head().items);
  ASSERT_TRUE(needs.ok()) << needs.status();
  DesignFilter filter;
  v1::DesignFilter asked;
  filter.items.emplace();
  for (const parametric::ItemNeed& need : *needs) {
    (*filter.items)[need.item] = need.pieces;
    v1::AvailableItem& item = *asked.add_items();
    item.set_item(need.item);
    item.set_quantity(need.pieces);
  }
  v1::SearchShapesRequest request = ForTable();
  *request.mutable_design_filter() = asked;
  EXPECT_EQ(NamesOf(Find(request)).front(), best.template_());
  ExpectFiltered(asked, filter);
  // One peg too few.
  v1::AvailableItem& short_of = *asked.mutable_items(0);
  short_of.set_quantity(0.9 * short_of.quantity());
  (*filter.items)[short_of.item()] = short_of.quantity();
  ExpectFiltered(asked, filter);
  short_of.clear_quantity();
  (*filter.items)[short_of.item()] = std::numeric_limits<double>::infinity();
  ExpectFiltered(asked, filter);
}

TEST_F(SearchFilterTest, NamesWhatNoDesignCanBeLike) {
  v1::SearchShapesRequest request = ForTable();
  v1::DesignFilter& filter = *request.mutable_design_filter();
  filter.mutable_max_size()->set_y(-1);
  filter.add_materials("items/board");
  filter.mutable_max_price()->set_amount(-4);
  filter.add_items()->set_item("items/board");
  filter.add_items()->set_item("items/board");
  filter.mutable_items(1)->set_quantity(-1);
  std::vector<std::string> fields;
  for (const FieldViolation& each : AllViolationsOf(house_->Search(request).status())) {
    fields.push_back(each.field);
  }
  EXPECT_THAT(fields, UnorderedElementsAre(
                          "design_filter.max_size.y", "design_filter.materials[0]",
                          "design_filter.max_price.amount", "design_filter.max_price.currency",
                          "design_filter.items[1].quantity", "design_filter.items[1].item"));
  request = ForTable();
  request.mutable_design_filter()->mutable_max_size()->set_z(0.2);
  request.mutable_design_filter()->mutable_min_size()->set_z(0.3);
  EXPECT_EQ(DetailOf(house_->Search(request).status()).field, "design_filter.max_size");
}

TEST_F(SearchFilterTest, FamiliesComeInPages) {
  v1::ListIndexFamiliesRequest list;
  list.set_name("indexes/d2");
  list.set_page_size(2);
  std::vector<std::string> names;
  do {
    const auto page =
        Call(house_->retrieval(), &v1::RetrievalService::Stub::ListIndexFamilies, list);
    ASSERT_TRUE(page.ok()) << page.status();
    ASSERT_LE(page->families_size(), 2);
    for (const v1::ShapeIndex::Family& family : page->families()) {
      names.push_back(family.template_());
      EXPECT_NE(family.title(), "") << family.template_();
      EXPECT_GT(family.parameters_size(), 0) << family.template_();
    }
    list.set_page_token(page->next_page_token());
  } while (!list.page_token().empty());
  EXPECT_THAT(
      names, ElementsAre("templates/bench", "templates/boat", "templates/desk", "templates/table"));
  list.set_only_faults(true);
  const auto faults =
      Call(house_->retrieval(), &v1::RetrievalService::Stub::ListIndexFamilies, list);
  ASSERT_TRUE(faults.ok()) << faults.status();
  EXPECT_EQ(faults->families_size(), 0);
  list.set_name("indexes/none");
  EXPECT_TRUE(absl::IsNotFound(
      Call(house_->retrieval(), &v1::RetrievalService::Stub::ListIndexFamilies, list).status()));
}

TEST(SearchWithoutCatalogTest, AsksTheCatalogForNothingThatTheIndexKnows) {
  const auto built = BuiltState::House();
  RetrievalHouse& house = *built;
  v1::ExportDesignRequest exported;
  exported.set_name("templates/table");
  exported.set_format(v1::ExportDesignRequest::OBJ);
  grpc::ClientContext context;
  testing::Prepare(context);
  const auto bytes = testing::ReadChunks(*house.catalog().ExportDesign(&context, exported));
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  v1::GetTemplateRequest get;
  get.set_name("templates/table");
  const auto table = Call(house.catalog(), &v1::CatalogService::Stub::GetTemplate, get);
  ASSERT_TRUE(table.ok()) << table.status();

  house.catalog_process().Kill();
  v1::SearchShapesRequest request;
  request.mutable_mesh()->set_file(*bytes);
  request.mutable_filter()->set_creator(table->creator());
  request.add_templates("templates/table");
  const auto found = house.Search(request);
  ASSERT_TRUE(found.ok()) << found.status();
  ASSERT_EQ(found->matches_size(), 1);
  const v1::ShapeMatch& match = found->matches(0);
  EXPECT_EQ(match.template_(), "templates/table");
  EXPECT_EQ(match.title(), table->title());
  ASSERT_EQ(match.parameters_size(), table->parameters_size());
  for (int i = 0; i < table->parameters_size(); ++i) {
    EXPECT_EQ(match.parameters(i).name(), table->parameters(i).name());
  }
}

// Labels are no content: a revision with others has the same designs, and the same cover.
TEST(SearchWithoutCatalogTest, KnowsLabelsThatHaveChangedSinceWithoutCoveringAgain) {
  const auto built = BuiltState::House();
  RetrievalHouse& house = *built;
  const auto before = house.Index();
  ASSERT_TRUE(before.ok()) << before.status();
  grpc::ClientContext context;
  testing::Prepare(context);
  v1::FollowEventsRequest follow;
  follow.set_after_number(0);
  follow.add_type_prefixes("index.");
  const auto stub = v1::EventService::NewStub(house.channel());
  const auto events = stub->FollowEvents(&context, follow);

  v1::GetTemplateRequest get;
  get.set_name("templates/table");
  const auto table = Call(house.catalog(), &v1::CatalogService::Stub::GetTemplate, get);
  ASSERT_TRUE(table.ok()) << table.status();
  v1::ImportTemplateRequest import;
  import.set_request_id("labels");
  import.set_expected_revision(table->revision());
  *import.mutable_template_() = *table;
  (*import.mutable_template_()->mutable_labels())["category"] = "table";
  const auto imported = Call(house.catalog(), &v1::CatalogService::Stub::ImportTemplate, import);
  ASSERT_TRUE(imported.ok()) << imported.status();

  v1::ShapeIndex index;
  for (v1::Event event; events->Read(&event);) {
    index = *house.Index();
    if (index.current() && index.families(1).template_revision() == imported->revision()) break;
  }
  context.TryCancel();
  ASSERT_EQ(index.families(1).template_(), "templates/table");
  EXPECT_EQ(index.families(1).labels().at("category"), "table");
  EXPECT_EQ(index.sha256(), before->sha256());
  EXPECT_EQ(index.families(1).evaluations(), before->families(1).evaluations());
}

}  // namespace
}  // namespace mortise::retrieval
