// Writes STEP through Open CASCADE's extended data framework, which keeps names and colours.
#include "common/cad/step/step_writer.h"

#include <APIHeaderSection_MakeHeader.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <IFSelect_ReturnStatus.hxx>
#include <Interface_Static.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <Standard_Failure.hxx>
#include <StepBasic_Product.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepBasic_ProductDefinitionFormation.hxx>
#include <StepData_StepModel.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <TCollection_HAsciiString.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <gp_Trsf.hxx>
#include <map>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/step/step_document.h"
#include "common/cad/step/step_readback.h"
#include "common/cad/step/step_structure.h"
#include "common/cad/stretch/closed_faces.h"

namespace mortise::cad {
namespace {

constexpr double kMillimetres = 1000;  // in a metre; the kernel's own unit

const char* NameOf(StepUnit unit) {
  switch (unit) {
    case StepUnit::kMetre:
      return "M";
    case StepUnit::kInch:
      return "INCH";
    default:
      return "MM";
  }
}

TopoDS_Shape InMillimetres(const TopoDS_Shape& shape) {
  gp_Trsf scale;
  scale.SetScale(gp_Pnt(0, 0, 0), kMillimetres);
  return BRepBuilderAPI_Transform(shape, scale, Standard_True).Shape();
}

TopLoc_Location InMillimetres(Eigen::Isometry3d placement) {
  placement.translation() *= kMillimetres;
  return ToLocation(placement);
}

void SetColor(const Handle(XCAFDoc_ColorTool) & colors, const TDF_Label& label,
              const std::optional<Eigen::Vector3d>& color) {
  if (!color) return;
  colors->SetColor(label, Quantity_Color(color->x(), color->y(), color->z(), Quantity_TOC_RGB),
                   XCAFDoc_ColorSurf);
}

const std::string& NameOfGroup(const StepAssembly& assembly, int group) {
  return group == 0 ? assembly.name : assembly.groups[static_cast<std::size_t>(group)].name;
}

// Groups without any part below them would be shapes of nothing.
std::vector<bool> GroupsInUse(const StepAssembly& assembly) {
  std::vector<bool> used(assembly.groups.size(), false);
  for (const StepPart& part : assembly.parts) {
    for (int group = part.group; group >= 0;) {
      used[static_cast<std::size_t>(group)] = true;
      group = assembly.groups[static_cast<std::size_t>(group)].parent;
    }
  }
  return used;
}

void FillDocument(const Handle(TDocStd_Document) & document, const StepAssembly& assembly) {
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const Handle(XCAFDoc_ColorTool) colors = XCAFDoc_DocumentTool::ColorTool(document->Main());
  const std::vector<bool> used = GroupsInUse(assembly);
  std::vector<TDF_Label> groups;
  for (std::size_t i = 0; i < assembly.groups.size(); ++i) {
    const StepGroup& group = assembly.groups[i];
    groups.emplace_back();
    if (!used[i]) continue;
    groups[i] = shapes->NewShape();
    SetName(groups[i], absl::StrCat(i));
    if (group.parent < 0) continue;
    shapes->AddComponent(groups[static_cast<std::size_t>(group.parent)], groups[i],
                         InMillimetres(group.placement));
  }
  std::vector<TDF_Label> products;
  for (const StepProduct& product : assembly.products) {
    products.push_back(
        shapes->AddShape(InMillimetres(product.solid->kernel().shape), Standard_False));
    SetName(products.back(), product.name);
    SetColor(colors, products.back(), product.color);
  }
  for (const StepPart& part : assembly.parts) {
    const TDF_Label label = shapes->AddComponent(groups[static_cast<std::size_t>(part.group)],
                                                 products[static_cast<std::size_t>(part.product)],
                                                 InMillimetres(part.placement));
    SetColor(colors, label, part.color);
  }
  shapes->UpdateAssemblies();
}

// Names of what stands in each group, in the order in which FillDocument adds it.
std::vector<std::vector<std::string>> ComponentNames(const StepAssembly& assembly) {
  const std::vector<bool> used = GroupsInUse(assembly);
  std::vector<std::vector<std::string>> names(assembly.groups.size());
  for (std::size_t i = 1; i < assembly.groups.size(); ++i) {
    const StepGroup& group = assembly.groups[i];
    if (used[i]) names[static_cast<std::size_t>(group.parent)].push_back(group.name);
  }
  for (const StepPart& part : assembly.parts) {
    names[static_cast<std::size_t>(part.group)].push_back(part.name);
  }
  return names;
}

using Usage = Handle(StepRepr_NextAssemblyUsageOccurrence);
using Usages = std::map<Handle(StepBasic_Product), std::vector<Usage>>;

Handle(TCollection_HAsciiString) KernelText(const std::string& text) {
  return new TCollection_HAsciiString(text.c_str());
}

// What stands in each product that is a sub-assembly, in order.
Usages UsagesIn(const Handle(StepData_StepModel) & model) {
  Usages usages;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Usage usage = Usage::DownCast(model->Value(i));
    if (usage.IsNull()) continue;
    usages[usage->RelatingProductDefinition()->Formation()->OfProduct()].push_back(usage);
  }
  return usages;
}

// Numbers the occurrences of this file, where the kernel counts those of the process.
void NumberOccurrences(const Handle(StepData_StepModel) & model) {
  int number = 0;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Usage usage = Usage::DownCast(model->Value(i));
    if (!usage.IsNull()) usage->SetId(KernelText(absl::StrCat(++number)));
  }
}

