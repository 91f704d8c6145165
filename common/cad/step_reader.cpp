// Reads STEP through Open CASCADE's extended data framework.
#include "common/cad/step_reader.h"

#include <IFSelect_ReturnStatus.hxx>
#include <Interface_Static.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDF_Tool.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <cctype>
#include <map>
#include <memory>
#include <sstream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/solid_shape.h"
#include "common/cad/step_document.h"
#include "common/cad/step_measure.h"
#include "common/cad/step_references.h"
#include "common/cad/step_structure.h"

namespace mortise::cad {
namespace {

constexpr std::string_view kBegin = "ISO-10303-21;";
constexpr std::string_view kEnd = "END-ISO-10303-21;";
constexpr int kMaxDepth = 64;  // levels of sub-assemblies
constexpr double kSameTurn = 1e-12;

// Whether a name is one that a program made up for an occurrence: "NAUO12", "3", "=>[0:1:1:2]".
bool IsMadeUp(const std::string& name) {
  if (name.empty() || name.starts_with("=>[")) return true;
  const std::string number = name.starts_with("NAUO") ? name.substr(4) : name;
  return std::all_of(number.begin(), number.end(),
                     [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; });
}

// Walks the document's tree and collects what stands in it.
class Collector {
 public:
  Collector(const Handle(TDocStd_Document) & document, StepAssembly& assembly)
      : shapes_(XCAFDoc_DocumentTool::ShapeTool(document->Main())),
        colors_(XCAFDoc_DocumentTool::ColorTool(document->Main())),
        assembly_(assembly) {}

  absl::Status Collect() {
    TDF_LabelSequence roots;
    shapes_->GetFreeShapes(roots);
    assembly_.groups.push_back({});
    // One assembly is the root itself.
    const bool is_one = roots.Length() == 1 && XCAFDoc_ShapeTool::IsAssembly(roots.First());
    for (const TDF_Label& root : roots) {
      if (assembly_.name.empty()) assembly_.name = NameOf(root);
      if (is_one) {
        MORTISE_RETURN_IF_ERROR(CollectComponents(root, 0, 0));
      } else {
        MORTISE_RETURN_IF_ERROR(CollectOne(root, 0, 0));
      }
    }
    assembly_.groups[0].name = assembly_.name;
    return absl::OkStatus();
  }

 private:
  absl::Status CollectComponents(const TDF_Label& whole, int group, int depth) {
    if (depth > kMaxDepth) {
      return InvalidField("step",
                          absl::StrCat("has sub-assemblies deeper than ", kMaxDepth, " levels"));
    }
    TDF_LabelSequence components;
    XCAFDoc_ShapeTool::GetComponents(whole, components);
    for (const TDF_Label& component : components) {
      MORTISE_RETURN_IF_ERROR(CollectOne(component, group, depth));
    }
    return absl::OkStatus();
  }

  absl::Status CollectOne(const TDF_Label& occurrence, int group, int depth) {
    TDF_Label product = occurrence;
    Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
    if (XCAFDoc_ShapeTool::IsReference(occurrence)) {
      placement = FromLocation(XCAFDoc_ShapeTool::GetLocation(occurrence));
      XCAFDoc_ShapeTool::GetReferredShape(occurrence, product);
    }
    const std::string product_name = NameOf(product);
    std::string name = NameOf(occurrence);
    if (IsMadeUp(name) && !product_name.empty()) name = product_name;
    if (XCAFDoc_ShapeTool::IsAssembly(product)) {
      assembly_.groups.push_back({name, group, placement});
      return CollectComponents(product, static_cast<int>(assembly_.groups.size()) - 1, depth + 1);
    }
    return CollectLeaf(occurrence, product, name, group, placement);
  }

  absl::Status CollectLeaf(const TDF_Label& occurrence, const TDF_Label& product,
                           const std::string& name, int group, const Eigen::Isometry3d& placement) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<int> solids, ProductsOf(product));
    for (const int solid : solids) {
      if (assembly_.parts.size() == static_cast<std::size_t>(kMaxStepParts)) {
        return TooLarge("step", absl::StrCat(kMaxStepParts, " parts"));
      }
      StepPart part;
      part.drawn_name = name;
      part.group = group;
      part.product = solid;
      part.placement = placement;
      part.color = ColorOf(occurrence);
      const Eigen::Isometry3d where = PlacementOf(assembly_, group) * placement;
      measurers_[static_cast<std::size_t>(solid)]->Measure(where, part);
      if (!part.is_box && part.volume > 0) SetShape(where, part);
      assembly_.parts.push_back(std::move(part));
    }
    if (solids.empty()) {
      const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(product);
      const bool has_faces = !shape.IsNull() && TopExp_Explorer(shape, TopAbs_FACE).More();
      assembly_.leaves.push_back({"", name, NameOf(product), group, has_faces});
    }
    return absl::OkStatus();
  }

