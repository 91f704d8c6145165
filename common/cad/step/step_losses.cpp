#include "common/cad/step/step_losses.h"

#include <Interface_EntityIterator.hxx>
#include <Interface_Graph.hxx>
#include <Interface_HGraph.hxx>
#include <StepBasic_Product.hxx>
#include <StepBasic_ProductDefinition.hxx>
#include <StepBasic_ProductDefinitionFormation.hxx>
#include <StepData_StepModel.hxx>
#include <StepData_UndefinedEntity.hxx>
#include <StepRepr_MappedItem.hxx>
#include <StepRepr_NextAssemblyUsageOccurrence.hxx>
#include <StepRepr_ProductDefinitionShape.hxx>
#include <StepRepr_Representation.hxx>
#include <StepRepr_ShapeRepresentationRelationship.hxx>
#include <StepShape_BrepWithVoids.hxx>
#include <StepShape_ConnectedFaceSet.hxx>
#include <StepShape_ContextDependentShapeRepresentation.hxx>
#include <StepShape_FaceBasedSurfaceModel.hxx>
#include <StepShape_ManifoldSolidBrep.hxx>
#include <StepShape_OrientedClosedShell.hxx>
#include <StepShape_ShapeDefinitionRepresentation.hxx>
#include <StepShape_ShellBasedSurfaceModel.hxx>
#include <StepShape_SolidModel.hxx>
#include <StepVisual_TessellatedItem.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <set>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "common/cad/step/step_structure.h"

namespace mortise::cad {
namespace {

constexpr std::size_t kMaxTold = 20;
constexpr std::size_t kMaxLookedAt = 1000;  // entities above one

int CountOf(const TopoDS_Shape& shape, TopAbs_ShapeEnum kind) {
  TopTools_IndexedMapOfShape found;
  TopExp::MapShapes(shape, kind, found);
  return found.Extent();
}

int FacesOf(const Handle(StepShape_ConnectedFaceSet) & shell) {
  return shell.IsNull() || shell->CfsFaces().IsNull() ? 0 : shell->NbCfsFaces();
}

// Of a body in the file.
int FacesOf(const Handle(StepShape_ManifoldSolidBrep) & body) {
  int count = FacesOf(body->Outer());
  const auto hollow = Handle(StepShape_BrepWithVoids)::DownCast(body);
  if (hollow.IsNull() || hollow->Voids().IsNull()) return count;
  for (int i = 1; i <= hollow->NbVoids(); ++i) {
    const Handle(StepShape_OrientedClosedShell) hole = hollow->VoidsValue(i);
    if (!hole.IsNull()) {
      count += FacesOf(Handle(StepShape_ConnectedFaceSet)(hole->ClosedShellElement()));
    }
  }
  return count;
}

// Whether one of the types of an entity that the kernel does not know, as one may have several,
// has `text` in its name.
bool HasType(Handle(StepData_UndefinedEntity) entity, const std::string& text) {
  for (; !entity.IsNull(); entity = entity->Next()) {
    if (absl::StrContains(entity->StepType(), text)) return true;
  }
  return false;
}

class Finder {
 public:
  Finder(STEPCAFControl_Reader& reader, const TopTools_MapOfShape& told)
      : session_(reader.ChangeReader().WS()),
        model_(Handle(StepData_StepModel)::DownCast(session_->Model())),
        graph_(session_->HGraph()),
        process_(session_->TransferReader()->TransientProcess()),
        told_(told) {}

  std::vector<std::string> Losses() {
    for (int i = 1; i <= model_->NbEntities(); ++i) Look(model_->Value(i));
    if (more_ > 0) {
      losses_.push_back(absl::StrCat("and ", more_, more_ == 1 ? " more is" : " more are",
                                     " left out or incomplete"));
    }
    return std::move(losses_);
  }

