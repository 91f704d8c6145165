// Reads STEP through Open CASCADE's extended data framework.
#include "common/cad/step_reader.h"

#include <BRepBndLib.hxx>
#include <BRepGProp.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <IFSelect_ReturnStatus.hxx>
#include <Interface_Static.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TDF_LabelSequence.hxx>
#include <TopExp_Explorer.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>

#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/step_document.h"

namespace mortise::cad {
namespace {

constexpr int kMaxDepth = 64;  // levels of sub-assemblies

StepPart Measure(const std::string& name, const TopoDS_Shape& shape) {
  StepPart part;
  part.name = name;
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties);
  part.volume = properties.Mass();
  Bnd_Box box;
  BRepBndLib::AddOptimal(shape, box, Standard_False, Standard_False);
  const gp_Pnt low = box.CornerMin(), high = box.CornerMax();
  part.minimum = {low.X(), low.Y(), low.Z()};
  part.maximum = {high.X(), high.Y(), high.Z()};
  return part;
}

void CollectParts(const TDF_Label& label, const TopLoc_Location& location,
                  const std::string& instance_name, int depth, std::vector<StepPart>& parts) {
  if (depth > kMaxDepth) return;
  TDF_Label shape_label = label;
  TopLoc_Location placed = location;
  if (XCAFDoc_ShapeTool::IsReference(label)) {
    placed = location * XCAFDoc_ShapeTool::GetLocation(label);
    XCAFDoc_ShapeTool::GetReferredShape(label, shape_label);
  }
  if (XCAFDoc_ShapeTool::IsAssembly(shape_label)) {
    TDF_LabelSequence components;
    XCAFDoc_ShapeTool::GetComponents(shape_label, components);
    for (const TDF_Label& component : components) {
      CollectParts(component, placed, NameOf(component), depth + 1, parts);
    }
    return;
  }
  const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(shape_label).Located(placed);
  if (!TopExp_Explorer(shape, TopAbs_SOLID).More()) return;
  const std::string product = NameOf(shape_label);
  parts.push_back(Measure(product.empty() ? instance_name : product, shape));
}

// The first string of FILE_SCHEMA(('…')).
std::string SchemaOf(std::string_view bytes) {
  const std::size_t header = bytes.find("FILE_SCHEMA");
  if (header == std::string_view::npos) return "";
  const std::size_t open = bytes.find('\'', header);
  if (open == std::string_view::npos) return "";
  const std::size_t close = bytes.find('\'', open + 1);
  if (close == std::string_view::npos) return "";
  return std::string(bytes.substr(open + 1, close - open - 1));
}

absl::StatusOr<StepAssembly> Read(std::string_view bytes) {
  const std::lock_guard<std::mutex> lock(StepTranslatorMutex());
  const TemporaryFile file(".step");
  MORTISE_RETURN_IF_ERROR(WriteFile(file.path(), bytes));
  Handle(TDocStd_Document) document = NewStepDocument();
  STEPCAFControl_Reader reader;
  // Lengths of the kernel's shapes; the setting exists only once a reader does.
  Interface_Static::SetCVal("xstep.cascade.unit", "M");
  if (reader.ReadFile(file.path().c_str()) != IFSelect_RetDone) {
    return InvalidField("step", "is not a STEP file that can be read");
  }
  const bool transferred = reader.Transfer(document);
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  if (!transferred) return InvalidField("step", "holds no shapes that can be read");
  StepAssembly assembly;
  assembly.schema = SchemaOf(bytes);
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  TDF_LabelSequence roots;
  shapes->GetFreeShapes(roots);
  for (const TDF_Label& root : roots) {
    if (assembly.name.empty()) assembly.name = NameOf(root);
    CollectParts(root, TopLoc_Location(), NameOf(root), 0, assembly.parts);
  }
  if (assembly.parts.empty()) return InvalidField("step", "holds no solid");
  return assembly;
}

}  // namespace

absl::StatusOr<StepAssembly> ReadStep(std::string_view bytes) {
  try {
    return Read(bytes);
  } catch (const Standard_Failure& failure) {
    return InvalidField("step", failure.GetMessageString());
  }
}

}  // namespace mortise::cad
