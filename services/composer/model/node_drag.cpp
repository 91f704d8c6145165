#include "services/composer/model/node_drag.h"

#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/assembly/polyhedra/polyhedron_factors.h"
#include "common/base/errors.h"

namespace mortise::composer {
namespace {

using parametric::Demand;
using parametric::LinearForm;
using parametric::NearestPointSearch;
using parametric::Polyhedron;
using parametric::PolyhedronFactor;
using parametric::Projection;

constexpr double kNoChange = 1e-9;   // length of the row of a form that is the same in all designs
constexpr double kParallel = 1e-8;   // between unit rows
constexpr double kRounding = 1e-13;  // of a row's length
constexpr double kSparse = 0.25;     // of entries that are not 0
// m. Ends are approached to so much: exactly there rounding can have demands conflict.
constexpr double kInside = 1e-10;

// A row without what is rounding: it must not tie together what has nothing to do with each other.
Eigen::VectorXd Rounded(const Eigen::VectorXd& row) {
  const double least = kRounding * row.norm();
  return (row.array().abs() <= least).select(0, row);
}

// Rows of equalities, each with the value that the coordinates must give it.
class EqualityRows {
 public:
  explicit EqualityRows(Eigen::Index size) : size_(size) {}

  int Add(const Eigen::VectorXd& row, double value) {
    rows_.push_back(Rounded(row));
    values_.push_back(value);
    return static_cast<int>(rows_.size()) - 1;
  }

  // The same; a row parallel to one that was added so says nothing new, and that one stands for it.
  int AddOnce(const Eigen::VectorXd& row, double value) {
    const Eigen::VectorXd unit = row.normalized();
    Direction direction;
    for (Eigen::Index i = 0; i < unit.size(); ++i) {
      const auto rounded = std::llround(unit[i] / kParallel);
      if (rounded != 0) direction.emplace_back(i, rounded);
    }
    const auto [found, is_new] = known_.try_emplace(std::move(direction), 0);
    if (is_new) found->second = Add(row, value);
    return found->second;
  }

  void WriteTo(Polyhedron* polyhedron) const {
    const auto count = static_cast<Eigen::Index>(rows_.size());
    polyhedron->equalities.resize(count, size_);
    for (Eigen::Index i = 0; i < count; ++i) {
      polyhedron->equalities.row(i) = rows_[static_cast<std::size_t>(i)].transpose();
    }
    polyhedron->values = Eigen::Map<const Eigen::VectorXd>(values_.data(), count);
  }

 private:
  using Direction = std::vector<std::pair<Eigen::Index, std::int64_t>>;  // entries that are not 0