void Identify(const StepIdentity& identity,
              const Handle(StepBasic_ProductDefinitionFormation) & formation) {
  const Handle(StepBasic_Product) product = formation->OfProduct();
  if (!identity.id.empty()) product->SetId(KernelText(identity.id));
  if (!identity.revision.empty()) formation->SetId(KernelText(identity.revision));
  if (!identity.description.empty()) product->SetDescription(KernelText(identity.description));
}

// The product that is the whole, while sub-assemblies are still called by their numbers; null if
// there is none.
Handle(StepBasic_Product) WholeOf(const Usages& usages) {
  for (const auto& [product, components] : usages) {
    if (std::string_view(product->Name()->ToCString()) == "0") return product;
  }
  return {};
}

// Gives the products of shapes their identities, by their names and, of those called alike, by
// their order; and the whole its own.
void IdentifyProducts(const StepAssembly& assembly, const Usages& usages,
                      const Handle(StepBasic_Product) & whole,
                      const Handle(StepData_StepModel) & model) {
  std::map<std::string, std::vector<const StepIdentity*>> by_name;
  for (const StepProduct& product : assembly.products) {
    by_name[product.name].push_back(&product.identity);
  }
  std::map<std::string, std::size_t> met;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto formation = Handle(StepBasic_ProductDefinitionFormation)::DownCast(model->Value(i));
    if (formation.IsNull()) continue;
    const std::string name = formation->OfProduct()->Name()->ToCString();
    if (usages.contains(formation->OfProduct())) {
      if (formation->OfProduct() == whole) Identify(assembly.identity, formation);
      continue;
    }
    const auto identities = by_name.find(name);
    if (identities == by_name.end()) continue;
    const std::size_t place = std::min(met[name]++, identities->second.size() - 1);
    Identify(*identities->second[place], formation);
  }
}

// Says in the header what the file is of, in place of when and by which file it was written.
void FillHeader(const StepAssembly& assembly, const Handle(StepData_StepModel) & model) {
  APIHeaderSection_MakeHeader header(model);
  header.SetName(KernelText(assembly.name));
  header.SetTimeStamp(
      KernelText(assembly.time_stamp.empty() ? "1970-01-01T00:00:00" : assembly.time_stamp));
}

// The kernel finds the name of an occurrence by its shape and place in its sub-assembly, and takes
// two that agree in both for one, though they stand in different sub-assemblies. So they are named
// here, in their order, and the sub-assemblies, which were numbered till now, with them.
void NameOccurrences(const StepAssembly& assembly, const Usages& usages) {
  const std::vector<std::vector<std::string>> names = ComponentNames(assembly);
  for (const auto& [product, components] : usages) {
    int group = -1;
    if (!absl::SimpleAtoi(product->Name()->ToCString(), &group)) continue;
    const std::vector<std::string>& component_names = names[static_cast<std::size_t>(group)];
    for (std::size_t k = 0; k < std::min(components.size(), component_names.size()); ++k) {
      components[k]->SetName(KernelText(component_names[k]));
    }
    const Handle(TCollection_HAsciiString) name = KernelText(NameOfGroup(assembly, group));
    product->SetName(name);
    product->SetId(name);
  }
}