 private:
  void Look(const Handle(Standard_Transient) & entity) {
    if (entity->IsKind(STANDARD_TYPE(StepShape_SolidModel))) return LookAtBody(entity);
    if (entity->IsKind(STANDARD_TYPE(StepShape_ShellBasedSurfaceModel)) ||
        entity->IsKind(STANDARD_TYPE(StepShape_FaceBasedSurfaceModel))) {
      return Tell(entity, "surface", "is no solid and is left out");
    }
    if (IsTessellated(entity)) {
      return Tell(entity, "tessellated body", "is not read and is left out");
    }
    const auto item = Handle(StepRepr_MappedItem)::DownCast(entity);
    if (!item.IsNull() && ShapeOf(item).IsNull()) {
      return Tell(entity, "mapped item", "is in nothing that is read, and is left out");
    }
    const auto usage = Handle(StepRepr_NextAssemblyUsageOccurrence)::DownCast(entity);
    if (!usage.IsNull() && ShapeOf(usage).IsNull()) TellOfUsage(usage);
  }

  void LookAtBody(const Handle(Standard_Transient) & entity) {
    const TopoDS_Shape shape = ShapeOf(entity);
    const auto body = Handle(StepShape_ManifoldSolidBrep)::DownCast(entity);
    if (shape.IsNull()) {
      return Tell(entity, "body",
                  body.IsNull() ? "is of a kind that is not read, and is left out"
                                : "belongs to no product that is read, and is left out");
    }
    if (!TopExp_Explorer(shape, TopAbs_SOLID).More()) {
      return Tell(entity, "body", "is open, so no solid, and is left out");
    }
    const int drawn = body.IsNull() ? 0 : FacesOf(body), read = CountOf(shape, TopAbs_FACE);
    if (read < drawn) {
      Tell(entity, "body", absl::StrCat("has lost ", drawn - read, " of its ", drawn, " faces"));
    }
  }

  // Of facets, or curves and points of such, which the kernel does not read. Notes that are drawn
  // of facets are no bodies.
  bool IsTessellated(const Handle(Standard_Transient) & entity) const {
    const auto unknown = Handle(StepData_UndefinedEntity)::DownCast(entity);
    if (unknown.IsNull()) {
      return entity->IsKind(STANDARD_TYPE(StepVisual_TessellatedItem)) && StandsAmongFacets(entity);
    }
    if (unknown->IsSub()) return false;
    const std::string type = unknown->StepType();
    return type == "TESSELLATED_SOLID" || type == "TESSELLATED_SHELL" ||
           type == "TRIANGULATED_SURFACE_SET" ||
           (!HasType(unknown, "ANNOTATION") && StandsAmongFacets(unknown));
  }

  // Whether it is itself an item of a representation of facets.
  bool StandsAmongFacets(const Handle(Standard_Transient) & entity) const {
    Interface_EntityIterator users = graph_->Graph().Sharings(entity);
    for (users.Start(); users.More(); users.Next()) {
      const auto user = Handle(StepData_UndefinedEntity)::DownCast(users.Value());
      if (HasType(user, "TESSELLATED_SHAPE_REPRESENTATION")) return true;
    }
    return false;
  }

  void TellOfUsage(const Handle(StepRepr_NextAssemblyUsageOccurrence) & usage) {
    std::string name = usage->Name().IsNull() ? "" : usage->Name()->ToCString();
    if (name.empty()) name = ProductName(usage->RelatedProductDefinition());
    Add(absl::StrCat("'", name, "' in '", ProductName(usage->RelatingProductDefinition()), "' (#",
                     model_->IdentLabel(usage),
                     IsPlaced(usage) ? ") has no shape that can be read" : ") has no placement",
                     " and is left out"));
  }

  bool IsPlaced(const Handle(Standard_Transient) & usage) const {
    Interface_EntityIterator shapes = graph_->Graph().Sharings(usage);
    for (shapes.Start(); shapes.More(); shapes.Next()) {
      Interface_EntityIterator users = graph_->Graph().Sharings(shapes.Value());
      for (users.Start(); users.More(); users.Next()) {
        if (users.Value()->IsKind(STANDARD_TYPE(StepShape_ContextDependentShapeRepresentation))) {
          return true;
        }
      }
    }
    return false;
  }

  TopoDS_Shape ShapeOf(const Handle(Standard_Transient) & entity) const {
    return TransferBRep::ShapeResult(process_, entity);
  }

