#include "services/catalog/exchange/kept_annotations.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "services/catalog/exchange/assembly_import.h"

namespace mortise::catalog {
namespace {

constexpr std::size_t kMaxNamed = 5;
constexpr std::string_view kAnnotated = "annotations.parts[";
constexpr std::string_view kJoint = "joints[";

std::string Listed(const std::vector<std::string>& names) {
  const std::size_t shown = std::min(names.size(), kMaxNamed);
  std::string text = absl::StrJoin(names.begin(), names.begin() + static_cast<long>(shown), ", ");
  if (shown < names.size()) absl::StrAppend(&text, " and ", names.size() - shown, " more");
  return text;
}

// What is said of a part that a drawing does not say.
v1::PartAnnotation AnnotationOf(const v1::AssemblyPart& part) {
  v1::PartAnnotation annotation;
  annotation.set_item(part.item());
  annotation.set_title(part.title());
  if (part.role() == v1::AssemblyPart::CONNECTING) annotation.set_role(part.role());
  annotation.set_length_axis(part.length_axis());
  annotation.set_thickness_axis(part.thickness_axis());
  annotation.set_priority(part.priority());
  *annotation.mutable_prominent_planes() = part.prominent_planes();
  return annotation;
}

// The index in "annotations.parts[3].item", of what begins with `list`; -1 of another field.
int IndexIn(std::string_view list, const std::string& field) {
  if (!field.starts_with(list)) return -1;
  int index = -1;
  const std::size_t end = field.find(']');
  if (end == std::string::npos) return -1;
  const absl::string_view digits(field.data() + list.size(), end - list.size());
  return absl::SimpleAtoi(digits, &index) ? index : -1;
}

class Keeper {
 public:
  Keeper(const v1::Assembly& before, const cad::StepAssembly& drawing,
         const v1::AssemblyAnnotations& asked, const std::vector<parametric::Item>& items)
      : before_(before), drawing_(drawing), items_(items) {
    kept_.annotations = asked;
    for (const cad::StepPart& part : drawing.parts) {
      names_.insert(part.name);
      names_.insert(part.drawn_name);
    }
    for (std::size_t i = 1; i < drawing.groups.size(); ++i) groups_.insert(drawing.groups[i].name);
  }

  KeptAnnotations Keep() {
    KeepGroups();
    for (const v1::AssemblyPart& part : before_.parts()) KeepPart(part);
    for (const v1::Joint& joint : before_.joints()) KeepJoint(joint);
    if (!KeepFormer(kept_.annotations)) {
      KeepTexts();
      LeaveOutMisfits();
    }
    Tell();
    return std::move(kept_);
  }

 private:
  void KeepTexts() {
    if (kept_.annotations.title().empty()) kept_.annotations.set_title(before_.title());
    if (kept_.annotations.description().empty()) {
      kept_.annotations.set_description(before_.description());
    }
    if (kept_.annotations.external_ids().empty()) {
      *kept_.annotations.mutable_external_ids() = before_.external_ids();
    }
    if (kept_.annotations.labels().empty()) {
      *kept_.annotations.mutable_labels() = before_.labels();
    }
  }

  // Where the revision before has some group of the drawing, its groups were the drawing's, which
  // may have others now. So they were, it seems, where it says nothing else of its parts.
  void KeepGroups() {
    const bool are_drawn = std::any_of(
        before_.groups().begin(), before_.groups().end(),
        [&](const v1::AssemblyGroup& group) { return groups_.count(group.name()) != 0; });
    const bool is_annotated = std::any_of(
        before_.parts().begin(), before_.parts().end(),
        [](const v1::AssemblyPart& part) { return AnnotationOf(part).ByteSizeLong() > 0; });
    keeps_groups_ = !before_.groups().empty() && !are_drawn && is_annotated;
    if (!keeps_groups_) return;
    *kept_.annotations.mutable_groups() = before_.groups();
    groups_.clear();
    for (const v1::AssemblyGroup& group : before_.groups()) groups_.insert(group.name());
  }

  void KeepPart(const v1::AssemblyPart& part) {
    v1::PartAnnotation annotation = AnnotationOf(part);
    if (keeps_groups_) annotation.set_group(part.group());
    if (annotation.ByteSizeLong() == 0) return;
    if (names_.count(part.name()) == 0) {
      gone_.push_back(part.name());
      return;
    }
    const bool is_there =
        part.item().empty() || parametric::FindItem(items_, part.item()) != nullptr;
    if (!is_there) {
      misfits_.push_back(absl::StrCat("'", part.name(), "': there is no '", part.item(), "'"));
      annotation.clear_item();
    }
    annotation.add_parts(part.name());
    *kept_.annotations.add_parts() = std::move(annotation);
  }

