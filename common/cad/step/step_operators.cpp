#include "common/cad/step/step_operators.h"

#include <Interface_Graph.hxx>
#include <Interface_HGraph.hxx>
#include <STEPConstruct_Assembly.hxx>
#include <StepData_StepModel.hxx>
#include <StepGeom_CartesianTransformationOperator3d.hxx>
#include <StepGeom_Direction.hxx>
#include <StepRepr_MappedItem.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <StepRepr_ProductDefinitionShape.hxx>
#include <StepRepr_ShapeRepresentationRelationshipWithTransformation.hxx>
#include <StepShape_ContextDependentShapeRepresentation.hxx>
#include <TColStd_HArray1OfReal.hxx>
#include <TopoDS_Shape.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <cmath>
#include <optional>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/cad/step/step_document.h"

namespace mortise::cad {
namespace {

using Operator = Handle(StepGeom_CartesianTransformationOperator3d);

constexpr double kParallel = 1e-9;  // below it, directions that are to span something do not
constexpr double kRigid = 1e-12;

std::optional<Eigen::Vector3d> VectorOf(bool is_there, const Handle(StepGeom_Direction) & drawn) {
  if (!is_there || drawn.IsNull() || drawn->DirectionRatios().IsNull()) return std::nullopt;
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();
  for (int i = 1; i <= std::min(3, drawn->NbDirectionRatios()); ++i) {
    vector[i - 1] = drawn->DirectionRatiosValue(i);
  }
  return vector.normalized();
}

// `vector` without what it has of the others, normalised; nothing if nothing is left.
std::optional<Eigen::Vector3d> Across(Eigen::Vector3d vector,
                                      std::initializer_list<Eigen::Vector3d> others) {
  for (const Eigen::Vector3d& other : others) vector -= vector.dot(other) * other;
  if (!(vector.norm() > kParallel)) return std::nullopt;
  return vector.normalized();
}

// The axes that an operator maps x, y and z to, as ISO 10303-42 derives them (base_axis): the third
// as it is, the others across it. Left-handed, if the operator mirrors.
std::optional<Eigen::Matrix3d> AxesOf(const Operator& drawn) {
  const auto x = VectorOf(drawn->HasAxis1(), drawn->Axis1());
  const auto y = VectorOf(drawn->HasAxis2(), drawn->Axis2());
  auto z = VectorOf(drawn->HasAxis3(), drawn->Axis3());
  if (!z) {
    z = Eigen::Vector3d::UnitZ();
    // Programs also leave out what follows from the other two.
    const bool is_across =
        std::abs(x ? x->z() : 0) < kParallel && std::abs(y ? y->z() : 0) < kParallel;
    if (!is_across && x && y) z = x->cross(*y).normalized();
  }
  if (!(z->norm() > 0.5)) return std::nullopt;
  const Eigen::Vector3d likely =
      std::abs(z->x()) > 1 - kParallel ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX();
  const auto first = Across(x.value_or(likely), {*z});
  if (!first) return std::nullopt;
  const auto second = Across(y.value_or(z->cross(*first)), {*z, *first});
  if (!second) return std::nullopt;
  Eigen::Matrix3d axes;
  axes << *first, *second, *z;
  return axes;
}

Handle(StepGeom_Direction) DirectionOf(const Eigen::Vector3d& vector) {
  Handle(TColStd_HArray1OfReal) ratios = new TColStd_HArray1OfReal(1, 3);
  for (int i = 1; i <= 3; ++i) ratios->SetValue(i, vector[i - 1]);
  Handle(StepGeom_Direction) direction = new StepGeom_Direction();
  direction->Init(new TCollection_HAsciiString(""), ratios);
  return direction;
}

// What the operator does besides moving: a scale, and a mirror across a coordinate plane. Leaves
// the motion in it, which is none that the kernel leaves out.
absl::StatusOr<Eigen::Matrix3d> MakeRigid(const Operator& drawn, int label) {
  const double scale = drawn->HasScale() ? drawn->Scale() : 1;
  if (!(scale > 0) || !std::isfinite(scale)) {
    return InvalidField(
        "step", absl::StrCat("#", label, ": has a scale of ", scale, ", which must be positive"));
  }
  const std::optional<Eigen::Matrix3d> axes = AxesOf(drawn);
  if (!axes || !axes->allFinite()) {
    return InvalidField("step", absl::StrCat("#", label, ": its axes span no frame"));
  }
  Eigen::Vector3d signs = Eigen::Vector3d::Ones();
  if (axes->determinant() < 0) {
    signs.x() = -1;
    if ((*axes * signs.asDiagonal()).isIdentity(kRigid)) signs << 1, -1, 1;
  }
  const Eigen::Matrix3d turn = *axes * signs.asDiagonal();
  drawn->SetAxis1(DirectionOf(turn.col(0)));
  drawn->SetAxis2(DirectionOf(turn.col(1)));
  drawn->SetAxis3(DirectionOf(turn.col(2)));
  drawn->UnSetScale();
  return Eigen::Matrix3d(scale * signs.asDiagonal());
}

// The occurrence that a relation of representations places.
Handle(Standard_Transient)
    OccurrenceOf(const Handle(StepShape_ContextDependentShapeRepresentation) & placed) {
  const Handle(StepRepr_ProductDefinitionShape) shape = placed->RepresentedProductRelation();
  if (shape.IsNull()) return {};
  return shape->Definition().ProductDefinitionRelationship();
}

Eigen::Affine3d Linear(const Eigen::Matrix3d& matrix) {
  Eigen::Affine3d affine = Eigen::Affine3d::Identity();
  affine.linear() = matrix;
  return affine;
}

// The one that was applied last.
Handle(TopLoc_Datum3D) OuterDatum(const TopLoc_Location& location) {
  Handle(TopLoc_Datum3D) outer;
  for (TopLoc_Location rest = location; !rest.IsIdentity(); rest = rest.NextLocation()) {
    outer = rest.FirstDatum();
  }
  return outer;
}

}  // namespace

absl::StatusOr<StepOperators> StepOperators::TakeFrom(STEPCAFControl_Reader& reader) {
  StepOperators operators;
  const Handle(XSControl_WorkSession) session = reader.ChangeReader().WS();
  const auto model = Handle(StepData_StepModel)::DownCast(session->Model());
  // As the file is: what is made here is no part of the model.
  const Handle(Interface_HGraph) graph = session->HGraph();
  std::map<const Standard_Transient*, Eigen::Matrix3d> known;
  const auto take = [&](const Handle(Standard_Transient) & drawn,
                        const Handle(Standard_Transient) & user, bool is_reversed) -> absl::Status {
    const auto taken = Operator::DownCast(drawn);
    if (taken.IsNull()) return absl::OkStatus();
    if (known.count(taken.get()) == 0) {
      MORTISE_ASSIGN_OR_RETURN(known[taken.get()], MakeRigid(taken, model->IdentLabel(taken)));
    }
    const Eigen::Matrix3d& distortion = known[taken.get()];
    if (distortion.isIdentity(kRigid)) return absl::OkStatus();
    if (user.IsNull()) {
      return InvalidField("step", absl::StrCat("#", model->IdentLabel(taken),
                                               ": mirrors or scales something that is no "
                                               "occurrence of a product"));
    }
    operators.users_.push_back({user, distortion, is_reversed});
    return absl::OkStatus();
  };
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(Standard_Transient) entity = model->Value(i);
    const auto item = Handle(StepRepr_MappedItem)::DownCast(entity);
    if (!item.IsNull()) MORTISE_RETURN_IF_ERROR(take(item->MappingTarget(), item, false));
    const auto placed = Handle(StepShape_ContextDependentShapeRepresentation)::DownCast(entity);
    if (placed.IsNull()) continue;
    const auto relation =
        Handle(StepRepr_ShapeRepresentationRelationshipWithTransformation)::DownCast(
            placed->RepresentationRelation());
    if (relation.IsNull()) continue;
    const bool is_reversed = STEPConstruct_Assembly::CheckSRRReversesNAUO(graph->Graph(), placed);
    MORTISE_RETURN_IF_ERROR(
        take(relation->TransformationOperator().Value(), OccurrenceOf(placed), is_reversed));
  }
  return operators;
}

