#include "services/catalog/exchange/part_annotations.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "common/assembly/codec/assembly_codec.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/design/field_checks.h"

namespace mortise::catalog {
namespace {

constexpr absl::string_view kParts = "parts[";

class Assigner {
 public:
  Assigner(const cad::StepAssembly& drawing, const v1::AssemblyAnnotations& annotations,
           std::vector<FieldViolation>& findings)
      : drawing_(drawing), annotations_(annotations), findings_(findings) {
    for (const cad::StepPart& part : drawing.parts) {
      const std::string& product = drawing.products[static_cast<std::size_t>(part.product)].name;
      AddEntry(part.name, part.drawn_name, part.group, product);
    }
    for (const cad::StepLeaf& leaf : drawing.leaves) {
      AddEntry(leaf.name, leaf.drawn_name, leaf.group, leaf.product);
    }
    own_.assign(names_.size(), -1);
    products_.assign(names_.size(), -1);
  }

  Assignment Assign() {
    for (int i = 0; i < annotations_.parts_size(); ++i) AssignOne(i);
    Assignment assignment;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const int annotation = own_[i] >= 0 ? own_[i] : products_[i];
      (i < drawing_.parts.size() ? assignment.parts : assignment.leaves).push_back(annotation);
    }
    CheckLeaves(assignment);
    return assignment;
  }

 private:
  using Index = std::map<std::string, std::vector<std::size_t>>;

  void AddEntry(const std::string& name, const std::string& drawn_name, int group,
                const std::string& product) {
    const std::size_t index = names_.size();
    names_.push_back(name);
    by_name_[name].push_back(index);
    by_path_[cad::PathOf(drawing_, group, name)].push_back(index);
    by_path_[cad::PathOf(drawing_, group, drawn_name)].push_back(index);
    by_drawn_name_[drawn_name].push_back(index);
    by_product_[product].push_back(index);
  }

  void AssignOne(int annotation) {
    const v1::PartAnnotation& message = annotations_.parts(annotation);
    const std::string field = absl::StrCat("annotations.parts[", annotation, "]");
    std::size_t count = 0;
    if (message.parts().empty() == message.product().empty()) {
      findings_.push_back({message.parts().empty() ? field + ".parts" : field + ".product",
                           message.parts().empty()
                               ? "or product must say what is meant"
                               : "and parts cannot both be given; write two annotations"});
      return;
    }
    for (int i = 0; i < message.parts_size(); ++i) {
      const std::string place = absl::StrCat(field, ".parts[", i, "]");
      count += AssignTo(Find(message.parts(i)), message.parts(i), annotation, place, own_);
    }
    if (!message.product().empty()) {
      const auto found = by_product_.find(message.product());
      static const std::vector<std::size_t> none;
      count += AssignTo(found == by_product_.end() ? none : found->second, message.product(),
                        annotation, field + ".product", products_);
    }
    CheckItself(message, field, count);
  }

  // Parts by name, else by path, else by the name they have in the file.
  std::vector<std::size_t> Find(const std::string& text) const {
    for (const Index* index : {&by_name_, &by_path_, &by_drawn_name_}) {
      const auto found = index->find(text);
      if (found == index->end()) continue;
      std::vector<std::size_t> entries = found->second;
      entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
      return entries;
    }
    return {};
  }

  std::size_t AssignTo(const std::vector<std::size_t>& entries, const std::string& text,
                       int annotation, const std::string& place, std::vector<int>& owners) {
    if (entries.empty()) {
      findings_.push_back(
          {place, absl::StrCat("there is nothing called '", text, "' in the file")});
    }
    for (const std::size_t entry : entries) {
      if (owners[entry] >= 0) {
        findings_.push_back(
            {place, absl::StrCat("'", names_[entry], "' has an annotation already: parts[",
                                 owners[entry], "]")});
        continue;
      }
      owners[entry] = annotation;
    }
    return entries.size();
  }

  void CheckItself(const v1::PartAnnotation& message, const std::string& field, std::size_t count) {
    v1::PartAnnotation rest = message;
    rest.clear_parts();
    rest.clear_product();
    rest.clear_left_out();
    rest.clear_title();
    if (message.left_out() && rest.ByteSizeLong() > 0) {
      findings_.push_back({field + ".left_out", "is contradicted by what else is said"});
    }
    if (message.prominent_planes_size() > 0 && count > 1) {
      findings_.push_back(
          {field + ".prominent_planes", absl::StrCat("are of one part, not of ", count)});
    }
  }

