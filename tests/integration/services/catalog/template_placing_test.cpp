// Templates on ground of one's own: PlaceTemplate, and what it refuses.
#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <limits>
#include <map>

#include "tests/integration/services/catalog/catalog_service_fixture.h"

namespace mortise::catalog {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using Stub = v1::CatalogService::Stub;

// Ground that rises by a twentieth to the right, and covers all decks.
constexpr char kSlope[] =
    "name: 'ground' title: 'a slope' datum: 300 grid { x: -1 y: -1 x_spacing: 5 y_spacing: 5 "
    "columns: 2 heights: [299.95, 300.2, 299.95, 300.2] }";

class TemplatePlacing : public CatalogServiceTest {
 protected:
  static v1::PlaceTemplateRequest Request(const std::string& height_field = kSlope) {
    v1::PlaceTemplateRequest request;
    request.set_request_id(NewRequestId());
    request.set_name("templates/deck");
    EXPECT_TRUE(
        google::protobuf::TextFormat::ParseFromString(height_field, request.add_height_fields()));
    return request;
  }

  v1::Template Place(const v1::PlaceTemplateRequest& request) {
    v1::Template placed;
    const grpc::Status status = Call(&Stub::PlaceTemplate, request, &placed);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return placed;
  }

  Failure Refused(const v1::PlaceTemplateRequest& request) {
    const int before = TemplateCount();
    Failure failure = Fail<v1::PlaceTemplateRequest, v1::Template>(&Stub::PlaceTemplate, request);
    EXPECT_EQ(TemplateCount(), before);
    return failure;
  }

  int TemplateCount() {
    v1::ListTemplatesRequest request;
    request.set_page_size(1000);
    v1::ListTemplatesResponse response;
    EXPECT_TRUE(Call(&Stub::ListTemplates, request, &response).ok());
    return response.templates_size();
  }

