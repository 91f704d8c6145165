#include "services/catalog/exchange/assembly_import.h"

#include <google/protobuf/io/gzip_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/cad/step/step_reader.h"
#include "common/resources/resource_tags.h"
#include "services/catalog/exchange/drawn_coordinates.h"
#include "services/catalog/exchange/item_fit.h"
#include "services/catalog/exchange/part_annotations.h"

namespace mortise::catalog {
namespace {

constexpr double kMaxTolerance = 1e-3;    // m
constexpr std::size_t kMinPacked = 18;    // bytes of gzip around nothing
constexpr double kMinTolerance = 2e-7;    // m; below it, noise of the drawing counts
constexpr double kToleranceShare = 1e-6;  // of the diagonal
constexpr std::size_t kNamesInNote = 5;
constexpr double kColorSteps = 1e5;
constexpr double kRightAngle = 1e-9;  // by which entries of a rotation may miss 0 or 1

// "a, b and 3 more".
std::string Some(const std::vector<std::string>& names) {
  const std::size_t shown = std::min(names.size(), kNamesInNote);
  std::string text = absl::StrJoin(names.begin(), names.begin() + static_cast<long>(shown), ", ");
  if (shown < names.size()) absl::StrAppend(&text, " and ", names.size() - shown, " more");
  return text;
}

class Maker {
 public:
  Maker(const cad::StepAssembly& drawing, const v1::AssemblyAnnotations& annotations,
        const std::vector<parametric::Item>& items)
      : drawing_(drawing), annotations_(annotations), items_(items) {}

  DrawnAssembly Make() {
    drawn_.notes = drawing_.notes;
    assignment_ = AssignAnnotations(drawing_, annotations_, drawn_.findings);
    for (std::size_t i = 0; i < drawing_.parts.size(); ++i) {
      const int annotation = assignment_.parts[i];
      if (annotation < 0 || !annotations_.parts(annotation).left_out()) kept_.push_back(i);
    }
    if (kept_.empty()) {
      drawn_.findings.push_back({"annotations.parts", "leave nothing of the design"});
    }
    drawn_.assembly.set_name(annotations_.name());
    drawn_.assembly.set_title(annotations_.title().empty() ? drawing_.name : annotations_.title());
    drawn_.assembly.set_description(annotations_.description());
    resources::CopyTags(annotations_, &drawn_.assembly);
    MakeGroups();
    MeasureParts();
    for (std::size_t k = 0; k < kept_.size(); ++k) MakePart(k);
    CheckUnused();
    *drawn_.assembly.mutable_joints() = annotations_.joints();
    AddNotes();
    return std::move(drawn_);
  }

 private:
  // ---- Groups -----------------------------------------------------------------------------------

  void MakeGroups() {
    if (annotations_.groups_size() > 0) {
      *drawn_.assembly.mutable_groups() = annotations_.groups();
      for (const v1::AssemblyGroup& group : annotations_.groups()) groups_.insert(group.name());
      return;
    }
    std::vector<bool> used(drawing_.groups.size(), false);
    for (const std::size_t i : kept_) {
      int group = drawing_.parts[i].group;
      for (; group > 0; group = Group(group).parent) used[static_cast<std::size_t>(group)] = true;
    }
    for (std::size_t i = 1; i < drawing_.groups.size(); ++i) {
      if (!used[i]) continue;
      v1::AssemblyGroup& group = *drawn_.assembly.add_groups();
      group.set_name(drawing_.groups[i].name);
      const int parent = drawing_.groups[i].parent;
      if (parent > 0) group.set_parent(Group(parent).name);
      groups_.insert(group.name());
    }
  }

  // The lowest group that a part is in.
  std::string GroupOf(const cad::StepPart& part) const {
    for (int group = part.group; group > 0; group = Group(group).parent) {
      if (groups_.count(Group(group).name) != 0) return Group(group).name;
    }
    return "";
  }

  const cad::StepGroup& Group(int index) const {
    return drawing_.groups[static_cast<std::size_t>(index)];
  }

  // ---- Parts ------------------------------------------------------------------------------------

