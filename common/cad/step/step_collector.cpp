#include "common/cad/step/step_collector.h"

#include <Quantity_Color.hxx>
#include <Standard_Failure.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDF_Tool.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS_Iterator.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/cad/solid_kernel.h"
#include "common/cad/step/solid_mirror.h"
#include "common/cad/step/step_document.h"
#include "common/cad/step/step_measure.h"
#include "common/cad/step/step_soundness.h"
#include "common/cad/step/step_structure.h"
#include "common/cad/stretch/solid_shape.h"

namespace mortise::cad {
namespace {

constexpr int kMaxDepth = 64;                             // levels of sub-assemblies
constexpr std::size_t kMaxLookedAt = 10 * kMaxStepParts;  // occurrences, to count their solids
constexpr double kSameTurn = 1e-12;
constexpr double kSameScale = 1e-12;

// Whether a name is one that a program made up for an occurrence: "NAUO12", "3", "=>[0:1:1:2]".
bool IsMadeUp(const std::string& name) {
  if (name.empty() || name.starts_with("=>[")) return true;
  const std::string number = name.starts_with("NAUO") ? name.substr(4) : name;
  return std::all_of(number.begin(), number.end(),
                     [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; });
}

// A similarity as a rigid motion after a scale and, perhaps, a mirror across z = 0.
struct Place {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  double scale = 1;
  bool is_mirrored = false;

  bool IsRigid() const { return scale == 1 && !is_mirrored; }
  Eigen::Affine3d Whole() const {
    return motion * Eigen::Scaling(scale, scale, is_mirrored ? -scale : scale);
  }
};

Place PlaceOf(const Eigen::Affine3d& whole) {
  Place place;
  const double determinant = whole.linear().determinant();
  place.is_mirrored = determinant < 0;
  place.scale = std::cbrt(std::abs(determinant));
  if (std::abs(place.scale - 1) <= kSameScale) place.scale = 1;
  const Eigen::Vector3d sizes(place.scale, place.scale,
                              place.is_mirrored ? -place.scale : place.scale);
  place.motion.linear() = whole.linear() * sizes.cwiseInverse().asDiagonal();
  place.motion.translation() = whole.translation();
  return place;
}

std::vector<TopoDS_Shape> SolidsOf(const TopoDS_Shape& shape) {
  std::vector<TopoDS_Shape> solids;
  if (shape.IsNull()) return solids;
  for (TopExp_Explorer solid(shape, TopAbs_SOLID); solid.More(); solid.Next()) {
    solids.push_back(solid.Current());
  }
  return solids;
}

bool HasFaces(const TopoDS_Shape& shape) {
  return !shape.IsNull() && TopExp_Explorer(shape, TopAbs_FACE).More();
}

int FacesOf(const TopoDS_Shape& solid) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(solid, TopAbs_FACE, faces);
  return faces.Extent();
}

// Walks the document's tree and collects what stands in it.
class Collector {
 public:
  Collector(const Handle(TDocStd_Document) & document, const StepOperators& operators,
            const StepPlaces& places, const StepProgress& progress, StepAssembly& assembly)
      : shapes_(XCAFDoc_DocumentTool::ShapeTool(document->Main())),
        colors_(XCAFDoc_DocumentTool::ColorTool(document->Main())),
        operators_(operators),
        places_(places),
        progress_(progress),
        assembly_(assembly) {}

  absl::StatusOr<TopTools_MapOfShape> Collect() {
    TDF_LabelSequence roots;
    shapes_->GetFreeShapes(roots);
    assembly_.groups.push_back({});
    for (const TDF_Label& root : roots) solids_ += SolidsAt(root, 0);
    // One assembly is the root itself.
    const bool is_one = roots.Length() == 1 && IsAssembly(roots.First());
    for (const TDF_Label& root : roots) {
      if (assembly_.name.empty()) assembly_.name = NameOf(root);
      if (is_one) {
        MORTISE_RETURN_IF_ERROR(CollectComponents(root, 0, Place(), 0));
      } else {
        MORTISE_RETURN_IF_ERROR(CollectOne(root, "", 0, Place(), 0));
      }
    }
    assembly_.groups[0].name = assembly_.name;
    TellOfRough();
    return leaf_shapes_;
  }

