// Checks of a template as it is written, field by field.
#include "common/design/template_checks.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/compared_numbers.h"
#include "common/base/identifiers.h"
#include "common/base/names/offered_names.h"
#include "common/design/compiled_template.h"
#include "common/design/condition_expressions.h"
#include "common/design/field_checks.h"
#include "common/design/parameter_values.h"
#include "common/expressions/expression.h"
#include "common/expressions/identifier.h"

namespace mortise::parametric {
namespace {

constexpr std::size_t kMaxParameters = 64;
constexpr std::size_t kMaxParts = 500;
constexpr std::size_t kMaxOutlinePoints = 200;
constexpr std::size_t kMaxConnections = 2000;
constexpr std::size_t kMaxBoundaryConditions = 500;
constexpr std::size_t kMaxGrounds = 10;
constexpr std::size_t kMaxItems = 100;     // of which one is taken
constexpr std::size_t kMaxDirections = 2;  // that a part is repeated in

using Names = std::vector<ExpressionName>;

// Collects findings about one template.
class Checker {
 public:
  explicit Checker(const TemplateBundle& bundle)
      : bundle_(bundle), definition_(bundle.definition), names_(NamesOf(bundle.definition)) {}

  std::vector<FieldViolation> Run() {
    CheckCount("parameters", definition_.parameters.size(), 1, kMaxParameters);
    CheckCount("parts", definition_.parts.size(), 1, kMaxParts);
    CheckCount("connections", definition_.connections.size(), 0, kMaxConnections);
    CheckCount("boundary_conditions", definition_.boundary_conditions.size(), 0,
               kMaxBoundaryConditions);
    CheckCount("height_fields", definition_.grounds.size(), 0, kMaxGrounds);
    if (IsTooLarge()) return findings_;
    if (const auto id = ParseResourceName(definition_.name, "templates", "name"); !id.ok()) {
      Report("name", "must be 'templates/' and 1 to 63 lower-case letters, digits and hyphens");
    }
    CheckTitle("title", definition_.title, findings_);
    CheckDescription("description", definition_.description, findings_);
    CheckParameters();
    CheckGrounds();
    CheckParts();
    CheckConnections();
    CheckBoundaryConditions();
    return findings_;
  }

 private:
  void Report(std::string field, std::string message) {
    findings_.push_back({std::move(field), std::move(message)});
  }

  void CheckCount(const std::string& field, std::size_t count, std::size_t least,
                  std::size_t most) {
    if (count < least || count > most) {
      Report(field,
             absl::StrCat("has ", count, " entries; ", least, " to ", most, " are accepted"));
    }
  }

  // Lists may be far beyond what is worth looking at.
  bool IsTooLarge() const {
    return definition_.parameters.size() > kMaxParameters || definition_.parts.size() > kMaxParts ||
           definition_.connections.size() > kMaxConnections ||
           definition_.boundary_conditions.size() > kMaxBoundaryConditions ||
           definition_.grounds.size() > kMaxGrounds;
  }

  void CheckName(const std::string& field, const std::string& name, std::set<std::string>& seen) {
    if (!IsIdentifier(name)) {
      Report(field, absl::StrCat("'", name.substr(0, 80),
                                 "' is not an identifier (1 to 63 letters, digits and underscores, "
                                 "not beginning with a digit)"));
    } else if (!seen.insert(name).second) {
      Report(field, absl::StrCat("'", name, "' is used twice"));
    }
  }

  void CheckParsed(const std::string& field, const std::string& text,
                   const absl::StatusOr<Expression>& parsed) {
    if (parsed.ok()) return;
    Report(field, absl::StrCat("'", text.substr(0, 80), "': ", parsed.status().message()));
  }

  void CheckExpression(const std::string& field, const std::string& text, const Names& names) {
    CheckParsed(field, text, Expression::Parse(text, names));
  }

  void CheckCondition(const std::string& field, const std::string& text) {
    CheckParsed(field, text, Expression::ParseCondition(text, names_));
  }