absl::Status Check(const StepAssembly& assembly) {
  for (std::size_t i = 0; i < assembly.parts.size(); ++i) {
    const auto product = static_cast<std::size_t>(assembly.parts[i].product);
    if (product >= assembly.products.size() || !assembly.products[product].solid) {
      return InvalidField(absl::StrCat("parts[", i, "].product"), "has no solid");
    }
  }
  return absl::OkStatus();
}

// The assembly without products that nothing is made of: they would be roots of the file.
StepAssembly WithoutUnused(const StepAssembly& assembly) {
  StepAssembly used = assembly;
  used.products.clear();
  std::vector<int> places(assembly.products.size(), -1);
  for (StepPart& part : used.parts) {
    int& place = places[static_cast<std::size_t>(part.product)];
    if (place < 0) {
      place = static_cast<int>(used.products.size());
      used.products.push_back(assembly.products[static_cast<std::size_t>(part.product)]);
    }
    part.product = place;
  }
  return used;
}

absl::StatusOr<std::string> Write(const StepAssembly& assembly, StepUnit unit) {
  const std::lock_guard<std::mutex> lock(StepTranslatorMutex());
  const Handle(TDocStd_Document) document = NewStepDocument();
  FillDocument(document, assembly);
  // The settings exist once the controller does, and a writer takes them when it is made.
  STEPCAFControl_Controller::Init();
  Interface_Static::SetCVal("write.step.schema", "AP242DIS");
  Interface_Static::SetCVal("write.step.unit", NameOf(unit));
  Interface_Static::SetCVal("write.step.product.name", assembly.name.c_str());
  STEPCAFControl_Writer writer;
  if (!writer.Transfer(document, STEPControl_AsIs)) {
    return KernelFailure("writing STEP", "the assembly cannot be translated");
  }
  const Handle(StepData_StepModel) model = writer.ChangeWriter().Model();
  const Usages usages = UsagesIn(model);
  NumberOccurrences(model);
  const Handle(StepBasic_Product) whole = WholeOf(usages);
  NameOccurrences(assembly, usages);
  KeepNames(model);
  IdentifyProducts(assembly, usages, whole, model);
  FillHeader(assembly, model);
  const TemporaryFile file(".step");
  if (writer.Write(file.path().c_str()) != IFSelect_RetDone) {
    return KernelFailure("writing STEP", "the file cannot be written");
  }
  return ReadFile(file.path());
}

// A product that would be another solid to whoever reads the file, and a valid one, as one that
// would not.
absl::Status MakeReadable(StepProduct& product) {
  const auto write = [&](const Solid& solid) {
    StepAssembly alone;
    alone.name = product.name;
    alone.groups.push_back({product.name, -1});
    alone.products.push_back({product.name, solid, std::nullopt});
    alone.parts.emplace_back().name = product.name;
    return Write(alone, StepUnit::kMillimetre);
  };
  MORTISE_ASSIGN_OR_RETURN(const std::optional<Solid> readable,
                           ReadableSolid(*product.solid, write));
  if (!readable) {
    return PreconditionFailed(
        "NO_STEP",
        absl::StrCat("'", product.name,
                     "' cannot be written as STEP in this size: a face of it closes on itself, and "
                     "readers take the wrong side of it; ask for GLB, OBJ or STL, or draw it with "
                     "its ball turned"));
  }
  product.solid = *readable;
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::string> WriteStep(const StepAssembly& assembly, StepUnit unit) {
  try {
    MORTISE_RETURN_IF_ERROR(Check(assembly));
    StepAssembly used = WithoutUnused(assembly);
    for (StepProduct& product : used.products) {
      if (!HasClosedFaces(product.solid->kernel().shape)) continue;
      MORTISE_RETURN_IF_ERROR(MakeReadable(product));
    }
    return Write(used, unit);
  } catch (const Standard_Failure& failure) {
    return KernelFailure("writing STEP", failure.GetMessageString());
  }
}

absl::StatusOr<std::string> WriteStep(const std::string& assembly_name,
                                      const std::vector<AssemblyPart>& parts) {
  StepAssembly assembly;
  assembly.name = assembly_name;
  assembly.groups.push_back({assembly_name, -1});
  for (const AssemblyPart& part : parts) {
    StepPart placed;
    placed.name = part.solid.name();
    placed.product = static_cast<int>(assembly.products.size());
    assembly.parts.push_back(std::move(placed));
    assembly.products.push_back({part.solid.name(), part.solid, part.color});
  }
  return WriteStep(assembly);
}

}  // namespace mortise::cad