  void Tell(const Handle(Standard_Transient) & entity, const std::string& kind,
            const std::string& what) {
    const Owner owner = OwnerOf(entity);
    if (owner.is_told) return;
    const std::string product = ProductName(owner.product);
    const auto item = Handle(StepRepr_RepresentationItem)::DownCast(entity);
    const std::string own = item.IsNull() || item->Name().IsNull() ? "" : item->Name()->ToCString();
    Add(absl::StrCat(product.empty() ? "" : absl::StrCat("'", product, "': "), kind,
                     own.empty() ? "" : absl::StrCat(" '", own, "'"), " #",
                     model_->IdentLabel(entity), " ", what));
  }

  void Add(std::string loss) {
    if (losses_.size() < kMaxTold) {
      losses_.push_back(std::move(loss));
    } else {
      ++more_;
    }
  }

  bool IsTold(const Handle(Standard_Transient) & entity) const {
    if (entity.IsNull()) return false;
    const TopoDS_Shape shape = ShapeOf(entity);
    return !shape.IsNull() && told_.Contains(shape.Located(TopLoc_Location()));
  }

  // The product that an entity belongs to, found upwards; null if it is in none. Products that are
  // told of may have the names of others, so what is told is known by its shape.
  struct Owner {
    Handle(StepBasic_ProductDefinition) product;
    bool is_told = false;  // itself, or the mapped representation that the entity is in
  };

  Owner OwnerOf(const Handle(Standard_Transient) & entity) const {
    std::set<const Standard_Transient*> seen = {entity.get()};
    std::vector<Handle(Standard_Transient)> open = {entity};
    for (std::size_t i = 0; i < open.size() && open.size() < kMaxLookedAt; ++i) {
      if (i > 0 && IsTold(open[i])) return {{}, true};
      const auto definition = Handle(StepShape_ShapeDefinitionRepresentation)::DownCast(open[i]);
      if (!definition.IsNull()) {
        const auto shape = Handle(StepRepr_ProductDefinitionShape)::DownCast(
            definition->Definition().PropertyDefinition());
        if (shape.IsNull()) continue;
        const Handle(StepBasic_ProductDefinition) product = shape->Definition().ProductDefinition();
        if (!product.IsNull()) return {product, IsTold(product)};
        continue;
      }
      Interface_EntityIterator users = graph_->Graph().Sharings(open[i]);
      for (users.Start(); users.More(); users.Next()) {
        // What relates a representation to the whole that it stands in belongs to that.
        if (users.Value()->IsKind(STANDARD_TYPE(StepShape_ContextDependentShapeRepresentation))) {
          continue;
        }
        if (seen.insert(users.Value().get()).second) open.push_back(users.Value());
      }
      AddRelated(open[i], seen, open);
    }
    return {};
  }

  // The representations that a relationship, as it is no placement, says are of the same product.
  static void AddRelated(const Handle(Standard_Transient) & entity,
                         std::set<const Standard_Transient*>& seen,
                         std::vector<Handle(Standard_Transient)>& open) {
    if (entity->DynamicType() != STANDARD_TYPE(StepRepr_ShapeRepresentationRelationship)) return;
    const auto relationship = Handle(StepRepr_ShapeRepresentationRelationship)::DownCast(entity);
    for (const Handle(StepRepr_Representation) & related :
         {relationship->Rep1(), relationship->Rep2()}) {
      if (!related.IsNull() && seen.insert(related.get()).second) open.push_back(related);
    }
  }

  const Handle(XSControl_WorkSession) session_;
  const Handle(StepData_StepModel) model_;
  const Handle(Interface_HGraph) graph_;
  const Handle(Transfer_TransientProcess) process_;
  const TopTools_MapOfShape& told_;
  std::vector<std::string> losses_;
  std::size_t more_ = 0;
};

}  // namespace

std::vector<std::string> Losses(STEPCAFControl_Reader& reader, const TopTools_MapOfShape& told) {
  return Finder(reader, told).Losses();
}

}  // namespace mortise::cad