  void CheckPresent(const std::string& owner, const std::string& text) {
    if (!text.empty()) CheckCondition(owner + ".present", text);
  }

  void CheckExtent(const std::string& field, const Extent& extent, const Names& names) {
    CheckExpression(absl::StrCat(field, ".from"), extent.from, names);
    CheckExpression(absl::StrCat(field, ".to"), extent.to, names);
  }

  void CheckParameters() {
    std::set<std::string> seen;
    for (std::size_t i = 0; i < definition_.parameters.size(); ++i) {
      const Parameter& parameter = definition_.parameters[i];
      const std::string field = absl::StrCat("parameters[", i, "]");
      CheckName(absl::StrCat(field, ".name"), parameter.name, seen);
      if (IsReserved(parameter.name)) {
        Report(absl::StrCat(field, ".name"),
               absl::StrCat("'", parameter.name, "' is a word of the expression language"));
      }
      CheckTitle(absl::StrCat(field, ".title"), parameter.title, findings_);
      CheckDescription(absl::StrCat(field, ".description"), parameter.description, findings_);
      if (parameter.IsChoice()) {
        CheckChoices(field, parameter, findings_);
        continue;
      }
      CheckUnit(absl::StrCat(field, ".unit"), parameter.unit, findings_);
      CheckRange(field, parameter);
    }
  }

  bool IsParameter(const std::string& name) const {
    return std::any_of(definition_.parameters.begin(), definition_.parameters.end(),
                       [&](const Parameter& parameter) { return parameter.name == name; });
  }

  // What is wrong with the heights themselves is found where they are read.
  void CheckGrounds() {
    std::set<std::string> seen;
    for (std::size_t i = 0; i < definition_.grounds.size(); ++i) {
      const Ground& ground = definition_.grounds[i];
      const std::string field = absl::StrCat("height_fields[", i, "]");
      CheckName(field + ".name", ground.name, seen);
      if (IsParameter(ground.name)) {
        Report(field + ".name", absl::StrCat("'", ground.name, "' is a parameter"));
      }
      if (IsReserved(ground.name)) {
        Report(field + ".name",
               absl::StrCat("'", ground.name, "' is a word of the expression language"));
      }
      CheckTitle(field + ".title", ground.title, findings_);
    }
  }

  void CheckRange(const std::string& field, const Parameter& parameter) {
    bool finite = true;
    const auto check = [&](const char* name, double value) {
      if (std::isfinite(value)) return;
      finite = false;
      Report(absl::StrCat(field, ".", name), "is not a finite number");
    };
    check("minimum", parameter.minimum);
    check("maximum", parameter.maximum);
    check("default_value", parameter.default_value);
    check("step", parameter.step);
    if (!finite) return;
    if (parameter.maximum <= parameter.minimum) {
      // The default and the step mean nothing without a range.
      Report(absl::StrCat(field, ".maximum"),
             absl::StrCat("is ", parameter.maximum, ", not greater than the minimum ",
                          parameter.minimum));
      return;
    }
    if (parameter.default_value < parameter.minimum ||
        parameter.default_value > parameter.maximum) {
      const std::vector<std::string> texts =
          ComparedNumbers({parameter.default_value, parameter.minimum, parameter.maximum});
      Report(absl::StrCat(field, ".default_value"),
             absl::StrCat("is ", texts[0], ", outside the range ", texts[1], " to ", texts[2]));
    }
    if (parameter.step < 0 || parameter.step > parameter.maximum - parameter.minimum) {
      Report(absl::StrCat(field, ".step"), "must be between 0 and the width of the range");
    }
  }

