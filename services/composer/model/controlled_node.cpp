#include "services/composer/model/controlled_node.h"

#include <algorithm>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/model/linear_design.h"
#include "common/assembly/sub_tree.h"
#include "common/base/errors.h"

namespace mortise::composer {
namespace {

using parametric::BoundingBox;
using parametric::Element;
using parametric::LinearForm;

constexpr double kConstrained = 1e-9;  // of a form, the change along any direction of the set

LinearForm FaceForm(int element, Axis axis, double side) {
  return parametric::Combine(1, LinearForm::Variable(parametric::CenterVariable(element, axis)),
                             side, LinearForm::Variable(parametric::SizeVariable(element, axis)));
}

}  // namespace

ControlledNode::ControlledNode(std::shared_ptr<const DragSpace> space, Design design)
    : space_(std::move(space)), design_(std::move(design)), now_(InSpace(design_)) {}

absl::StatusOr<ControlledNode> ControlledNode::Find(std::shared_ptr<const DragSpace> space,
                                                    Design design, const std::string& node) {
  ControlledNode found(std::move(space), std::move(design));
  const parametric::Assembly& assembly = found.design_.assembly->assembly();
  absl::StatusOr<std::vector<std::string>> names = parametric::PartsOfNode(assembly, node);
  if (!names.ok()) {
    return WithDetail(names.status(), {DetailOf(names.status()).reason, "node"});
  }
  const std::set<std::string> wanted(names->begin(), names->end());
  const std::vector<Element>& elements = found.design_.assembly->elements();
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const bool is_inside =
        std::any_of(elements[e].parts.begin(), elements[e].parts.end(), [&](int part) {
          return wanted.contains(assembly.parts[static_cast<std::size_t>(part)].name);
        });
    if (is_inside && !elements[e].connecting) found.elements_.push_back(static_cast<int>(e));
  }
  if (found.elements_.empty()) {
    return InvalidField("node", absl::StrCat("'", node, "' has no principal parts"));
  }
  found.HoldModel();
  return found;
}

LinearForm ControlledNode::FormOf(ControlKind kind, Axis axis) const {
  const Ends ends = EndsOf(elements_, axis);
  return kind == ControlKind::kSize ? ends.upper - ends.lower
                                    : parametric::Combine(0.5, ends.lower, 0.5, ends.upper);
}

Eigen::VectorXd ControlledNode::RowOf(const LinearForm& form) const {
  const Eigen::MatrixXd& basis = space_->free().basis();
  Eigen::VectorXd row = Eigen::VectorXd::Zero(basis.cols());
  for (const parametric::LinearTerm& term : form.terms) {
    row += term.coefficient * basis.row(term.variable).transpose();
  }
  return row;
}

bool ControlledNode::IsFree(const LinearForm& form) const {
  Eigen::VectorXd rest = RowOf(form);
  const double length = rest.norm();
  for (int pass = 0; pass < 2; ++pass) {
    for (const Eigen::VectorXd& kept : held_rows_) rest -= kept.dot(rest) * kept;
  }
  return rest.norm() > kConstrained * std::max(length, 1.0);
}

absl::StatusOr<double> ControlledNode::End(const LinearForm& form, double sign) const {
  MORTISE_ASSIGN_OR_RETURN(const Eigen::VectorXd furthest,
                           space_->free().Furthest(sign * form, held_));
  return form.At(furthest);
}

// What bounds elements along an axis, as they are now; of several the first.
ControlledNode::Ends ControlledNode::EndsOf(const std::vector<int>& elements, Axis axis) const {
  const int a = static_cast<int>(axis);
  int lowest = elements.front(), highest = elements.front();
  for (const int element : elements) {
    const BoundingBox box = ElementBox(design_, element);
    if (box.minimum[a] < ElementBox(design_, lowest).minimum[a]) lowest = element;
    if (box.maximum[a] > ElementBox(design_, highest).maximum[a]) highest = element;
  }
  return {FaceForm(lowest, axis, -0.5), FaceForm(highest, axis, 0.5)};
}

// The model stands on its floor, and the middle of its box stays along x and y.
void ControlledNode::HoldModel() {
  std::vector<int> all;
  const std::vector<Element>& elements = design_.assembly->elements();
  for (std::size_t e = 0; e < elements.size(); ++e) all.push_back(static_cast<int>(e));
  for (const Axis axis : {Axis::kX, Axis::kY}) {
    const Ends ends = EndsOf(all, axis);
    Hold(parametric::Combine(0.5, ends.lower, 0.5, ends.upper));
  }
  Hold(EndsOf(all, Axis::kZ).lower);
}

void ControlledNode::Hold(const LinearForm& form) {
  held_.push_back({form, form.At(now_), "the model stays where it stands"});
  Eigen::VectorXd row = RowOf(form);
  for (int pass = 0; pass < 2; ++pass) {
    for (const Eigen::VectorXd& kept : held_rows_) row -= kept.dot(row) * kept;
  }
  held_rows_.push_back(row.normalized());
}

}  // namespace mortise::composer