  // How long each post of a deck is, m.
  std::map<std::string, double> Posts(const std::string& name) {
    v1::EvaluateTemplateRequest request;
    request.set_name(name);
    v1::EvaluatedDesign design;
    const grpc::Status status = Call(&Stub::EvaluateTemplate, request, &design);
    EXPECT_TRUE(status.ok()) << status.error_message();
    std::map<std::string, double> posts;
    for (const v1::EvaluatedPart& part : design.parts()) {
      if (part.name().starts_with("post ")) posts[part.name()] = part.size().x();
    }
    return posts;
  }
};

TEST_F(TemplatePlacing, MakesATemplateOfItsOwn) {
  v1::PlaceTemplateRequest request = Request();
  request.add_external_ids("plot-7");
  (*request.mutable_labels())["customer"] = "acme";
  const v1::Template placed = Place(request);
  EXPECT_THAT(placed.name(), MatchesRegex("templates/deck-[0-9a-f]{12}"));
  EXPECT_EQ(placed.revision(), 1);
  EXPECT_EQ(placed.title(), "Deck on a slope");
  EXPECT_EQ(placed.placed_template(), "templates/deck");
  EXPECT_EQ(placed.placed_template_revision(), 1);
  EXPECT_EQ(placed.external_ids(0), "plot-7");
  EXPECT_EQ(placed.labels().at("customer"), "acme");
  ASSERT_EQ(placed.height_fields_size(), 1);
  EXPECT_EQ(placed.height_fields(0).digest().size(), 64u);
  EXPECT_NE(placed.digest(), GetTemplate("templates/deck").digest());
  // The highest ground is at the right end, 2.4 m along.
  const auto posts = Posts(placed.name());
  ASSERT_EQ(posts.size(), 12u);
  EXPECT_NEAR(posts.at("post 1.1"), 0.45 + 0.05 * 2.4, 1e-9);
  EXPECT_NEAR(posts.at("post 3.1"), 0.45 + 0.05 * 0.08, 1e-9);
}

TEST_F(TemplatePlacing, GivesTheSameTemplateForTheSameGround) {
  const v1::PlaceTemplateRequest request = Request();
  const v1::Template placed = Place(request);
  EXPECT_EQ(Place(request).name(), placed.name()) << "the same request";
  const v1::Template again = Place(Request());
  EXPECT_EQ(again.name(), placed.name());
  EXPECT_EQ(again.revision(), 1);
  v1::PlaceTemplateRequest renamed = Request();
  renamed.mutable_height_fields(0)->set_title("the plot");
  EXPECT_EQ(Place(renamed).name(), placed.name());
  EXPECT_EQ(GetTemplate(placed.name()).revision(), 2);
  EXPECT_EQ(GetTemplate(placed.name()).title(), "Deck on the plot");
  v1::PlaceTemplateRequest other = Request();
  other.mutable_height_fields(0)->mutable_grid()->set_heights(0, 299.9);
  EXPECT_NE(Place(other).name(), placed.name());
}

TEST_F(TemplatePlacing, OfAPlacedTemplateRefersToTheFirst) {
  const v1::Template placed = Place(Request());
  v1::PlaceTemplateRequest request = Request(
      "name: 'ground' title: 'a scan' triangles { vertices: [-9, -9, 0, 20, -9, 0, -9, 20, 0] "
      "triangles: [0, 1, 2] }");
  const v1::Template directly = Place(request);
  request.set_request_id(NewRequestId());
  request.set_name(placed.name());
  const v1::Template again = Place(request);
  EXPECT_EQ(again.name(), directly.name());
  EXPECT_EQ(again.title(), "Deck on a scan");
  EXPECT_EQ(again.placed_template(), "templates/deck");
  EXPECT_NEAR(Posts(again.name()).at("post 1.1"), 0.45, 1e-9);
}

TEST_F(TemplatePlacing, StaysPlacedWithOtherLabelsAndNotWithOtherContent) {
  v1::Template placed = Place(Request());
  (*placed.mutable_labels())["customer"] = "acme";
  v1::Template stored;
  ASSERT_TRUE(Call(&Stub::ImportTemplate, ImportRequest(placed, 1), &stored).ok());
  EXPECT_EQ(stored.placed_template(), "templates/deck");
  EXPECT_EQ(Place(Request()).labels().at("customer"), "acme");
  stored.set_title("My own");
  ASSERT_TRUE(Call(&Stub::ImportTemplate, ImportRequest(stored, 2), &stored).ok());
  EXPECT_EQ(stored.placed_template(), "");
  EXPECT_EQ(Refused(Request()).code, absl::StatusCode::kAlreadyExists);
}

TEST_F(TemplatePlacing, IsListedWithoutHeightsAndDeleted) {
  const v1::Template placed = Place(Request());
  v1::ListTemplatesRequest list;
  list.set_text("slope");
  v1::ListTemplatesResponse response;
  ASSERT_TRUE(Call(&Stub::ListTemplates, list, &response).ok());
  ASSERT_EQ(response.templates_size(), 1);
  const v1::HeightField& listed = response.templates(0).height_fields(0);
  EXPECT_EQ(listed.digest(), placed.height_fields(0).digest());
  EXPECT_EQ(listed.heights_case(), v1::HeightField::HEIGHTS_NOT_SET);
  v1::DeleteTemplateRequest remove;
  remove.set_request_id(NewRequestId());
  remove.set_name(placed.name());
  remove.set_revision(1);
  v1::DeleteTemplateResponse removed;
  ASSERT_TRUE(Call(&Stub::DeleteTemplate, remove, &removed).ok());
  EXPECT_EQ(GetTemplate(placed.name(), 1).title(), placed.title());
  EXPECT_EQ(Place(Request()).name(), placed.name());
}

TEST_F(TemplatePlacing, RefusesGroundThatIsWrong) {
  v1::PlaceTemplateRequest twice = Request();
  *twice.add_height_fields() = twice.height_fields(0);
  EXPECT_EQ(Refused(twice).field, "height_fields[1].name");
  v1::PlaceTemplateRequest unknown = Request();
  unknown.mutable_height_fields(0)->set_name("grund");
  EXPECT_THAT(Refused(unknown).message,
              HasSubstr("the template has no ground 'grund'; it has 'ground'"));
  v1::PlaceTemplateRequest empty = Request();
  empty.clear_height_fields();
  EXPECT_EQ(Refused(empty).field, "height_fields");
  v1::PlaceTemplateRequest ragged = Request();
  ragged.mutable_height_fields(0)->mutable_grid()->add_heights(1);
  EXPECT_EQ(Refused(ragged).field, "height_fields[0].grid.heights");
  v1::PlaceTemplateRequest infinite = Request();
  infinite.mutable_height_fields(0)->mutable_grid()->set_heights(
      2, std::numeric_limits<double>::infinity());
  EXPECT_EQ(Refused(infinite).field, "height_fields[0].grid.heights[2]");
  v1::PlaceTemplateRequest table = Request();
  table.set_name("templates/table");
  EXPECT_EQ(Refused(table).field, "name");
  v1::PlaceTemplateRequest nothing = Request();
  nothing.set_name("templates/nothing");
  EXPECT_EQ(Refused(nothing).code, absl::StatusCode::kNotFound);
}

TEST_F(TemplatePlacing, RefusesGroundThatDoesNotReachUnderAllDesigns) {
  v1::PlaceTemplateRequest small = Request();
  small.mutable_height_fields(0)->mutable_grid()->set_x_spacing(3.5);
  const Failure outside = Refused(small);
  EXPECT_EQ(outside.field, "height_fields[0]");
  EXPECT_THAT(outside.message, AllOf(HasSubstr("parts[0].box.z.from"),
                                     HasSubstr("ground 'ground' is known for x -1 to 2.5 m"),
                                     HasSubstr("width = 2.98")));
  v1::PlaceTemplateRequest holed =
      Request("name: 'ground' grid { x: -1 y: -1 x_spacing: 1 y_spacing: 1 columns: 6 }");
  auto& heights = *holed.mutable_height_fields(0)->mutable_grid()->mutable_heights();
  heights.Resize(36, 0);
  heights[6 * 2 + 3] = std::numeric_limits<double>::quiet_NaN();  // at x = 2, y = 1
  EXPECT_THAT(Refused(holed).message,
              AllOf(HasSubstr("has a hole at x = 1.5 m"), HasSubstr("at the defaults")));
  v1::PlaceTemplateRequest steep = Request();
  steep.mutable_height_fields(0)->mutable_grid()->set_heights(0, 290);
  EXPECT_THAT(Refused(steep).message, HasSubstr("of parts[0]"));
}

TEST_F(TemplatePlacing, ImportRefusesGroundThatIsWrong) {
  v1::Template deck = GetTemplate("templates/deck");
  *deck.add_height_fields() = deck.height_fields(0);
  const Failure twice =
      Fail<v1::ImportTemplateRequest, v1::Template>(&Stub::ImportTemplate, ImportRequest(deck, 1));
  EXPECT_EQ(twice.field, "template.height_fields[1].name");
  EXPECT_THAT(twice.message, HasSubstr("'ground' is used twice"));
  deck.mutable_height_fields()->RemoveLast();
  deck.mutable_height_fields(0)->mutable_grid()->set_y_spacing(2);
  const Failure outside =
      Fail<v1::ImportTemplateRequest, v1::Template>(&Stub::ImportTemplate, ImportRequest(deck, 1));
  EXPECT_EQ(outside.field, "template.parts[0].box.z.from");
  EXPECT_THAT(outside.message, HasSubstr("ground 'ground' is known for"));
  EXPECT_EQ(GetTemplate("templates/deck").revision(), 1);
  v1::Template wrench = GetTemplate("templates/wrench");
  wrench.add_height_fields()->set_name("ground");
  const Failure other_kind = Fail<v1::ImportTemplateRequest, v1::Template>(
      &Stub::ImportTemplate, ImportRequest(wrench, 1));
  EXPECT_EQ(other_kind.field, "template.height_fields[0]");
  EXPECT_THAT(other_kind.message, HasSubstr("'ground' must be left out"));
}

}  // namespace
}  // namespace mortise::catalog