  void CheckParts() {
    std::set<std::string> seen;
    for (std::size_t i = 0; i < definition_.parts.size(); ++i) {
      const PartTemplate& part = definition_.parts[i];
      const std::string field = absl::StrCat("parts[", i, "]");
      CheckName(absl::StrCat(field, ".name"), part.name, seen);
      CheckTitle(absl::StrCat(field, ".title"), part.title, findings_);
      CheckPresent(field, part.present);
      CheckPartItem(field + ".item", part.item, part, field);
      CheckItems(field, part.items);
      for (std::size_t k = 0; k < part.items.size(); ++k) {
        CheckPartItem(absl::StrCat(field, ".items[", k, "].item"), part.items[k].item, part, field);
      }
      CheckRepeat(field, part);
      const Names names = BodyNames(part, names_);
      if (part.length_axis == part.thickness_axis) {
        Report(absl::StrCat(field, ".thickness_axis"), "is the same as length_axis");
      }
      if (const Box* box = std::get_if<Box>(&part.body)) {
        CheckExtent(absl::StrCat(field, ".box.x"), box->x, names);
        CheckExtent(absl::StrCat(field, ".box.y"), box->y, names);
        CheckExtent(absl::StrCat(field, ".box.z"), box->z, names);
      } else {
        CheckPrism(absl::StrCat(field, ".prism"), std::get<Prism>(part.body), part, names);
      }
    }
  }

  // Of a bundle with all items there are, one may be meant.
  void ReportMissingItem(const std::string& field, const std::string& name) {
    std::vector<std::string> names;
    for (const Item& item : bundle_.items) names.push_back(item.name);
    Report(field, absl::StrCat("there is no item '", name, "'", NearestOffered(name, names)));
  }

  // `field` is that of the item, `owner` that of the part.
  void CheckPartItem(const std::string& field, const std::string& name, const PartTemplate& part,
                     const std::string& owner) {
    const Item* item = FindItem(bundle_.items, name);
    if (item == nullptr) {
      ReportMissingItem(field, name);
      return;
    }
    if (FindMaterial(bundle_.materials, item->material) == nullptr) {
      Report(field, absl::StrCat("its material '", item->material, "' does not exist"));
    }
    if (item->kind == ItemKind::kDowel || item->kind == ItemKind::kScrew) {
      Report(field, absl::StrCat("'", name, "' joins parts; it cannot be one"));
    }
    if (std::holds_alternative<Prism>(part.body) && item->kind != ItemKind::kSheet &&
        !IsCrosscut(*item)) {
      Report(absl::StrCat(owner, ".prism"),
             absl::StrCat("'", name,
                          "' is neither a sheet, so that an outline could be cut from it, nor "
                          "lumber that is crosscut"));
    }
  }

  // Whether it is lumber whose ends a saw cuts, as an outline across its length may show them.
  static bool IsCrosscut(const Item& item) {
    return item.kind == ItemKind::kBoard && item.dimensions[0].process == Process::kChopSaw;
  }

  // The conditions of alternative items; the items are for the caller.
  void CheckItems(const std::string& owner, const std::vector<ConditionalItem>& items) {
    if (items.size() > kMaxItems) CheckCount(owner + ".items", items.size(), 0, kMaxItems);
    for (std::size_t i = 0; i < std::min(items.size(), kMaxItems); ++i) {
      CheckCondition(absl::StrCat(owner, ".items[", i, "].when"), items[i].when);
    }
  }

  void CheckRepeat(const std::string& owner, const PartTemplate& part) {
    if (part.repeat.size() > kMaxDirections) {
      CheckCount(owner + ".repeat", part.repeat.size(), 0, kMaxDirections);
    }
    std::set<std::string> indices;
    for (std::size_t i = 0; i < part.repeat.size(); ++i) {
      const PartRepeat& repeat = part.repeat[i];
      const std::string field = absl::StrCat(owner, ".repeat[", i, "]");
      CheckExpression(field + ".count", repeat.count, names_);
      for (const auto& [axis, step] :
           {std::pair(".x", &repeat.x), std::pair(".y", &repeat.y), std::pair(".z", &repeat.z)}) {
        if (!step->empty()) CheckExpression(field + axis, *step, names_);
      }
      if (!repeat.index.empty()) CheckIndex(field + ".index", repeat.index, indices);
    }
  }

