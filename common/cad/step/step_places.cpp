#include "common/cad/step/step_places.h"

#include <StepBasic_ProductDefinition.hxx>
#include <StepRepr_MappedItem.hxx>
#include <StepRepr_Representation.hxx>
#include <StepRepr_RepresentationMap.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

namespace mortise::cad {
namespace {

TopoDS_Shape Unplaced(const TopoDS_Shape& shape) { return shape.Located(TopLoc_Location()); }

std::string TextOf(const Handle(TCollection_HAsciiString) & text) {
  return text.IsNull() ? "" : text->ToCString();
}

}  // namespace

StepPlaces::StepPlaces(STEPCAFControl_Reader& reader) {
  const Handle(XSControl_WorkSession) session = reader.ChangeReader().WS();
  const Handle(Transfer_TransientProcess) process = session->TransferReader()->TransientProcess();
  const Handle(Interface_InterfaceModel) model = session->Model();
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(Standard_Transient) entity = model->Value(i);
    const auto item = Handle(StepRepr_MappedItem)::DownCast(entity);
    if (item.IsNull() && !entity->IsKind(STANDARD_TYPE(StepBasic_ProductDefinition))) continue;
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process, entity);
    if (shape.IsNull()) continue;
    wholes_.Bind(Unplaced(shape), 0);
    if (item.IsNull()) continue;
    items_.Bind(shape, static_cast<int>(names_.size()));
    names_.push_back(
        {TextOf(item->Name()), TextOf(item->MappingSource()->MappedRepresentation()->Name())});
  }
}

bool StepPlaces::IsPlaced(const TopoDS_Shape& component) const {
  return wholes_.IsBound(Unplaced(component));
}

StepPlaces::Names StepPlaces::NamesOf(const TopoDS_Shape& component) const {
  return items_.IsBound(component) ? names_[static_cast<std::size_t>(items_.Find(component))]
                                   : Names();
}

}  // namespace mortise::cad
