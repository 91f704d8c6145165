// Checks of a template as it is written, field by field.
#include "common/design/template_checks.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "absl/strings/str_cat.h"
#include "common/base/compared_numbers.h"
#include "common/base/identifiers.h"
#include "common/design/compiled_template.h"
#include "common/design/condition_expressions.h"
#include "common/design/field_checks.h"
#include "common/expressions/expression.h"
#include "common/expressions/identifier.h"

namespace mortise::parametric {
namespace {

constexpr std::size_t kMaxParameters = 64;
constexpr std::size_t kMaxParts = 500;
constexpr std::size_t kMaxOutlinePoints = 200;
constexpr std::size_t kMaxConnections = 2000;
constexpr std::size_t kMaxBoundaryConditions = 500;

// Collects findings about one template.
class Checker {
 public:
  explicit Checker(const TemplateBundle& bundle)
      : bundle_(bundle),
        definition_(bundle.definition),
        parameter_names_(ParameterNames(bundle.definition)) {}

  std::vector<FieldViolation> Run() {
    CheckCount("parameters", definition_.parameters.size(), 1, kMaxParameters);
    CheckCount("parts", definition_.parts.size(), 1, kMaxParts);
    CheckCount("connections", definition_.connections.size(), 0, kMaxConnections);
    CheckCount("boundary_conditions", definition_.boundary_conditions.size(), 0,
               kMaxBoundaryConditions);
    if (IsTooLarge()) return findings_;
    if (const auto id = ParseResourceName(definition_.name, "templates", "name"); !id.ok()) {
      Report("name", "must be 'templates/' and 1 to 63 lower-case letters, digits and hyphens");
    }
    CheckTitle("title", definition_.title, findings_);
    CheckDescription("description", definition_.description, findings_);
    CheckParameters();
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
           definition_.boundary_conditions.size() > kMaxBoundaryConditions;
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

  void CheckExpression(const std::string& field, const std::string& text) {
    const auto parsed = Expression::Parse(text, parameter_names_);
    if (!parsed.ok()) {
      Report(field, absl::StrCat("'", text.substr(0, 80), "': ", parsed.status().message()));
    }
  }

  void CheckExtent(const std::string& field, const Extent& extent) {
    CheckExpression(absl::StrCat(field, ".from"), extent.from);
    CheckExpression(absl::StrCat(field, ".to"), extent.to);
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
      CheckUnit(absl::StrCat(field, ".unit"), parameter.unit, findings_);
      CheckRange(field, parameter);
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
      CheckPartItem(field, part);
      if (part.length_axis == part.thickness_axis) {
        Report(absl::StrCat(field, ".thickness_axis"), "is the same as length_axis");
      }
      if (const Box* box = std::get_if<Box>(&part.body)) {
        CheckExtent(absl::StrCat(field, ".box.x"), box->x);
        CheckExtent(absl::StrCat(field, ".box.y"), box->y);
        CheckExtent(absl::StrCat(field, ".box.z"), box->z);
      } else {
        CheckPrism(absl::StrCat(field, ".prism"), std::get<Prism>(part.body), part);
      }
    }
  }

  void CheckPartItem(const std::string& field, const PartTemplate& part) {
    const Item* item = FindItem(bundle_.items, part.item);
    if (item == nullptr) {
      Report(absl::StrCat(field, ".item"), absl::StrCat("there is no item '", part.item, "'"));
      return;
    }
    if (FindMaterial(bundle_.materials, item->material) == nullptr) {
      Report(absl::StrCat(field, ".item"),
             absl::StrCat("its material '", item->material, "' does not exist"));
    }
    if (item->kind == ItemKind::kDowel || item->kind == ItemKind::kScrew) {
      Report(absl::StrCat(field, ".item"), absl::StrCat("'", part.item,
                                                        "' joins parts; it cannot "
                                                        "be one"));
    }
    if (std::holds_alternative<Prism>(part.body) && item->kind != ItemKind::kSheet &&
        !IsCrosscut(*item)) {
      Report(
          absl::StrCat(field, ".prism"),
          absl::StrCat("'", part.item,
                       "' is neither a sheet, so that an outline could be cut from it, nor lumber "
                       "that is crosscut"));
    }
  }

  // Whether it is lumber whose ends a saw cuts, as an outline across its length may show them.
  static bool IsCrosscut(const Item& item) {
    return item.kind == ItemKind::kBoard && item.dimensions[0].process == Process::kChopSaw;
  }

  void CheckPrism(const std::string& field, const Prism& prism, const PartTemplate& part) {
    const Item* item = FindItem(bundle_.items, part.item);
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
      CheckExpression(absl::StrCat(field, ".outline[", i, "].u"), prism.outline[i].u);
      CheckExpression(absl::StrCat(field, ".outline[", i, "].v"), prism.outline[i].v);
    }
    CheckExtent(absl::StrCat(field, ".extent"), prism.extent);
  }

  // The part of this name; reports it missing.
  const PartTemplate* CheckPartReference(const std::string& field, const std::string& name) {
    const auto found =
        std::find_if(definition_.parts.begin(), definition_.parts.end(),
                     [&name](const PartTemplate& part) { return part.name == name; });
    if (found != definition_.parts.end()) return &*found;
    Report(field, absl::StrCat("there is no part '", name, "'"));
    return nullptr;
  }

  void CheckFaceReference(const std::string& field, const std::string& part_name,
                          const std::string& face) {
    const PartTemplate* part = CheckPartReference(absl::StrCat(field, ".part"), part_name);
    if (part == nullptr) return;
    const std::vector<std::string> faces = FaceNames(*part);
    if (std::find(faces.begin(), faces.end(), face) == faces.end()) {
      Report(absl::StrCat(field, ".face"),
             absl::StrCat("part '", part_name, "' has no face '", face, "'"));
    }
  }

  void CheckConnections() {
    std::set<std::string> seen;
    for (std::size_t i = 0; i < definition_.connections.size(); ++i) {
      const Connection& connection = definition_.connections[i];
      const std::string field = absl::StrCat("connections[", i, "]");
      CheckName(absl::StrCat(field, ".name"), connection.name, seen);
      CheckFaceReference(field, connection.part, connection.face);
      CheckPartReference(absl::StrCat(field, ".other_part"), connection.other_part);
      if (connection.part == connection.other_part) {
        Report(absl::StrCat(field, ".other_part"), "a part cannot be joined to itself");
      }
      CheckPegs(field, connection);
    }
  }

  void CheckPegs(const std::string& field, const Connection& connection) {
    const Item* item = FindItem(bundle_.items, connection.item);
    if (item == nullptr) {
      Report(absl::StrCat(field, ".item"),
             absl::StrCat("there is no item '", connection.item, "'"));
    } else if (item->kind != ItemKind::kDowel) {
      Report(absl::StrCat(field, ".item"), absl::StrCat("'", connection.item, "' is no dowel"));
    } else if (!(connection.spacing >= 2 * item->dimensions[1].size)) {
      Report(absl::StrCat(field, ".spacing"), "must be at least twice the diameter of the peg");
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
    ConditionExpressions(definition_.boundary_conditions, definition_.reference_temperature,
                         parameter_names_, findings_);
  }

  const TemplateBundle& bundle_;
  const TemplateDefinition& definition_;
  const std::vector<std::string> parameter_names_;
  std::vector<FieldViolation> findings_;
};

}  // namespace

std::vector<FieldViolation> CheckTemplate(const TemplateBundle& bundle) {
  return Checker(bundle).Run();
}

}  // namespace mortise::parametric