  void CheckIndex(const std::string& field, const std::string& index,
                  std::set<std::string>& indices) {
    CheckName(field, index, indices);
    const auto taken = std::find_if(names_.begin(), names_.end(),
                                    [&](const ExpressionName& name) { return name.name == index; });
    if (taken != names_.end()) {
      Report(field, absl::StrCat("'", index, "' is ",
                                 taken->ground == nullptr ? "a parameter" : "the name of ground"));
    }
    if (IsReserved(index)) {
      Report(field, absl::StrCat("'", index, "' is a word of the expression language"));
    }
  }

  void CheckPrism(const std::string& field, const Prism& prism, const PartTemplate& part,
                  const Names& names) {
    const Item* item =
        FindItem(bundle_.items, part.items.empty() ? part.item : part.items.front().item);
    if (item != nullptr && IsCrosscut(*item)) {
      if (prism.axis == part.length_axis) {
        Report(absl::StrCat(field, ".axis"),
               "must not be the part's length_axis: outlines of lumber show how its ends are cut");
      }
    } else if (prism.axis != part.thickness_axis) {
      Report(absl::StrCat(field, ".axis"),
             "must be the part's thickness_axis: outlines are cut through the sheet");
    }
    if (prism.outline.size() < 3 || prism.outline.size() > kMaxOutlinePoints) {
      CheckCount(absl::StrCat(field, ".outline"), prism.outline.size(), 3, kMaxOutlinePoints);
      return;
    }
    for (std::size_t i = 0; i < prism.outline.size(); ++i) {
      CheckExpression(absl::StrCat(field, ".outline[", i, "].u"), prism.outline[i].u, names);
      CheckExpression(absl::StrCat(field, ".outline[", i, "].v"), prism.outline[i].v, names);
    }
    CheckExtent(absl::StrCat(field, ".extent"), prism.extent, names);
  }

  // The part of this name, or of whose copy it is the name; reports it missing. How many copies
  // there are is known at parameters only.
  const PartTemplate* CheckPartReference(const std::string& field, const std::string& name) {
    const std::optional<CopyReference> reference = ReadCopyName(name);
    const auto found = std::find_if(definition_.parts.begin(), definition_.parts.end(),
                                    [&](const PartTemplate& part) {
                                      return part.name == (reference ? reference->part : name);
                                    });
    if (found == definition_.parts.end() || !reference) {
      Report(field, absl::StrCat("there is no part '", name, "'",
                                 NamesOffered(name, definition_.parts, &PartTemplate::name)));
      return nullptr;
    }
    if (!reference->numbers.empty() && reference->numbers.size() != found->repeat.size()) {
      Report(field,
             absl::StrCat("there is no copy '", name, "': '", found->name, "' is ",
                          found->repeat.empty()       ? "not repeated"
                          : found->repeat.size() == 1 ? "a row, its copies have one number"
                                                      : "a grid, its copies have two numbers"));
      return nullptr;
    }
    return &*found;
  }

  // Whether a name is that of a part with all of its copies.
  bool MeansCopies(const std::string& name) const {
    return std::any_of(
        definition_.parts.begin(), definition_.parts.end(),
        [&](const PartTemplate& part) { return part.name == name && !part.repeat.empty(); });
  }

  const PartTemplate* CheckFaceReference(const std::string& field, const std::string& part_name,
                                         const std::string& face) {
    const PartTemplate* part = CheckPartReference(absl::StrCat(field, ".part"), part_name);
    if (part == nullptr) return nullptr;
    const std::vector<std::string> faces = FaceNames(*part);
    if (std::find(faces.begin(), faces.end(), face) == faces.end()) {
      Report(absl::StrCat(field, ".face"), absl::StrCat("part '", part_name, "' has no face '",
                                                        face, "'", NamesOffered(face, faces)));
    }
    return part;
  }

  void CheckConnections() {
    std::set<std::string> seen;
    for (std::size_t i = 0; i < definition_.connections.size(); ++i) {
      const Connection& connection = definition_.connections[i];
      const std::string field = absl::StrCat("connections[", i, "]");
      CheckName(absl::StrCat(field, ".name"), connection.name, seen);
      CheckFaceReference(field, connection.part, connection.face);
      CheckPartReference(absl::StrCat(field, ".other_part"), connection.other_part);
      CheckPresent(field, connection.present);
      CheckPairing(field, connection);
      CheckPegs(field, connection);
    }
  }

