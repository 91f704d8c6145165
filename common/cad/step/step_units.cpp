#include "common/cad/step/step_units.h"

#include <STEPConstruct_UnitContext.hxx>
#include <StepBasic_ConversionBasedUnitAndLengthUnit.hxx>
#include <StepBasic_HArray1OfNamedUnit.hxx>
#include <StepBasic_MeasureWithUnit.hxx>
#include <StepBasic_SiUnitAndLengthUnit.hxx>
#include <StepBasic_SiUnitAndPlaneAngleUnit.hxx>
#include <StepBasic_UncertaintyMeasureWithUnit.hxx>
#include <StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx.hxx>
#include <StepGeom_GeometricRepresentationContext.hxx>
#include <StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext.hxx>
#include <StepRepr_GlobalUncertaintyAssignedContext.hxx>
#include <StepRepr_GlobalUnitAssignedContext.hxx>
#include <StepRepr_Representation.hxx>
#include <StepShape_ShapeRepresentation.hxx>
#include <TCollection_HAsciiString.hxx>
#include <cmath>
#include <map>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace mortise::cad {
namespace {

using BothContexts = StepGeom_GeomRepContextAndGlobUnitAssCtxAndGlobUncertaintyAssCtx;
using UnitContext = StepGeom_GeometricRepresentationContextAndGlobalUnitAssignedContext;

constexpr double kMillimetre = 1e-3;   // m
constexpr double kMinAccurate = 5e-5;  // m
constexpr double kSameUnit = 1e-3;     // relative; some take an inch for 25.4000508 mm

// Units by name, m.
const std::map<std::string, double>& NamedLengths() {
  static const std::map<std::string, double> lengths = {
      {"INCH", 0.0254},     {"FOOT", 0.3048},     {"YARD", 0.9144}, {"MIL", 2.54e-5},
      {"MILLIMETRE", 1e-3}, {"MILLIMETER", 1e-3}, {"MM", 1e-3},     {"CENTIMETRE", 1e-2},
      {"CENTIMETER", 1e-2}, {"METRE", 1},         {"METER", 1},     {"MICROMETRE", 1e-6},
      {"MICROMETER", 1e-6}};
  return lengths;
}

Handle(StepRepr_GlobalUnitAssignedContext)
    UnitsOf(const Handle(StepRepr_RepresentationContext) & context) {
  const auto both = Handle(BothContexts)::DownCast(context);
  if (!both.IsNull()) return both->GlobalUnitAssignedContext();
  const auto units = Handle(UnitContext)::DownCast(context);
  return units.IsNull() ? Handle(StepRepr_GlobalUnitAssignedContext)()
                        : units->GlobalUnitAssignedContext();
}

Handle(StepBasic_SiUnitAndLengthUnit) Millimetre() {
  Handle(StepBasic_SiUnitAndLengthUnit) unit = new StepBasic_SiUnitAndLengthUnit();
  unit->Init(Standard_True, StepBasic_spMilli, StepBasic_sunMetre);
  return unit;
}

// m, of a unit or of units; 0 if there is none of length.
template <class Units>
double LengthOf(const Units& units) {
  STEPConstruct_UnitContext computed, known;
  computed.ComputeFactors(units);
  // The kernel counts in whatever unit it is to give shapes in.
  known.ComputeFactors(Handle(StepBasic_NamedUnit)(Millimetre()));
  return computed.LengthDone() ? computed.LengthFactor() / known.LengthFactor() * kMillimetre : 0;
}

double LengthIn(const Handle(StepRepr_GlobalUnitAssignedContext) & units) {
  return units.IsNull() || units->Units().IsNull() ? 0 : LengthOf(units);
}

// The context with millimetres besides what units it has.
Handle(UnitContext) WithMillimetres(const Handle(StepRepr_RepresentationContext) & context) {
  std::vector<Handle(StepBasic_NamedUnit)> units = {Millimetre()};
  const Handle(StepRepr_GlobalUnitAssignedContext) present = UnitsOf(context);
  if (!present.IsNull() && !present->Units().IsNull()) {
    for (int i = 1; i <= present->NbUnits(); ++i) units.push_back(present->UnitsValue(i));
  } else {
    Handle(StepBasic_SiUnitAndPlaneAngleUnit) angle = new StepBasic_SiUnitAndPlaneAngleUnit();
    angle->Init(Standard_False, StepBasic_spMilli, StepBasic_sunRadian);
    units.push_back(angle);
  }
  Handle(StepBasic_HArray1OfNamedUnit) all =
      new StepBasic_HArray1OfNamedUnit(1, static_cast<int>(units.size()));
  for (std::size_t i = 0; i < units.size(); ++i) all->SetValue(static_cast<int>(i) + 1, units[i]);
  const auto name = new TCollection_HAsciiString("");
  Handle(UnitContext) completed = new UnitContext();
  completed->Init(name, name, 3, all);
  return completed;
}

// Of a unit whose name says another length.
std::string NoteOnName(const Handle(StepBasic_ConversionBasedUnitAndLengthUnit) & unit, int label) {
  if (unit.IsNull() || unit->Name().IsNull()) return "";
  const std::string name = absl::AsciiStrToUpper(unit->Name()->ToCString());
  const auto known = NamedLengths().find(name);
  if (known == NamedLengths().end()) return "";
  const double length = LengthOf(Handle(StepBasic_NamedUnit)(unit));
  if (std::abs(length - known->second) <= kSameUnit * known->second) return "";
  return absl::StrFormat("#%d: the unit %s is %g mm, not %g mm as it should be", label, name,
                         length / kMillimetre, known->second / kMillimetre);
}

// Of an accuracy that is none.
std::string LimitUncertainty(const Handle(BothContexts) & context) {
  if (context.IsNull() || context->GlobalUncertaintyAssignedContext().IsNull()) return "";
  const auto uncertainty = context->GlobalUncertaintyAssignedContext();
  const double unit = LengthIn(context->GlobalUnitAssignedContext());
  if (uncertainty->Uncertainty().IsNull() || !(unit > 0)) return "";
  std::string note;
  for (int i = 1; i <= uncertainty->NbUncertainty(); ++i) {
    const Handle(StepBasic_UncertaintyMeasureWithUnit) value = uncertainty->UncertaintyValue(i);
    if (value.IsNull() || value->ValueComponentMember().IsNull()) continue;
    const double stated = value->ValueComponent() * unit;
    if (!(stated > kMinAccurate)) continue;
    value->SetValueComponent(kMinAccurate / unit);
    note = absl::StrFormat("the file says that it is accurate to %g mm only; %g mm are taken",
                           stated / kMillimetre, kMinAccurate / kMillimetre);
  }
  return note;
}

}  // namespace