  double Tolerance(double diagonal) {
    const double asked = annotations_.tolerance();
    if (!(asked >= 0 && asked <= kMaxTolerance)) {
      drawn_.findings.push_back({"annotations.tolerance", "must be 0 to 0.001 m"});
    } else if (asked > 0) {
      return asked;
    }
    return std::max(kMinTolerance, kToleranceShare * diagonal);
  }

  // Boxes without noise: planes of all parts, axis by axis.
  void MeasureParts() {
    Eigen::Vector3d low = Eigen::Vector3d::Constant(INFINITY), high = -low;
    for (const std::size_t i : kept_) {
      low = low.cwiseMin(drawing_.parts[i].minimum);
      high = high.cwiseMax(drawing_.parts[i].maximum);
    }
    tolerance_ = Tolerance(kept_.empty() ? 0 : (high - low).norm());
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> planes;
      for (const std::size_t i : kept_) {
        planes.push_back(drawing_.parts[i].minimum[axis]);
        planes.push_back(drawing_.parts[i].maximum[axis]);
      }
      planes_[axis] = SnapCoordinates(planes, tolerance_);
      for (const double plane : planes_[axis]) ++shared_[axis][plane];
    }
  }

  void MakePart(std::size_t k) {
    const cad::StepPart& part = drawing_.parts[kept_[k]];
    const int annotation = assignment_.parts[kept_[k]];
    v1::AssemblyPart& message = *drawn_.assembly.add_parts();
    drawn_.annotations.push_back(annotation);
    message.set_name(part.name);
    message.set_group(GroupOf(part));
    if (annotation >= 0) Annotate(annotations_.parts(annotation), message);
    Eigen::Vector3d low, size;
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = planes_[axis][2 * k];
      size[axis] = RoundestNear(planes_[axis][2 * k + 1] - low[axis], 1e-12);
    }
    if ((size.array() <= 0).any() || !(part.volume > 0)) {
      drawn_.findings.push_back(
          {"step",
           absl::StrFormat("'%s' is thinner than the tolerance of %g m", part.name, tolerance_)});
      message.clear_item();
      size = size.cwiseMax(tolerance_);
    }
    for (const std::string& fault : part.faults) {
      drawn_.findings.push_back(
          {"step", absl::StrCat("'", cad::PathOf(drawing_, part.group, part.name), "': ", fault)});
    }
    if (part.shape >= 0) {
      message.set_shape(drawing_.shapes[static_cast<std::size_t>(part.shape)].name);
      if (!StandsStraight(part)) leaning_.push_back(part.name);
    }
    SetColor(part, message);
    if (message.item().empty()) bare_.push_back(part.name);
    FitItem(part, annotation, low, size, message);
    Set(low, *message.mutable_position());
    Set(size, *message.mutable_size());
  }

  // Whether only right angles turn it against the design's axes.
  bool StandsStraight(const cad::StepPart& part) const {
    const Eigen::Matrix3d turn = (cad::PlacementOf(drawing_, part.group) * part.placement).linear();
    return (turn.array().abs() * (1 - turn.array().abs())).maxCoeff() < kRightAngle;
  }

  // Annotations that no part shows are checked as they stand.
  void CheckUnused() {
    const std::set<int> used(drawn_.annotations.begin(), drawn_.annotations.end());
    std::vector<int> unused;
    for (int i = 0; i < annotations_.parts_size(); ++i) {
      if (used.count(i) == 0) unused.push_back(i);
    }
    const std::vector<FieldViolation> findings =
        CheckWithoutParts(annotations_, unused, drawn_.assembly.groups(), items_);
    // First what is wrong in itself; what is missing beside it after that.
    drawn_.findings.insert(drawn_.findings.begin(), findings.begin(), findings.end());
  }

  void SetColor(const cad::StepPart& part, v1::AssemblyPart& message) const {
    const auto& drawn =
        part.color ? part.color : drawing_.products[static_cast<std::size_t>(part.product)].color;
    if (!drawn) return;
    // As exact as the kernel keeps it.
    const auto rounded = [](double share) {
      return std::round(std::clamp(share, 0.0, 1.0) * kColorSteps) / kColorSteps;
    };
    Set(drawn->unaryExpr(rounded), *message.mutable_color());
  }