  void KeepJoint(const v1::Joint& joint) {
    if (groups_.count(joint.group()) == 0) {
      gone_.push_back(joint.name());
      return;
    }
    *kept_.annotations.add_joints() = joint;
  }

  // Of annotations that do not fit the parts any more, leaves out what is said of them but the
  // title and role; and joints that do not fit.
  void LeaveOutMisfits() {
    std::map<int, std::string> faults, of_joints;  // by annotation, by joint
    for (const FieldViolation& finding :
         MakeAssembly(drawing_, kept_.annotations, items_).findings) {
      const int index = IndexIn(kAnnotated, finding.field);
      if (index >= 0) faults.emplace(index, finding.message);
      const int joint = IndexIn(kJoint, finding.field);
      if (joint >= 0) of_joints.emplace(joint, finding.message);
    }
    LeaveOutJoints(of_joints);
    for (const auto& [index, fault] : faults) {
      v1::PartAnnotation& annotation = *kept_.annotations.mutable_parts(index);
      misfits_.push_back(fault);
      annotation.clear_item();
      annotation.clear_length_axis();
      annotation.clear_thickness_axis();
      annotation.clear_prominent_planes();
    }
  }

  void LeaveOutJoints(const std::map<int, std::string>& faults) {
    auto& joints = *kept_.annotations.mutable_joints();
    for (auto fault = faults.rbegin(); fault != faults.rend(); ++fault) {
      misfits_.push_back(absl::StrCat("'", joints[fault->first].name(), "': ", fault->second));
      joints.DeleteSubrange(fault->first, 1);
    }
  }

  void Tell() {
    std::vector<std::string> names;
    for (const v1::PartAnnotation& annotation : kept_.annotations.parts()) {
      names.push_back(annotation.parts(0));
    }
    for (const v1::Joint& joint : kept_.annotations.joints()) names.push_back(joint.name());
    const std::string revision = absl::StrCat("revision ", before_.revision());
    if (!names.empty()) {
      kept_.notes.push_back(absl::StrCat(
          "kept the annotations of ", revision, ", as none came with the drawing: ", Listed(names),
          "; one of parts '", kAllOtherParts, "' alone (--drop-annotations) drops them"));
    }
    if (!gone_.empty()) {
      kept_.notes.push_back(
          absl::StrCat("annotated in ", revision, ", but not in the drawing: ", Listed(gone_)));
    }
    if (!misfits_.empty()) {
      kept_.notes.push_back(
          absl::StrCat("annotations of ", revision, " that no longer fit: ", Listed(misfits_)));
    }
    if (names.empty() && gone_.empty()) return;
    std::set<std::string> known;
    for (const v1::AssemblyPart& part : before_.parts()) known.insert(part.name());
    std::vector<std::string> added;
    for (const cad::StepPart& part : drawing_.parts) {
      if (known.count(part.name) == 0) added.push_back(part.name);
    }
    if (!added.empty()) {
      kept_.notes.push_back(
          absl::StrCat("parts that ", revision, " does not have: ", Listed(added)));
    }
  }

  const v1::Assembly& before_;
  const cad::StepAssembly& drawing_;
  const std::vector<parametric::Item>& items_;
  KeptAnnotations kept_;
  std::set<std::string> names_;   // of parts in the drawing, also as it has them
  std::set<std::string> groups_;  // that there are
  bool keeps_groups_ = false;     // of the revision before, instead of the drawing's
  std::vector<std::string> gone_, misfits_;
};

}  // namespace

bool KeepFormer(const v1::AssemblyAnnotations& annotations) {
  return annotations.parts().empty() && annotations.groups().empty() &&
         annotations.joints().empty();
}

v1::AssemblyAnnotations WithoutDropping(v1::AssemblyAnnotations annotations) {
  if (annotations.parts_size() != 1) return annotations;
  v1::PartAnnotation rest = annotations.parts(0);
  if (rest.parts_size() != 1 || rest.parts(0) != kAllOtherParts) return annotations;
  rest.clear_parts();
  if (rest.ByteSizeLong() == 0) annotations.clear_parts();
  return annotations;
}

KeptAnnotations KeepAnnotations(const v1::Assembly& before, const cad::StepAssembly& drawing,
                                const v1::AssemblyAnnotations& asked,
                                const std::vector<parametric::Item>& items) {
  return Keeper(before, drawing, asked, items).Keep();
}

}  // namespace mortise::catalog