 private:
  // ---- The tree ---------------------------------------------------------------------------------

  // How many solids stand in what a label refers to, as far as they can be parts.
  std::size_t SolidsAt(const TDF_Label& occurrence, int depth) {
    if (++looked_at_ > kMaxLookedAt) return 0;
    TDF_Label product = occurrence;
    if (XCAFDoc_ShapeTool::IsReference(occurrence)) {
      XCAFDoc_ShapeTool::GetReferredShape(occurrence, product);
    }
    if (!IsAssembly(product)) return SolidsOf(XCAFDoc_ShapeTool::GetShape(product)).size();
    if (depth > kMaxDepth) return 0;
    TDF_LabelSequence components;
    XCAFDoc_ShapeTool::GetComponents(product, components);
    std::size_t count = 0;
    for (const TDF_Label& component : components) count += SolidsAt(component, depth + 1);
    return count;
  }

  // Whether the file says that something stands in it; the kernel makes assemblies of other things.
  bool IsAssembly(const TDF_Label& product) const {
    if (!XCAFDoc_ShapeTool::IsAssembly(product)) return false;
    TDF_LabelSequence components;
    XCAFDoc_ShapeTool::GetComponents(product, components);
    return std::any_of(components.begin(), components.end(), [this](const TDF_Label& component) {
      TDF_Label referred;
      // Of an assembly the kernel gives another shape than it read.
      if (XCAFDoc_ShapeTool::GetReferredShape(component, referred) &&
          XCAFDoc_ShapeTool::IsAssembly(referred)) {
        return true;
      }
      return places_.IsPlaced(XCAFDoc_ShapeTool::GetShape(component));
    });
  }

  // `within`: what the group's frame is distorted by; its motion is the group's.
  absl::Status CollectComponents(const TDF_Label& whole, int group, const Place& within,
                                 int depth) {
    if (depth > kMaxDepth) {
      return InvalidField("step",
                          absl::StrCat("has sub-assemblies deeper than ", kMaxDepth, " levels"));
    }
    TDF_LabelSequence components;
    XCAFDoc_ShapeTool::GetComponents(whole, components);
    for (const TDF_Label& component : components) {
      MORTISE_RETURN_IF_ERROR(CollectOne(component, NameOf(whole), group, within, depth));
    }
    return absl::OkStatus();
  }

  // `whole`: the name of the product that it stands in.
  absl::Status CollectOne(const TDF_Label& occurrence, const std::string& whole, int group,
                          const Place& within, int depth) {
    TDF_Label product = occurrence;
    Place place = within;
    if (XCAFDoc_ShapeTool::IsReference(occurrence)) {
      place = PlaceIn(within, XCAFDoc_ShapeTool::GetLocation(occurrence));
      XCAFDoc_ShapeTool::GetReferredShape(occurrence, product);
    }
    const StepPlaces::Names mapped = places_.NamesOf(XCAFDoc_ShapeTool::GetShape(occurrence));
    std::string product_name = NameOf(product);
    if (product_name.empty()) product_name = mapped.representation;
    // What has no name of its own is the product's that it is in.
    if (product_name.empty()) product_name = whole;
    std::string name = NameOf(occurrence);
    if (IsMadeUp(name)) name = mapped.item;
    if (IsMadeUp(name)) name = product_name;
    if (!IsAssembly(product)) {
      return CollectLeaf(occurrence, product, name, product_name, group, place);
    }
    assembly_.groups.push_back({name, group, place.motion});
    Place distorted = place;
    distorted.motion.setIdentity();
    return CollectComponents(product, static_cast<int>(assembly_.groups.size()) - 1, distorted,
                             depth + 1);
  }

  Place PlaceIn(const Place& within, const TopLoc_Location& location) const {
    if (within.IsRigid() && operators_.IsRigid(location)) return {FromLocation(location)};
    return PlaceOf(within.Whole() * operators_.PlacementOf(location));
  }

  // ---- Products ---------------------------------------------------------------------------------

  // A solid of a label as it is placed: in the product's frame, or distorted.
  struct Standing {
    int product = 0;
    Eigen::Isometry3d placement;
  };