  static void Annotate(const v1::PartAnnotation& annotation, v1::AssemblyPart& message) {
    message.set_title(annotation.title());
    message.set_item(annotation.item());
    message.set_role(annotation.role());
    message.set_length_axis(annotation.length_axis());
    message.set_thickness_axis(annotation.thickness_axis());
    message.set_priority(annotation.priority());
    if (!annotation.group().empty()) message.set_group(annotation.group());
    *message.mutable_prominent_planes() = annotation.prominent_planes();
  }

  // Lays the item into the part's box. Sizes that the item fixes are the item's, from the face that
  // more parts share.
  void FitItem(const cad::StepPart& part, int annotation, Eigen::Vector3d& low,
               Eigen::Vector3d& size, v1::AssemblyPart& message) {
    const parametric::Item* const item = parametric::FindItem(items_, message.item());
    if (item == nullptr) return;
    const auto fit =
        FindFit(*item, size, message.length_axis(), message.thickness_axis(), tolerance_);
    if (!fit) {
      drawn_.findings.push_back({absl::StrCat("annotations.parts[", annotation, "].item"),
                                 absl::StrCat("'", part.name, "' ", DescribeMisfit(size, *item))});
      message.clear_item();
      return;
    }
    message.set_length_axis(fit->length_axis);
    message.set_thickness_axis(fit->thickness_axis);
    for (int axis = 0; axis < 3; ++axis) {
      const double high = low[axis] + size[axis];
      const double changed = fit->size[axis];
      if (changed == size[axis]) continue;
      if (Shares(axis, high) > Shares(axis, low[axis])) low[axis] = high - changed;
      size[axis] = changed;
    }
  }

  int Shares(int axis, double plane) const {
    const auto found = shared_[axis].find(plane);
    return found == shared_[axis].end() ? 0 : found->second;
  }

  static void Set(const Eigen::Vector3d& from, v1::Vector3& to) {
    to.set_x(from.x());
    to.set_y(from.y());
    to.set_z(from.z());
  }

  void AddNotes() {
    if (!leaning_.empty()) {
      drawn_.notes.push_back(
          absl::StrCat("parts at an angle to the design's axes, along which they are stretched: ",
                       Some(leaning_)));
    }
    if (!bare_.empty()) {
      drawn_.notes.push_back(absl::StrCat(
          "parts without an item, principal ones half to twice as large: ", Some(bare_)));
    }
    for (std::size_t i = 0; i < drawing_.leaves.size(); ++i) {
      if (!drawing_.leaves[i].is_surface && assignment_.leaves[i] < 0) {
        drawn_.notes.push_back(
            absl::StrCat("'", drawing_.leaves[i].name, "' has no solid and is left out"));
      }
    }
  }

  const cad::StepAssembly& drawing_;
  const v1::AssemblyAnnotations& annotations_;
  const std::vector<parametric::Item>& items_;
  DrawnAssembly drawn_;
  Assignment assignment_;
  std::vector<std::size_t> kept_;    // parts of the drawing that are parts of the design
  std::set<std::string> groups_;     // names
  double tolerance_ = 0;             // m
  std::vector<double> planes_[3];    // m, lower and upper face of each part that is kept, by axis
  std::map<double, int> shared_[3];  // how many faces lie in a plane
  std::vector<std::string> leaning_, bare_;  // names
};

// ---- Places of findings -------------------------------------------------------------------------

// The index in "parts[3].box" and what follows it; nothing if the field is not of `list`.
std::optional<std::pair<std::size_t, std::string>> SplitIndex(const std::string& field,
                                                              const std::string& list) {
  if (!field.starts_with(list + "[")) return std::nullopt;
  const std::size_t close = field.find(']');
  if (close == std::string::npos) return std::nullopt;
  return std::pair(static_cast<std::size_t>(std::stoul(field.substr(list.size() + 1))),
                   field.substr(close + 1));
}

