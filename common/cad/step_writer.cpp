// Writes STEP through Open CASCADE's extended data framework, which keeps names and colours.
#include "common/cad/step_writer.h"

#include <BRepBuilderAPI_Transform.hxx>
#include <BRep_Builder.hxx>
#include <IFSelect_ReturnStatus.hxx>
#include <Interface_Static.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <Standard_Failure.hxx>
#include <TopLoc_Location.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <gp_Trsf.hxx>

#include "common/base/files.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/step_document.h"

namespace mortise::cad {
namespace {

TopoDS_Shape InMillimetres(const TopoDS_Shape& shape) {
  gp_Trsf scale;
  scale.SetScale(gp_Pnt(0, 0, 0), 1000);
  return BRepBuilderAPI_Transform(shape, scale, Standard_True).Shape();
}

void FillDocument(const Handle(TDocStd_Document) & document, const std::string& assembly_name,
                  const std::vector<AssemblyPart>& parts) {
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const Handle(XCAFDoc_ColorTool) colors = XCAFDoc_DocumentTool::ColorTool(document->Main());
  const TDF_Label assembly = shapes->NewShape();
  SetName(assembly, assembly_name);
  for (const AssemblyPart& part : parts) {
    const TDF_Label label =
        shapes->AddShape(InMillimetres(part.solid.kernel().shape), Standard_False);
    SetName(label, part.solid.name());
    colors->SetColor(
        label, Quantity_Color(part.color.x(), part.color.y(), part.color.z(), Quantity_TOC_RGB),
        XCAFDoc_ColorSurf);
    SetName(shapes->AddComponent(assembly, label, TopLoc_Location()), part.solid.name());
  }
  shapes->UpdateAssemblies();
}

absl::StatusOr<std::string> Write(const std::string& assembly_name,
                                  const std::vector<AssemblyPart>& parts) {
  const std::lock_guard<std::mutex> lock(StepTranslatorMutex());
  const Handle(TDocStd_Document) document = NewStepDocument();
  FillDocument(document, assembly_name, parts);
  // The settings exist once the controller does, and a writer takes them when it is made.
  STEPCAFControl_Controller::Init();
  Interface_Static::SetCVal("write.step.schema", "AP242DIS");
  Interface_Static::SetCVal("write.step.unit", "MM");
  Interface_Static::SetCVal("write.step.product.name", assembly_name.c_str());
  STEPCAFControl_Writer writer;
  if (!writer.Transfer(document, STEPControl_AsIs)) {
    return KernelFailure("writing STEP", "the assembly cannot be translated");
  }
  const TemporaryFile file(".step");
  if (writer.Write(file.path().c_str()) != IFSelect_RetDone) {
    return KernelFailure("writing STEP", "the file cannot be written");
  }
  return ReadFile(file.path());
}

}  // namespace

absl::StatusOr<std::string> WriteStep(const std::string& assembly_name,
                                      const std::vector<AssemblyPart>& parts) {
  try {
    return Write(assembly_name, parts);
  } catch (const Standard_Failure& failure) {
    return KernelFailure("writing STEP", failure.GetMessageString());
  }
}

}  // namespace mortise::cad