  absl::Status CollectLeaf(const TDF_Label& occurrence, const TDF_Label& product,
                           const std::string& name, const std::string& product_name, int group,
                           const Place& place) {
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(product);
    const std::vector<TopoDS_Shape> solids = SolidsOf(shape);
    if (assembly_.parts.size() + solids.size() > static_cast<std::size_t>(kMaxStepParts)) {
      return TooLarge("step", absl::StrCat(kMaxStepParts, " parts"));
    }
    for (std::size_t i = 0; i < solids.size(); ++i) {
      const Standing standing = StandingOf({product, product_name, i, solids[i]}, place);
      StepPart part;
      part.drawn_name = name;
      part.group = group;
      part.product = standing.product;
      part.placement = standing.placement;
      part.color = ColorOf(occurrence);
      AddPart(std::move(part));
    }
    // Curves beside a body are no part of what stands there.
    const bool is_own = XCAFDoc_ShapeTool::IsAssembly(product) || places_.IsPlaced(shape);
    if (solids.empty() && (HasFaces(shape) || is_own)) {
      assembly_.leaves.push_back({"", name, product_name, group, HasFaces(shape)});
      AddLeafShape(shape);
    }
    if (solids.size() > 1 && several_.insert(EntryOf(product)).second) {
      assembly_.notes.push_back(absl::StrCat("product '", product_name, "' has ", solids.size(),
                                             " solids; each is a part"));
    }
    return absl::OkStatus();
  }

  // The kernel may have put together anew what is a compound of what it read.
  void AddLeafShape(const TopoDS_Shape& shape) {
    if (shape.IsNull() || !leaf_shapes_.Add(shape.Located(TopLoc_Location()))) return;
    if (shape.ShapeType() != TopAbs_COMPOUND) return;
    for (TopoDS_Iterator within(shape); within.More(); within.Next()) AddLeafShape(within.Value());
  }

  void AddPart(StepPart part) {
    const auto product = static_cast<std::size_t>(part.product);
    const Eigen::Isometry3d where = PlacementOf(assembly_, part.group) * part.placement;
    measurers_[product]->Measure(where, part);
    part.faces = faces_[product];
    if (!faults_[product].empty()) {
      part.faults.push_back(faults_[product]);
    } else if (!part.is_box && part.volume > 0) {
      SetShape(where, part);
    }
    assembly_.parts.push_back(std::move(part));
    if (progress_) progress_(assembly_.parts.size(), std::max(solids_, assembly_.parts.size()));
  }

  struct LabelledSolid {
    TDF_Label label;
    std::string product_name;
    std::size_t index = 0;
    TopoDS_Shape solid;
  };

  // What is its own mirror image is not mirrored but turned.
  Standing StandingOf(const LabelledSolid& drawn, const Place& place) {
    const TopLoc_Location& location = drawn.solid.Location();
    if (place.IsRigid() && operators_.IsRigid(location)) {
      return {ProductOf(drawn, 1, false), place.motion};
    }
    Eigen::Affine3d whole = place.Whole() * operators_.PlacementOf(location);
    Place stands = PlaceOf(whole);
    if (stands.is_mirrored) {
      if (const auto& mirror = OwnMirrorOf(drawn)) stands = PlaceOf(whole * *mirror);
    }
    if (!stands.IsRigid()) {
      return {ProductOf(drawn, stands.scale, stands.is_mirrored), stands.motion};
    }
    // The product's frame has the solid where the kernel has moved it.
    return {ProductOf(drawn, 1, false), stands.motion * FromLocation(location).inverse()};
  }

  const std::optional<Eigen::Affine3d>& OwnMirrorOf(const LabelledSolid& drawn) {
    const auto [known, is_new] = mirrors_.try_emplace({EntryOf(drawn.label), drawn.index});
    if (is_new) known->second = OwnMirror(drawn.solid.Located(TopLoc_Location()));
    return known->second;
  }

  // The same for all that differ by rounding, as those do that are turned differently.
  double KnownScale(double scale) {
    const auto known = std::find_if(scales_.begin(), scales_.end(), [&](double other) {
      return std::abs(other - scale) <= kSameScale * other;
    });
    return known != scales_.end() ? *known : scales_.emplace_back(scale);
  }