FieldViolation AtRequest(const FieldViolation& finding, const DrawnAssembly& drawn,
                         const v1::AssemblyAnnotations& annotations) {
  if (const auto part = SplitIndex(finding.field, "parts")) {
    const auto& [index, rest] = *part;
    const std::string& name = drawn.assembly.parts(static_cast<int>(index)).name();
    const std::string quoted = absl::StrCat("'", name, "'");
    const bool is_named = finding.message.starts_with(quoted);
    const std::string message =
        is_named ? finding.message : absl::StrCat(quoted, ": ", finding.message);
    const int annotation = drawn.annotations[index];
    const bool is_drawn = rest.starts_with(".name") || rest.starts_with(".position") ||
                          rest.starts_with(".size") || rest.starts_with(".shape");
    if (annotation < 0) return {"step", message};
    const std::string place = absl::StrCat("annotations.parts[", annotation, "]");
    if (!is_drawn) return {place + rest, message};
    const bool has_item = !annotations.parts(annotation).item().empty();
    return {has_item ? place + ".item" : "step", message};
  }
  const bool is_group = finding.field.starts_with("groups");
  if (finding.field == "parts" || (is_group && annotations.groups_size() == 0)) {
    return {"step", finding.message};
  }
  return {"annotations." + finding.field, finding.message};
}

}  // namespace

absl::StatusOr<std::string> UnpackStep(const std::string& bytes) {
  if (!bytes.starts_with("\x1f\x8b")) return bytes;
  google::protobuf::io::ArrayInputStream packed(bytes.data(), static_cast<int>(bytes.size()));
  google::protobuf::io::GzipInputStream unpacked(&packed,
                                                 google::protobuf::io::GzipInputStream::GZIP);
  std::string whole;
  const void* piece = nullptr;
  int size = 0;
  while (unpacked.Next(&piece, &size)) {
    whole.append(static_cast<const char*>(piece), static_cast<std::size_t>(size));
    if (whole.size() > cad::kMaxStepBytes) return TooLarge("step", "64 MiB unpacked");
  }
  // What was packed says in its last four bytes how long it was.
  const bool was_empty = bytes.size() >= kMinPacked && bytes.ends_with(std::string(4, '\0'));
  if (whole.empty() && was_empty) return InvalidField("step", "is empty");
  if (unpacked.ZlibErrorMessage() != nullptr || whole.empty()) {
    return InvalidField("step", "is packed, but cannot be unpacked");
  }
  return whole;
}

DrawnAssembly MakeAssembly(const cad::StepAssembly& drawing,
                           const v1::AssemblyAnnotations& annotations,
                           const std::vector<parametric::Item>& items) {
  return Maker(drawing, annotations, items).Make();
}

std::string NoteOnHeldSizes(const std::vector<parametric::Measure>& held) {
  if (held.empty()) return "";
  std::vector<std::string> names;
  for (const parametric::Measure& measure : held) {
    names.push_back(absl::StrCat("'", measure.element, "' ", parametric::AxisName(measure.axis)));
  }
  return absl::StrCat(
      "sizes that no item fixes but the design holds, as `adjust --strict` explains: ",
      Some(names));
}

absl::Status AtRequest(const DrawnAssembly& drawn, const v1::AssemblyAnnotations& annotations,
                       const absl::Status& checked) {
  std::vector<FieldViolation> all;
  for (const FieldViolation& finding : drawn.findings) {
    all.push_back({finding.field, finding.message});
  }
  if (!checked.ok() && !absl::IsInvalidArgument(checked)) {
    if (!all.empty()) return InvalidFields(all);
    // Of the design as a whole, which is what the file draws.
    return absl::IsFailedPrecondition(checked) ? UnderField("step", checked) : checked;
  }
  std::set<std::pair<std::string, std::string>> told;
  for (const FieldViolation& violation : AllViolationsOf(checked)) {
    FieldViolation there = AtRequest(violation, drawn, annotations);
    if (told.emplace(there.field, there.message).second) all.push_back(std::move(there));
  }
  return all.empty() ? absl::OkStatus() : InvalidFields(all);
}

}  // namespace mortise::catalog