  Eigen::Index size_;
  std::vector<Eigen::VectorXd> rows_;
  std::vector<double> values_;
  std::map<Direction, int> known_;
};

// The factor that an equality is of, and where in its equalities it is.
std::pair<PolyhedronFactor, int> FactorWith(int equality, const Polyhedron& polyhedron) {
  for (PolyhedronFactor& factor : parametric::FactorsOf(polyhedron)) {
    for (std::size_t i = 0; i < factor.equalities.size(); ++i) {
      if (factor.equalities[i] == equality) return {std::move(factor), static_cast<int>(i)};
    }
  }
  return {};
}

}  // namespace

absl::StatusOr<NodeDrag> NodeDrag::Begin(std::shared_ptr<const DragSpace> space, Design design,
                                         const std::string& node, ControlKind kind, Axis axis) {
  MORTISE_ASSIGN_OR_RETURN(ControlledNode controlled,
                           ControlledNode::Find(std::move(space), std::move(design), node));
  NodeDrag drag(std::move(controlled));
  drag.form_ = drag.node_.FormOf(kind, axis);
  drag.name_ = absl::StrCat("the ", kind == ControlKind::kSize ? "size" : "centre", " of '", node,
                            "' along ", AxisName(axis));
  if (!drag.node_.IsFree(drag.form_)) {
    return InvalidField("control", absl::StrCat(drag.name_, " is determined by the design"));
  }
  MORTISE_RETURN_IF_ERROR(drag.Prepare());
  return drag;
}

// Most of a design has nothing to do with one control. What has is a factor of the set, together
// with what holds the model in its place and the sizes that may have to be kept.
absl::Status NodeDrag::Prepare() {
  const parametric::FeasibleSet& free = node_.space().free();
  const Eigen::VectorXd at_beginning = node_.space().CoordinatesOf(node_.now());
  EqualityRows rows(free.degrees_of_freedom());
  for (const Demand& held : node_.held()) {
    rows.Add(node_.RowOf(held.form), held.value - held.form.At(free.drawn()));
  }
  Polyhedron whole{free.normals(), free.slacks(), {}, {}};
  rows.WriteTo(&whole);
  MORTISE_ASSIGN_OR_RETURN(const Projection rest, ProjectOnto(whole, at_beginning));
  if (!rest.point) return absl::InternalError("a feasible design was lost");
  const int control = rows.Add(node_.RowOf(form_), 0);
  const std::vector<parametric::Element>& elements = node_.space().assembly()->elements();
  std::vector<Size> sizes;
  for (std::size_t e = 0; e < elements.size(); ++e) {
    if (elements[e].connecting) continue;
    for (const Axis axis : parametric::kAxes) {
      const int variable = parametric::SizeVariable(static_cast<int>(e), axis);
      const Eigen::VectorXd row = node_.RowOf(LinearForm::Variable(variable));
      if (row.norm() <= kNoChange) continue;
      sizes.push_back(
          {variable, rows.AddOnce(row, node_.now()[variable] - free.drawn()[variable])});
    }
  }
  rows.WriteTo(&whole);
  PrepareFactor(whole, control, sizes, at_beginning, *rest.point);
  return absl::OkStatus();
}

void NodeDrag::PrepareFactor(const Polyhedron& whole, int control, const std::vector<Size>& sizes,
                             const Eigen::VectorXd& at_beginning, Eigen::VectorXd rest) {
  const parametric::FeasibleSet& free = node_.space().free();
  const auto [factor, place] = FactorWith(control, whole);
  control_ = place;
  from_ = EntriesOf(at_beginning, factor);
  SetEntries(Eigen::VectorXd::Zero(from_.size()), factor, rest);
  rest_ = free.drawn() + free.basis() * rest;
  moving_ = free.basis()(Eigen::all, factor.variables);
  const auto full = static_cast<double>((moving_.array() != 0).count());
  if (full <= kSparse * static_cast<double>(moving_.size())) {
    sparse_moving_ = moving_.sparseView();
    moving_.resize(0, 0);
  }
  std::map<int, int> places;  // of the factor's equalities
  for (std::size_t i = 0; i < factor.equalities.size(); ++i) {
    places.emplace(factor.equalities[i], static_cast<int>(i));
  }
  for (const Size& size : sizes) {
    const auto found = places.find(size.row);
    if (found != places.end()) sizes_.push_back({size.variable, found->second});
  }
  const Polyhedron moved = PolyhedronOf(whole, factor);
  row_ = moved.equalities.row(control_).transpose();
  drawn_value_ = form_.At(free.drawn());
  values_ = moved.values;
  search_.emplace(moved);
  for (const Size& size : sizes_) search_->Release(size.row);
  keeping_sizes_ = search_;
}

absl::StatusOr<Design> NodeDrag::To(double value) {
  if (!std::isfinite(value)) return InvalidField("value", "must be finite");
  const double sign = value < form_.At(node_.now()) ? -1 : 1;
  const std::optional<double>& met = ends_[sign < 0 ? 0 : 1];
  if (met && sign * (value - *met) > 0) value = *met - sign * kInside;
  MORTISE_ASSIGN_OR_RETURN(std::optional<Eigen::VectorXd> there, Nearest(value));
  if (!there) {
    MORTISE_ASSIGN_OR_RETURN(const double end, End(sign));
    ends_[sign < 0 ? 0 : 1] = end;
    MORTISE_ASSIGN_OR_RETURN(there, Nearest(end - sign * kInside));
  }
  if (!there) return absl::InternalError(absl::StrCat(name_, " does not come near its end"));
  Design design = FromSpace(node_.space().assembly(), *there);
  MORTISE_ASSIGN_OR_RETURN(design.q, design.assembly->placement().Place(design.q, {}));
  return design;
}

// The nearest design with the value, in space; nothing where there is none.
absl::StatusOr<std::optional<Eigen::VectorXd>> NodeDrag::Nearest(double value) {
  search_->Hold(control_, value - drawn_value_);
  MORTISE_ASSIGN_OR_RETURN(const Projection nearest, search_->NearestTo(from_));
  if (!nearest.point) return std::optional<Eigen::VectorXd>();
  const Eigen::VectorXd there = InSpaceAt(*nearest.point);
  KeepSizes(SizesToKeep(*node_.space().assembly(), node_.now(), there));
  keeping_sizes_->Hold(control_, value - drawn_value_);
  MORTISE_ASSIGN_OR_RETURN(const Projection kept, keeping_sizes_->NearestTo(from_));
  return std::optional<Eigen::VectorXd>(kept.point ? InSpaceAt(*kept.point) : there);
}

// Has the second search keep these sizes and no others.
void NodeDrag::KeepSizes(const std::vector<int>& sizes) {
  std::vector<bool> is_kept(static_cast<std::size_t>(values_.size()), false);
  const std::set<int> wanted(sizes.begin(), sizes.end());
  for (const Size& size : sizes_) {
    if (wanted.contains(size.variable)) is_kept[static_cast<std::size_t>(size.row)] = true;
  }
  for (const Size& size : sizes_) {
    if (is_kept[static_cast<std::size_t>(size.row)]) {
      keeping_sizes_->Hold(size.row, values_[size.row]);
    } else {
      keeping_sizes_->Release(size.row);
    }
  }
}

// The value of the control where it is as large, or small, as it can be.
absl::StatusOr<double> NodeDrag::End(double sign) {
  NearestPointSearch free = *search_;
  free.Release(control_);
  const auto project = [&](const Eigen::VectorXd& x) { return free.NearestTo(x); };
  MORTISE_ASSIGN_OR_RETURN(const parametric::Furthest end,
                           parametric::FurthestBy(project, sign * row_, from_));
  if (!end.point) return absl::InternalError(absl::StrCat(name_, " has no end"));
  return drawn_value_ + row_.dot(*end.point);
}

Eigen::VectorXd NodeDrag::InSpaceAt(const Eigen::VectorXd& entries) const {
  if (sparse_moving_) return rest_ + *sparse_moving_ * entries;
  return rest_ + moving_ * entries;
}

double NodeDrag::ValueIn(const Design& design) const { return form_.At(InSpace(design)); }

std::size_t NodeDrag::MemoryUse() const {
  // The rows of the search, and for each of the two what holds, at most twice over.
  const auto coordinates = static_cast<std::size_t>(from_.size());
  const Eigen::Index moving =
      moving_.size() + (sparse_moving_ ? 2 * sparse_moving_->nonZeros() : 0);
  return sizeof(*this) + static_cast<std::size_t>(moving) * sizeof(double) + search_->MemoryUse() +
         2 * 4 * coordinates * coordinates * sizeof(double) +
         static_cast<std::size_t>(8 * rest_.size()) * sizeof(double);
}

}  // namespace mortise::composer