  // The index of a product.
  int ProductOf(const LabelledSolid& drawn, double drawn_scale, bool is_mirrored) {
    const double scale = KnownScale(drawn_scale);
    const auto [known, is_new] =
        products_.try_emplace({EntryOf(drawn.label), drawn.index, scale, is_mirrored},
                              static_cast<int>(assembly_.products.size()));
    if (!is_new) return known->second;
    auto kernel = std::make_shared<Solid::Kernel>();
    kernel->name = drawn.product_name;
    const bool is_rigid = scale == 1 && !is_mirrored;
    kernel->shape =
        is_rigid ? drawn.solid
                 : DistortedSolid(drawn.solid.Located(TopLoc_Location()), scale, is_mirrored);
    measurers_.push_back(std::make_unique<SolidMeasurer>(kernel->shape));
    faces_.push_back(FacesOf(kernel->shape));
    const Soundness soundness = SoundnessIn(kernel->shape);
    faults_.push_back(soundness.fault);
    if (!soundness.note.empty()) {
      rough_.push_back(absl::StrCat("'", drawn.product_name, "': ", soundness.note));
    }
    StepProduct product{drawn.product_name, Solid(std::move(kernel)), ColorOf(drawn.label)};
    if (!product.color) product.color = ColorOf(drawn.solid);
    product.scale = scale;
    product.is_mirrored = is_mirrored;
    assembly_.products.push_back(std::move(product));
    return known->second;
  }

  void TellOfRough() {
    constexpr std::size_t kMaxTold = 5;
    const std::size_t told = std::min(kMaxTold, rough_.size());
    assembly_.notes.insert(assembly_.notes.end(), rough_.begin(),
                           rough_.begin() + static_cast<std::ptrdiff_t>(told));
    if (rough_.size() > told) {
      assembly_.notes.push_back(
          absl::StrCat("faces of ", rough_.size() - told, " more products contradict each other"));
    }
  }

  static Soundness SoundnessIn(const TopoDS_Shape& solid) {
    try {
      return SoundnessOf(solid);
    } catch (const Standard_Failure& failure) {
      return {absl::StrCat("the kernel cannot take it: ", failure.GetMessageString()), ""};
    }
  }

  static std::string EntryOf(const TDF_Label& label) {
    TCollection_AsciiString entry;
    TDF_Tool::Entry(label, entry);
    return entry.ToCString();
  }

  // ---- Shapes and colours -----------------------------------------------------------------------

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

  // A product's shape as parts have it that are turned so.
  struct TurnedShape {
    int product = 0;
    Eigen::Matrix3d rotation;
    int shape = -1;  // index into StepAssembly::shapes; -1 if there are faults
    std::vector<std::string> faults;
  };

  const Handle(XCAFDoc_ShapeTool) shapes_;
  const Handle(XCAFDoc_ColorTool) colors_;
  const StepOperators& operators_;
  const StepPlaces& places_;
  const StepProgress& progress_;
  StepAssembly& assembly_;
  std::size_t solids_ = 0;     // that stand in the document
  std::size_t looked_at_ = 0;  // occurrences, while these were counted
  // By the label's path in the document and the solid's index there; scale, whether it is mirrored.
  std::map<std::tuple<std::string, std::size_t, double, bool>, int> products_;
  std::map<std::pair<std::string, std::size_t>, std::optional<Eigen::Affine3d>> mirrors_;
  std::vector<double> scales_ = {1};
  TopTools_MapOfShape leaf_shapes_;  // unplaced
  std::vector<std::string> rough_;   // what is not quite right with products
  std::set<std::string> several_;    // labels of products of several solids
  // Of each product.
  std::vector<std::unique_ptr<SolidMeasurer>> measurers_;
  std::vector<int> faces_;
  std::vector<std::string> faults_;  // empty where there is none
  std::vector<TurnedShape> shapes_drawn_;
};

}  // namespace

absl::StatusOr<TopTools_MapOfShape> CollectParts(const Handle(TDocStd_Document) & document,
                                                 const StepOperators& operators,
                                                 const StepPlaces& places,
                                                 const StepProgress& progress,
                                                 StepAssembly& assembly) {
  return Collector(document, operators, places, progress, assembly).Collect();
}

}  // namespace mortise::cad