  // What the part looks like: drawn once for all parts of its product that are turned alike.
  void SetShape(const Eigen::Isometry3d& placement, StepPart& part) {
    for (const TurnedShape& known : shapes_drawn_) {
      if (known.product != part.product ||
          !known.rotation.isApprox(placement.linear(), kSameTurn)) {
        continue;
      }
      part.shape = known.shape;
      part.faults = known.faults;
      return;
    }
    TurnedShape turned{part.product, placement.linear(), -1, {}};
    absl::StatusOr<mesh::DrawnShape> shape = ShapeOfSolid(
        *assembly_.products[static_cast<std::size_t>(part.product)].solid, placement.linear(),
        part.minimum - placement.translation(), part.maximum - placement.translation());
    if (shape.ok()) {
      turned.shape = static_cast<int>(assembly_.shapes.size());
      assembly_.shapes.push_back(*std::move(shape));
    } else {
      turned.faults = FaultsOf(shape.status());
    }
    part.shape = turned.shape;
    part.faults = turned.faults;
    shapes_drawn_.push_back(std::move(turned));
  }

  static std::vector<std::string> FaultsOf(const absl::Status& status) {
    std::vector<std::string> faults;
    for (const FieldViolation& violation : ViolationsOf(status)) {
      faults.push_back(violation.message);
    }
    if (!faults.empty()) return faults;
    std::string message(status.message());
    if (message.starts_with("shape: ")) message.erase(0, 7);
    return {message};
  }

  // Indices of the solids of a product, each a product of its own.
  absl::StatusOr<std::vector<int>> ProductsOf(const TDF_Label& label) {
    TCollection_AsciiString entry;
    TDF_Tool::Entry(label, entry);
    const auto [known, is_new] = products_.try_emplace(entry.ToCString());
    if (!is_new) return known->second;
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
    if (shape.IsNull()) return known->second;
    const std::string name = NameOf(label);
    for (TopExp_Explorer solid(shape, TopAbs_SOLID); solid.More(); solid.Next()) {
      if (known->second.size() == static_cast<std::size_t>(kMaxStepParts)) {
        return TooLarge("step", absl::StrCat(kMaxStepParts, " parts"));
      }
      auto kernel = std::make_shared<Solid::Kernel>();
      kernel->name = name;
      kernel->shape = solid.Current();
      measurers_.push_back(std::make_unique<SolidMeasurer>(kernel->shape));
      known->second.push_back(static_cast<int>(assembly_.products.size()));
      assembly_.products.push_back({name, Solid(std::move(kernel)), ColorOf(label)});
      if (!assembly_.products.back().color) {
        assembly_.products.back().color = ColorOf(solid.Current());
      }
    }
    if (known->second.size() > 1) {
      assembly_.notes.push_back(absl::StrCat("product '", name, "' has ", known->second.size(),
                                             " solids; each is a part"));
    }
    return known->second;
  }

  template <class LabelOrShape>
  std::optional<Eigen::Vector3d> ColorOf(const LabelOrShape& what) const {
    Quantity_Color color;
    for (const XCAFDoc_ColorType type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen}) {
      if (Get(what, type, color)) return Eigen::Vector3d(color.Red(), color.Green(), color.Blue());
    }
    return std::nullopt;
  }
  bool Get(const TDF_Label& label, XCAFDoc_ColorType type, Quantity_Color& color) const {
    return colors_->GetColor(label, type, color);
  }
  bool Get(const TopoDS_Shape& shape, XCAFDoc_ColorType type, Quantity_Color& color) const {
    return colors_->GetColor(shape, type, color);
  }

  const Handle(XCAFDoc_ShapeTool) shapes_;
  const Handle(XCAFDoc_ColorTool) colors_;
  StepAssembly& assembly_;
  std::map<std::string, std::vector<int>> products_;       // by the label's path in the document
  std::vector<std::unique_ptr<SolidMeasurer>> measurers_;  // of each product
  // A product's shape as parts have it that are turned so.
  struct TurnedShape {
    int product = 0;
    Eigen::Matrix3d rotation;
    int shape = -1;  // index into StepAssembly::shapes; -1 if there are faults
    std::vector<std::string> faults;
  };
  std::vector<TurnedShape> shapes_drawn_;
};