void StepOperators::FindLocations(STEPCAFControl_Reader& reader) {
  const Handle(Transfer_TransientProcess) process =
      reader.ChangeReader().WS()->TransferReader()->TransientProcess();
  for (const User& user : users_) {
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process, user.entity);
    if (shape.IsNull()) continue;
    const Handle(TopLoc_Datum3D) datum = OuterDatum(shape.Location());
    if (datum.IsNull()) continue;
    const Eigen::Affine3d rigid(FromLocation(TopLoc_Location(datum)).matrix());
    const Eigen::Affine3d distortion = Linear(user.distortion);
    placements_[datum.get()] = user.is_reversed ? distortion.inverse() * rigid : rigid * distortion;
    kept_.push_back(shape.Location());
  }
}

bool StepOperators::IsRigid(const TopLoc_Location& location) const {
  if (placements_.empty()) return true;
  for (TopLoc_Location rest = location; !rest.IsIdentity(); rest = rest.NextLocation()) {
    if (placements_.count(rest.FirstDatum().get()) != 0) return false;
  }
  return true;
}

Eigen::Affine3d StepOperators::PlacementOf(const TopLoc_Location& location) const {
  Eigen::Affine3d placement = Eigen::Affine3d::Identity();
  for (TopLoc_Location rest = location; !rest.IsIdentity(); rest = rest.NextLocation()) {
    const auto found = placements_.find(rest.FirstDatum().get());
    Eigen::Affine3d one =
        found != placements_.end()
            ? found->second
            : Eigen::Affine3d(FromLocation(TopLoc_Location(rest.FirstDatum())).matrix());
    if (rest.FirstPower() < 0) one = one.inverse();
    for (int i = 0; i < std::abs(rest.FirstPower()); ++i) placement = one * placement;
  }
  return placement;
}

}  // namespace mortise::cad