  void CheckLeaves(const Assignment& assignment) {
    for (std::size_t i = 0; i < drawing_.leaves.size(); ++i) {
      const cad::StepLeaf& leaf = drawing_.leaves[i];
      const int annotation = assignment.leaves[i];
      if (annotation >= 0 && annotations_.parts(annotation).left_out()) continue;
      const std::string path = cad::PathOf(drawing_, leaf.group, leaf.name);
      if (annotation >= 0) {
        findings_.push_back({absl::StrCat("annotations.parts[", annotation, "]"),
                             absl::StrCat("'", path, "' is no solid; it can only be left out")});
      } else if (leaf.is_surface) {
        findings_.push_back({"step", absl::StrCat("'", path,
                                                  "' is a surface, not a solid: close it, or have "
                                                  "it left_out by an annotation")});
      }
    }
  }

  const cad::StepAssembly& drawing_;
  const v1::AssemblyAnnotations& annotations_;
  std::vector<FieldViolation>& findings_;
  std::vector<std::string> names_;  // of parts, then of leaves
  Index by_name_, by_path_, by_drawn_name_, by_product_;
  std::vector<int> own_, products_;  // annotations of each
};

// A part as an annotation says, in a box of its own.
v1::AssemblyPart PartOf(const v1::PartAnnotation& annotation, int index) {
  v1::AssemblyPart part;
  part.set_name(absl::StrCat("part ", index));
  part.set_title(annotation.title());
  part.set_item(annotation.item());
  part.set_role(annotation.role());
  part.set_length_axis(annotation.length_axis());
  part.set_thickness_axis(annotation.thickness_axis());
  part.set_group(annotation.group());
  part.set_priority(annotation.priority());
  *part.mutable_prominent_planes() = annotation.prominent_planes();
  part.mutable_position()->set_x(index);
  v1::Vector3& size = *part.mutable_size();
  size.set_x(0.5);
  size.set_y(0.5);
  size.set_z(0.5);
  return part;
}

// Whether a field of a part is what an annotation says, not what the part measures.
bool IsAnnotated(std::string_view rest) {
  static constexpr std::string_view kFields[] = {
      ".title",       ".item",           ".role",     ".group",
      ".length_axis", ".thickness_axis", ".priority", ".prominent_planes"};
  const bool is_among =
      std::any_of(std::begin(kFields), std::end(kFields),
                  [&](std::string_view field) { return rest.starts_with(field); });
  return is_among && !rest.ends_with(".position");
}

}  // namespace

std::vector<FieldViolation> CheckWithoutParts(
    const v1::AssemblyAnnotations& annotations, const std::vector<int>& which,
    const google::protobuf::RepeatedPtrField<v1::AssemblyGroup>& groups,
    const std::vector<parametric::Item>& items) {
  if (which.empty()) return {};
  v1::Assembly assembly;
  assembly.set_name("assemblies/alone");
  *assembly.mutable_groups() = groups;
  for (const int i : which) *assembly.add_parts() = PartOf(annotations.parts(i), i);
  std::vector<FieldViolation> findings;
  const absl::Status checked = parametric::FromProto(assembly, items).status();
  for (const FieldViolation& violation : AllViolationsOf(checked)) {
    const absl::string_view field = violation.field;
    const std::size_t close = field.find(']');
    int index = 0;
    if (!absl::StartsWith(field, kParts) || close == absl::string_view::npos ||
        !absl::SimpleAtoi(field.substr(kParts.size(), close - kParts.size()), &index)) {
      continue;
    }
    const int annotation = which[static_cast<std::size_t>(index)];
    const std::string rest(field.substr(close + 1));
    // Shapes of items that exist are not looked up here.
    const bool is_of_known_item =
        rest == ".item" &&
        parametric::FindItem(items, annotations.parts(annotation).item()) != nullptr;
    if (!IsAnnotated(rest) || is_of_known_item) continue;
    findings.push_back(
        {absl::StrCat("annotations.parts[", annotation, "]", rest), violation.message});
  }
  return findings;
}

std::vector<FieldViolation> CheckWithoutDrawing(const v1::AssemblyAnnotations& annotations,
                                                const std::vector<parametric::Item>& items) {
  std::vector<FieldViolation> findings;
  if (!ParseResourceName(annotations.name(), "assemblies", "name").ok()) {
    findings.push_back({"annotations.name",
                        "must be 'assemblies/' and 1 to 63 lower-case letters, digits and "
                        "hyphens"});
  }
  parametric::CheckTitle("annotations.title", annotations.title(), findings);
  parametric::CheckDescription("annotations.description", annotations.description(), findings);
  std::vector<int> all;
  for (int i = 0; i < annotations.parts_size(); ++i) all.push_back(i);
  for (FieldViolation& finding : CheckWithoutParts(annotations, all, annotations.groups(), items)) {
    // Groups may be those of the file.
    if (annotations.groups_size() == 0 && absl::EndsWith(finding.field, ".group")) continue;
    findings.push_back(std::move(finding));
  }
  return findings;
}

Assignment AssignAnnotations(const cad::StepAssembly& drawing,
                             const v1::AssemblyAnnotations& annotations,
                             std::vector<FieldViolation>& findings) {
  return Assigner(drawing, annotations, findings).Assign();
}

}  // namespace mortise::catalog
