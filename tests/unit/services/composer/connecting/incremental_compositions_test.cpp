// What connecting and removing make of what was known is, to the bit, what parametrising the whole
// anew makes.
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "services/composer/connecting/connect.h"
#include "services/composer/model/controls.h"
#include "services/composer/model/removal.h"
#include "services/composer/snapping/snap.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/bookcase.h"
#include "tests/unit/common/assembly/expect_same.h"
#include "tests/unit/common/assembly/large_assemblies.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

void ExpectAsAnew(const Design& made) {
  ASSERT_OK_AND_ASSIGN(const Design anew, AsDrawn(made.assembly->assembly()));
  parametric::ExpectSame(*made.assembly, *anew.assembly);
}

// Drags the whole along an axis to a random one of what it can be; as it is where nothing can.
Design Dragged(const Design& design, std::mt19937_64& random) {
  std::vector<Control> sizes = ControlsOf(design, "").value();
  std::erase_if(sizes, [](const Control& one) { return one.kind != ControlKind::kSize; });
  if (sizes.empty()) return design;
  const Control& control = sizes[random() % sizes.size()];
  const double share = static_cast<double>(random() % 1000) / 1000;
  const double value = control.minimum + share * (control.maximum - control.minimum);
  return Drag(design, "", control.kind, control.axis, value).value();
}

void ExpectRemovalAsAnew(const Design& model, std::mt19937_64& random) {
  std::vector<std::string> nodes;
  for (const parametric::Element& element : model.assembly->elements()) {
    if (!element.connecting) nodes.push_back(element.name);
  }
  const std::string node = nodes[random() % nodes.size()];
  SCOPED_TRACE("without " + node);
  absl::StatusOr<parametric::Assembly> left = WithoutNode(model, node);
  if (!left.ok()) return;  // nothing is left
  const absl::StatusOr<Design> made = AsDrawn(*left, {model.assembly.get()});
  const absl::StatusOr<Design> anew = AsDrawn(*left);
  ASSERT_EQ(made.status(), anew.status());
  if (made.ok()) parametric::ExpectSame(*made->assembly, *anew->assembly);
}

// A component of one design that ships, on a random part of another.
TEST(IncrementalCompositionsTest, OfWhatShipsAreAsAnew) {
  const std::vector<std::string> ids = parametric::ShippedAssemblyIds();
  std::vector<std::pair<std::string, std::string>> nodes;
  for (const std::string& id : ids) {
    for (const std::string& group :
         parametric::DistinctSubTrees(ShippedDesign(id).assembly->assembly())) {
      nodes.emplace_back(id, group);
    }
  }
  const std::vector<const CollectionConnection*> all = AllShippedConnections();
  const ConnectOptions options = ShippedOptions();
  std::mt19937_64 random(37);
  int made_count = 0;
  for (int drop = 0; drop < 60; ++drop) {
    const auto& [id, node] = nodes[random() % nodes.size()];
    Design body = ShippedDesign(ids[random() % ids.size()]);
    SCOPED_TRACE(node + " of " + id + " on " + body.assembly->assembly().name);
    if (drop % 3 == 0) body = Dragged(body, random);
    absl::StatusOr<parametric::Assembly> sub_tree =
        parametric::SubTreeOf(ShippedDesign(id).assembly->assembly(), node);
    ASSERT_OK(sub_tree);
    const absl::StatusOr<Design> component = AsDrawn(*std::move(sub_tree));
    if (!component.ok()) continue;  // nothing holds its parts together
    const std::vector<parametric::PlacedPart> parts = PartsOf(body);
    const parametric::BoundingBox& target = parts[random() % parts.size()].box;
    Eigen::Vector3d middle = target.center();
    middle.z() = target.maximum.z() + BoundsOf(*component).size().z() / 2;
    const Original original = ShippedOriginal(id);
    ASSERT_OK_AND_ASSIGN(const Snapped snapped,
                         Snap(DroppedAt(*component, middle), &original.design, body));
    const absl::StatusOr<Connected> made =
        Connect(body, snapped.component, "new", &original, all, options);
    if (!made.ok()) continue;
    ++made_count;
    ExpectAsAnew(made->model);
    ExpectRemovalAsAnew(drop % 2 == 0 ? Dragged(made->model, random) : made->model, random);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(made_count, 5);
}

// Large bodies, whose equalities are solved group by group.
TEST(IncrementalCompositionsTest, OfLargeBodiesAreAsAnew) {
  for (const parametric::Assembly& body :
       {parametric::SideBySide({"cabinet", "workbench", "chicken_coop", "bookshelf"}),
        parametric::Bookcase(14, 9)}) {
    SCOPED_TRACE(body.name);
    ASSERT_OK_AND_ASSIGN(const Design known, AsDrawn(body));
    ASSERT_OK_AND_ASSIGN(const parametric::Assembly component,
                         parametric::ReadShippedAssembly("toy_chest"));
    ASSERT_OK_AND_ASSIGN(const Design other, AsDrawn(component));
    parametric::Assembly both = body;
    const Eigen::Vector3d beside(parametric::BoxAroundAll(body).maximum.x() -
                                     parametric::BoxAroundAll(component).minimum.x(),
                                 0, -parametric::BoxAroundAll(component).minimum.z());
    parametric::AddShifted(component, "new", beside, &both);
    ASSERT_OK_AND_ASSIGN(const Design made,
                         AsDrawn(both, {known.assembly.get(), other.assembly.get()}));
    ExpectAsAnew(made);
    std::mt19937_64 random(5);
    ExpectRemovalAsAnew(made, random);
  }
}

}  // namespace
}  // namespace mortise::composer