std::vector<std::string> CompleteUnits(const Handle(StepData_StepModel) & model) {
  std::vector<std::string> notes;
  const auto tell = [&notes](std::string note) {
    if (note.empty()) return;
    for (const std::string& told : notes) {
      if (told == note) return;
    }
    notes.push_back(std::move(note));
  };
  std::map<const Standard_Transient*, Handle(UnitContext)> completed;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(Standard_Transient) entity = model->Value(i);
    tell(NoteOnName(Handle(StepBasic_ConversionBasedUnitAndLengthUnit)::DownCast(entity),
                    model->IdentLabel(entity)));
    tell(LimitUncertainty(Handle(BothContexts)::DownCast(entity)));
    const auto shape = Handle(StepShape_ShapeRepresentation)::DownCast(entity);
    if (shape.IsNull() || shape->ContextOfItems().IsNull()) continue;
    const Handle(StepRepr_RepresentationContext) context = shape->ContextOfItems();
    if (LengthIn(UnitsOf(context)) > 0) continue;
    Handle(UnitContext)& known = completed[context.get()];
    if (known.IsNull()) known = WithMillimetres(context);
    shape->SetContextOfItems(known);
    tell("the file has no unit of length; it is taken to be in millimetres");
  }
  return notes;
}

}  // namespace mortise::cad