  void CheckPairing(const std::string& field, const Connection& connection) {
    const bool many = MeansCopies(connection.part);
    const bool many_others = MeansCopies(connection.other_part);
    if (connection.part == connection.other_part &&
        !(many && connection.pairing == Pairing::kTouching)) {
      Report(absl::StrCat(field, ".other_part"),
             many ? "copies of a part are joined to each other with the pairing TOUCHING"
                  : "a part cannot be joined to itself");
    }
    if (connection.pairing == Pairing::kByNumber && !(many && many_others)) {
      Report(absl::StrCat(field, ".pairing"),
             "BY_NUMBER is for two parts that are both repeated; leave it out");
    }
  }

  void CheckPeg(const std::string& field, const std::string& name, const std::string& owner,
                const Connection& connection) {
    const Item* item = FindItem(bundle_.items, name);
    if (item == nullptr) {
      ReportMissingItem(field, name);
      return;
    }
    if (item->kind != ItemKind::kDowel) {
      Report(field, absl::StrCat("'", name, "' is no dowel"));
      return;
    }
    const double least = 2 * item->dimensions[1].size;
    constexpr char kTooNear[] = "must be at least twice the diameter of the peg";
    if (!(connection.spacing >= least)) Report(absl::StrCat(owner, ".spacing"), kTooNear);
    if (connection.row_spacing > 0 && connection.row_spacing < least) {
      Report(absl::StrCat(owner, ".row_spacing"), kTooNear);
    }
  }

  void CheckPegs(const std::string& field, const Connection& connection) {
    CheckPeg(absl::StrCat(field, ".item"), connection.item, field, connection);
    CheckItems(field, connection.items);
    for (std::size_t k = 0; k < connection.items.size(); ++k) {
      CheckPeg(absl::StrCat(field, ".items[", k, "].item"), connection.items[k].item, field,
               connection);
    }
    CheckNotNegative(absl::StrCat(field, ".row_spacing"), connection.row_spacing, findings_);
    CheckNotNegative(absl::StrCat(field, ".side_distance"), connection.side_distance, findings_);
    if (connection.side_distance > 0 && connection.row_spacing == 0) {
      Report(absl::StrCat(field, ".side_distance"),
             "is that of several rows: give their row_spacing");
    }
    if (!std::isfinite(connection.spacing)) {
      Report(absl::StrCat(field, ".spacing"), "is not a finite number");
    }
    if (!(connection.end_distance > 0) || !std::isfinite(connection.end_distance)) {
      Report(absl::StrCat(field, ".end_distance"), "must be a finite number greater than 0");
    }
    if (!(connection.depth_in_part > 0 && connection.depth_in_part < 1)) {
      Report(absl::StrCat(field, ".depth_in_part"), "must lie between 0 and 1, ends excluded");
    }
  }

  void CheckBoundaryConditions() {
    std::set<std::string> seen;
    for (std::size_t i = 0; i < definition_.boundary_conditions.size(); ++i) {
      const BoundaryCondition& condition = definition_.boundary_conditions[i];
      const std::string field = absl::StrCat("boundary_conditions[", i, "]");
      CheckName(absl::StrCat(field, ".name"), condition.name, seen);
      if (ActsOnFace(condition.kind)) {
        CheckFaceReference(field, condition.part, condition.face);
      }
    }
    ConditionExpressions(definition_.boundary_conditions, definition_.reference_temperature, names_,
                         findings_);
  }

  const TemplateBundle& bundle_;
  const TemplateDefinition& definition_;
  const Names names_;
  std::vector<FieldViolation> findings_;
};

}  // namespace

std::vector<FieldViolation> CheckTemplate(const TemplateBundle& bundle) {
  return Checker(bundle).Run();
}

}  // namespace mortise::parametric