// Gives parts, leaves and groups distinct names, and says where they differ from the file's.
void NameAll(StepAssembly& assembly) {
  std::vector<std::string> names;
  for (const StepPart& part : assembly.parts) names.push_back(part.drawn_name);
  for (const StepLeaf& leaf : assembly.leaves) names.push_back(leaf.drawn_name);
  const std::vector<std::string> distinct = DistinctNames(names, "part");
  std::map<std::string, std::vector<std::string>> renamed;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::size_t leaf = i - std::min(i, assembly.parts.size());
    (i < assembly.parts.size() ? assembly.parts[i].name : assembly.leaves[leaf].name) = distinct[i];
    if (distinct[i] != names[i]) renamed[names[i]].push_back(distinct[i]);
  }
  names.clear();
  for (const StepGroup& group : assembly.groups) names.push_back(group.name);
  names.erase(names.begin());
  const std::vector<std::string> groups = DistinctNames(names, "group");
  for (std::size_t i = 0; i < groups.size(); ++i) {
    assembly.groups[i + 1].name = groups[i];
    if (groups[i] != names[i]) renamed[names[i]].push_back(groups[i]);
  }
  for (const auto& [name, now] : renamed) {
    assembly.notes.push_back(now.size() == 1 ? absl::StrCat("'", name, "' is called '", now[0], "'")
                                             : absl::StrCat("'", name, "' occurs ", now.size(),
                                                            " times; they are called '", now[0],
                                                            "' to '", now.back(), "'"));
  }
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

absl::Status CheckFrame(std::string_view bytes) {
  constexpr std::string_view kBlank = " \t\r\n\0";
  if (bytes.size() > kMaxStepBytes) return TooLarge("step", "64 MiB");
  if (bytes.find_first_not_of(kBlank) == std::string_view::npos) {
    return InvalidField("step", "is empty");
  }
  // Some programs write a mark of the encoding first.
  if (bytes.substr(0, 256).find(kBegin) == std::string_view::npos) {
    return InvalidField("step", "is not a STEP file: it does not begin with ISO-10303-21;");
  }
  const std::size_t tail = bytes.size() - std::min<std::size_t>(bytes.size(), 4096);
  if (bytes.substr(tail).find(kEnd) == std::string_view::npos) {
    return InvalidField("step", "is cut off: it does not end with END-ISO-10303-21;");
  }
  return absl::OkStatus();
}

// That the file has all that it refers to.
absl::Status CheckReferences(std::string_view bytes) {
  constexpr std::size_t kMaxShown = 5;
  const std::vector<MissingEntity> missing = MissingEntities(bytes, kMaxShown + 1);
  if (missing.empty()) return absl::OkStatus();
  std::vector<std::string> faults;
  for (std::size_t i = 0; i < std::min(missing.size(), kMaxShown); ++i) {
    const std::string user = missing[i].user == 0 ? "" : absl::StrCat(" by #", missing[i].user);
    faults.push_back(
        absl::StrCat("#", missing[i].number, " is used", user, ", but is not in the file"));
  }
  if (missing.size() > kMaxShown) faults.push_back("and more are missing");
  return InvalidField("step", absl::StrJoin(faults, "; "));
}

// Lengths of the kernel's shapes while one reads, for all the process. The setting exists only once
// a reader does.
class InMetres {
 public:
  InMetres() { Interface_Static::SetCVal("xstep.cascade.unit", "M"); }
  ~InMetres() { Interface_Static::SetCVal("xstep.cascade.unit", "MM"); }
  InMetres(const InMetres&) = delete;
  InMetres& operator=(const InMetres&) = delete;
};

absl::StatusOr<StepAssembly> Read(std::string_view bytes, const StepFaultsSeen& seen) {
  MORTISE_RETURN_IF_ERROR(CheckFrame(bytes));
  MORTISE_RETURN_IF_ERROR(CheckReferences(bytes));
  const std::lock_guard<std::mutex> lock(StepTranslatorMutex());
  Handle(TDocStd_Document) document = NewStepDocument();
  STEPCAFControl_Reader reader;
  const InMetres in_metres;
  std::istringstream stream{std::string(bytes)};
  if (reader.ChangeReader().ReadStream("step", stream) != IFSelect_RetDone) {
    return InvalidField("step", "is not a STEP file that can be read");
  }
  const std::vector<std::string> faults = EntityFaults(reader);
  if (seen && !faults.empty()) seen(faults);
  MORTISE_RETURN_IF_ERROR(CheckStructure(reader));
  KeepNames(Handle(StepData_StepModel)::DownCast(reader.ChangeReader().WS()->Model()));
  if (!reader.Transfer(document)) return InvalidField("step", "holds no shapes that can be read");
  StepAssembly assembly;
  assembly.schema = SchemaOf(bytes);
  TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
  reader.ChangeReader().FileUnits(lengths, angles, solid_angles);
  if (!lengths.IsEmpty()) assembly.length_unit = lengths.First().ToCString();
  MORTISE_RETURN_IF_ERROR(Collector(document, assembly).Collect());
  if (assembly.parts.empty()) return InvalidField("step", "holds no solid");
  NameAll(assembly);
  for (const std::string& fault : faults) {
    assembly.notes.push_back(absl::StrCat("a fault that was passed over: ", fault));
  }
  return assembly;
}

}  // namespace

absl::StatusOr<StepAssembly> ReadStep(std::string_view bytes, const StepFaultsSeen& seen) {
  try {
    return Read(bytes, seen);
  } catch (const Standard_Failure&) {
    return InvalidField("step", "is damaged: the CAD kernel cannot read it");
  }
}

}  // namespace mortise::cad
